// Fits of specimens, and when their Jacobians are taken anew.
#include "updating/fits/specimen_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "mottle/core/error.hpp"
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

/// A linear model that fails all around a point, but for the point itself.
class RingModel final : public Model {
 public:
  RingModel(const Model& smooth, Eigen::RowVectorXd point) : smooth_(smooth), point_(std::move(point)) {}
  Eigen::Index parameter_count() const override { return smooth_.parameter_count(); }
  const std::vector<Quantity>& outputs() const override { return smooth_.outputs(); }
  double difference_step() const override { return k_coarse_difference_step; }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const override {
    Evaluation evaluation = smooth_.evaluate(samples, context);
    for (Eigen::Index s = 0; s < samples.rows(); ++s) {
      const double distance = (samples.row(s) - point_).norm();
      if (distance > 1e-6 && distance < 0.06) evaluation.outputs.row(s).setConstant(std::nan(""));
    }
    return evaluation;
  }

 private:
  const Model& smooth_;
  Eigen::RowVectorXd point_;
};

TEST(SpecimenFit, KeepsItsLastDerivativeWhereTheModelFailsAllAround) {
  const test::LinearProblem linear;
  const HoldingPopulation population{Eigen::Vector2d(2.5, 6.0), Eigen::Matrix2d::Identity(), linear.noise.cwiseAbs2()};
  const SpecimenStart start{.points = Eigen::RowVector2d(2.5, 6.0).replicate(2, 1)};
  const Eigen::MatrixXd values = linear.tests.topRows(2);
  std::int64_t evaluations = 0;
  const SpecimenFits expected = fit_specimens(linear.problem(linear.noise), values, population, start, {}, evaluations);
  const RingModel ring(linear.model, expected.points.row(1));
  const SpecimenFits found =
      fit_specimens(linear.problem(linear.noise).with_model(ring, nullptr), values, population, start, {}, evaluations);
  EXPECT_LT((found.points - expected.points).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT((found.jacobians[1] - test::LinearProblem::slope()).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(found.converged, (std::vector<bool>{true, false}));
}

TEST(SpecimenFit, StartsWithTheOthersDerivativeWhereTheModelFailsAllAround) {
  const test::LinearProblem linear;
  const HoldingPopulation population{Eigen::Vector2d(2.5, 6.0), Eigen::Matrix2d::Identity(), linear.noise.cwiseAbs2()};
  const RingModel ring(linear.model, Eigen::RowVector2d(2.0, 7.0));
  const UpdatingProblem problem = linear.problem(linear.noise).with_model(ring, nullptr);
  const Eigen::MatrixXd values = linear.tests.topRows(2);
  std::int64_t evaluations = 0;
  const Eigen::MatrixXd points = (Eigen::MatrixXd(2, 2) << 2.0, 7.0, 4.0, 7.0).finished();
  const SpecimenFits fits = fit_specimens(problem, values, population, {points}, {}, evaluations);
  EXPECT_LT((fits.jacobians[0] - test::LinearProblem::slope()).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_THROW(fit_specimens(problem, values.topRows(1), population, {points.topRows(1)}, {}, evaluations),
               ModelFailure);
}

}  // namespace
}  // namespace mottle::updating
