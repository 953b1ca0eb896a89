// Fits of specimens, and when their Jacobians are taken anew.
#include "updating/fits/specimen_fit.hpp"

#include <gtest/gtest.h>

#include "support/linear_problem.hpp"

namespace mottle::updating {
namespace {

/// Outputs of a linear model that are a little larger beyond a = 3, as those of a reduced model are where another basis
/// answers: derivatives by differences that reach across are 4 % off.
class StepModel final : public Model {
 public:
  explicit StepModel(const Model& smooth) : smooth_(smooth) {}
  Eigen::Index parameter_count() const override { return smooth_.parameter_count(); }
  const std::vector<Quantity>& outputs() const override { return smooth_.outputs(); }
  double difference_step() const override { return k_coarse_difference_step; }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const override {
    Evaluation evaluation = smooth_.evaluate(samples, context);
    runs += samples.rows();
    for (Eigen::Index s = 0; s < samples.rows(); ++s) {
      if (samples(s, 0) > 3.0) evaluation.outputs.row(s).array() += 0.004;
    }
    return evaluation;
  }
  mutable std::int64_t runs = 0;

 private:
  const Model& smooth_;
};

struct Stepped {
  UpdatingProblem problem() const {
    UpdatingProblem own = linear.problem(linear.noise).with_model(model, nullptr);
    return own;
  }
  test::LinearProblem linear;
  StepModel model{linear.model};
};

TEST(SpecimenFit, KeepsAJacobianOfDifferencesWithinTheirStep) {
  const Stepped stepped;
  const UpdatingProblem problem = stepped.problem();
  const HoldingPopulation population{Eigen::Vector2d(2.5, 6.0), Eigen::Matrix2d::Identity(),
                                     stepped.linear.noise.cwiseAbs2()};
  const Eigen::MatrixXd values = stepped.linear.tests.topRows(1);
  std::int64_t evaluations = 0;
  const SpecimenFits first =
      fit_specimens(problem, values, population, {Eigen::RowVector2d(2.5, 6.0)}, {}, evaluations);
  SpecimenStart start{.points = first.points, .jacobians = first.jacobians, .differentiated = first.differentiated};
  const auto runs = stepped.model.runs;
  const SpecimenFits near = fit_specimens(problem, values, population, start, {}, evaluations);
  EXPECT_LT(stepped.model.runs - runs, 4);  // no differences, of which there are four
  EXPECT_EQ(near.jacobians[0], first.jacobians[0]);
  EXPECT_EQ(near.differentiated, first.differentiated);
  start.differentiated(0, 1) += 0.06;  // a step is 0.05 prior standard deviations, which are 1
  const SpecimenFits far = fit_specimens(problem, values, population, start, {}, evaluations);
  EXPECT_EQ(far.differentiated, far.points);
}

}  // namespace
}  // namespace mottle::updating
