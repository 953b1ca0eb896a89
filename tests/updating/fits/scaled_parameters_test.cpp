#include "updating/fits/scaled_parameters.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mottle/updating/methods/deterministic.hpp"
#include "support/linear_model.hpp"
#include "support/three_masses.hpp"
#include "updating/methods/least_squares.hpp"

namespace mottle::updating {
namespace {

using Kind = ParameterTransform::Kind;

ParameterSpace three_scales() {
  const Distribution prior({.kind = DistributionKind::normal, .mean = 2.0, .std = 0.2});
  return {{{"a", "-", 0.5, 3.0, {}, {}},
           {"b", "-", 0.5, 3.0, {}, {Kind::log}},
           {"c", "-", 1.0, 4.0, {}, {Kind::logit, 1.0, 4.0}}},
          JointDistribution({prior, prior, prior})};
}

TEST(ScaledParameters, StartAndDeviationAreTheFirstOrderOnesOfThePrior) {
  const ScaledParameters parameters(three_scales());
  EXPECT_LT((parameters.start() - Eigen::Vector3d(2.0, std::log(2.0), std::log(0.5))).cwiseAbs().maxCoeff(), 1e-14);
  // dt/dx: 1, 1/x, (u - l) / ((x - l)(u - x)) = 3 / 2.
  EXPECT_LT((parameters.standard_deviation() - Eigen::Vector3d(0.2, 0.1, 0.3)).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(ScaledParameters, ClampsToTheBoundsOfTheVariables) {
  const ScaledParameters parameters(three_scales());
  const Eigen::VectorXd low = parameters.clamp(Eigen::Vector3d::Constant(-1e3));
  const Eigen::VectorXd high = parameters.clamp(Eigen::Vector3d::Constant(1e3));
  EXPECT_EQ(parameters.active_bounds(low), Eigen::Vector3i(-1, -1, -1));
  EXPECT_EQ(parameters.active_bounds(high), Eigen::Vector3i(1, 1, 1));
  EXPECT_EQ(parameters.active_bounds(parameters.start()), Eigen::Vector3i(0, 0, 0));
  EXPECT_LT((parameters.to_variables(low.transpose()) - Eigen::RowVector3d(0.5, 0.5, 1.0)).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((parameters.to_variables(high.transpose()) - Eigen::RowVector3d(3.0, 3.0, 4.0)).cwiseAbs().maxCoeff(),
            1e-9);
}

TEST(ScaledJacobians, OwnDerivativesAndDifferencesAgreeOnEveryScale) {
  const test::ThreeMasses structure;
  std::vector<Parameter> list = structure.space->parameters();
  list[1].transform = {Kind::log};
  list[2].transform = {Kind::logit, 0.5, 3.0};
  const ParameterSpace space(list, structure.space->prior());
  const ScaledParameters parameters(space);
  Eigen::MatrixXd points(2, 3);
  points << 1.3, 0.1, 0.4, 0.8, -0.2, 0.9;
  const Eigen::MatrixXd outputs = structure.model->evaluate(parameters.to_variables(points), {}).outputs;
  const UpdatingProblem with{.model = *structure.model, .derivatives = structure.model.get(), .space = space};
  const UpdatingProblem without{.model = *structure.model, .space = space};
  std::int64_t runs = 0;
  const auto analytic = scaled_jacobians(with, parameters, points, outputs, {}, runs);
  EXPECT_EQ(runs, 0);
  const auto differences = scaled_jacobians(without, parameters, points, outputs, {.threads = 2}, runs);
  EXPECT_EQ(runs, 12);
  // Central differences with steps of 3e-5: truncation about 1e-10, rounding about 1e-11.
  for (std::size_t s = 0; s < 2; ++s) EXPECT_LT((analytic[s] - differences[s]).cwiseAbs().maxCoeff(), 1e-9);
}

/// A linear model whose derivatives fail: a request that got no answer.
class FailingDerivatives final : public DifferentiableModel {
 public:
  Eigen::MatrixXd jacobian(const Eigen::Ref<const Eigen::VectorXd>& /*parameters*/) const override {
    throw ModelFailure("the evaluation failed: no answer within 2 s");
  }
};

TEST(ScaledJacobians, WhereTheModelsOwnFailDifferencesAreTaken) {
  const Eigen::Matrix2d slopes = (Eigen::Matrix2d() << 1.0, 2.0, -3.0, 0.5).finished();
  const test::LinearModel model(Eigen::Vector2d::Zero(), slopes);
  const Distribution prior({.kind = DistributionKind::normal, .mean = 2.0, .std = 0.2});
  const ParameterSpace space({{"a", "-"}, {"b", "-"}}, JointDistribution({prior, prior}));
  const FailingDerivatives failing;
  const UpdatingProblem problem{.model = model, .derivatives = &failing, .space = space};
  const Eigen::Vector2d x(2.0, 2.0);
  const Eigen::RowVector2d outputs = (slopes * x).transpose();
  std::int64_t runs = 0;
  const auto jacobians = scaled_jacobians(problem, ScaledParameters(space), x.transpose(), outputs, {}, runs);
  EXPECT_TRUE(jacobians[0].isApprox(slopes, 1e-9));
  EXPECT_TRUE(model_jacobian(problem, x, Eigen::Vector2d::Constant(0.2), {}, runs).isApprox(slopes, 1e-9));
}

TEST(ScaledJacobians, AFailureOnOneSideLeavesTheOtherAndOnBothLeavesNan) {
  test::LinearModel model(Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity());
  const Distribution prior({.kind = DistributionKind::normal, .mean = 2.0, .std = 0.2});
  const ParameterSpace space({{"a", "-"}, {"b", "-"}}, JointDistribution({prior, prior}));
  const ScaledParameters parameters(space);
  const Eigen::MatrixXd points = Eigen::RowVector2d(2.0, 2.0);
  model.fails = [](const Eigen::RowVectorXd& x) { return x(0) > 2.0 || x(1) != 2.0; };
  std::int64_t runs = 0;
  const auto jacobians =
      scaled_jacobians({.model = model, .space = space}, parameters, points, Eigen::RowVector2d(2.0, 2.0), {}, runs);
  EXPECT_NEAR(jacobians[0](0, 0), 1.0, 1e-9);
  EXPECT_TRUE(std::isnan(jacobians[0](0, 1)));
}

}  // namespace
}  // namespace mottle::updating
