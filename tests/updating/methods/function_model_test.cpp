// A user's own function updated by a method.
#include "mottle/model/function_model.hpp"

#include <gtest/gtest.h>

#include "mottle/stats/distributions/joint_distribution.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {
namespace {

// y = (x1 + x2, x1 - x2) of two normal parameters: a linear model's population is its specimens' mean and covariance.
TEST(UpdatedFunctionModel, HasThePopulationOfItsSpecimensWhereItIsLinear) {
  const auto sum_and_difference = [](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    return Eigen::Vector2d(x(0) + x(1), x(0) - x(1));
  };
  const FunctionModel model(2, {named_quantity("sum", "-"), named_quantity("difference", "-")}, sum_and_difference);
  const Distribution prior({.kind = DistributionKind::normal, .mean = 10.0, .std = 1.0});
  const ParameterSpace space({{.name = "x1", .unit = "-"}, {.name = "x2", .unit = "-"}},
                             JointDistribution({prior, prior}));
  Eigen::MatrixXd x(6, 2);
  x << 9.1, 10.3, 9.4, 10.0, 8.8, 10.9, 9.9, 10.2, 9.2, 11.1, 9.6, 10.6;
  TestData tests{.values = Eigen::MatrixXd(6, 2), .repeatability_std = Eigen::Vector2d::Zero()};
  tests.values << x.col(0) + x.col(1), x.col(0) - x.col(1);
  const UpdatingResult found = find_method("maximum-likelihood")
                                   .make({}, "test")
                                   ->update({.model = model, .space = space, .tests = tests}, {.seed = 1});
  const Eigen::RowVector2d mean = x.colwise().mean();
  EXPECT_LT((found.mean.transpose() - mean).cwiseAbs().maxCoeff(), 1e-6);
  const Eigen::MatrixXd centred = x.rowwise() - mean;
  EXPECT_LT((found.covariance - centred.transpose() * centred / 5.0).cwiseAbs().maxCoeff(), 1e-4);
}

}  // namespace
}  // namespace mottle::updating
