#include "mottle/drivers/calculix/separable_fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/message_of.hpp"
#include "mottle/core/error.hpp"

namespace mottle::drivers {
namespace {

using testing::HasSubstr;

/// Two chains of springs on one mass, by functions of x for the springs: K = f0 a a' + f1 b b' + c c'.
MatrixRun chain(double f0, double f1, double density) {
  const Eigen::Vector3d a(1, -1, 0);
  const Eigen::Vector3d b(0, 1, -1);
  const Eigen::Matrix3d k = f0 * a * a.transpose() + f1 * b * b.transpose() + Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d m = density * Eigen::Matrix3d::Identity();
  MatrixRun run;
  run.stiffness.lower = Eigen::MatrixXd(k.triangularView<Eigen::Lower>()).sparseView(-1.0, 1.0);
  run.mass.lower = Eigen::MatrixXd(m.triangularView<Eigen::Lower>()).sparseView(-1.0, 1.0);
  return run;
}

using Source = std::function<MatrixRun(const Eigen::VectorXd&)>;

/// Largest difference to the source at a point that the fit never saw.
double error_at(const SeparableFit& fit, const Source& source, const Eigen::VectorXd& x) {
  const MatrixRun run = source(x);
  const Eigen::MatrixXd k = Eigen::MatrixXd(fit.pencil.stiffness.at(x)) - Eigen::MatrixXd(run.stiffness.lower);
  const Eigen::MatrixXd m = Eigen::MatrixXd(fit.pencil.mass.at(x)) - Eigen::MatrixXd(run.mass.lower);
  return std::max(k.cwiseAbs().maxCoeff(), m.cwiseAbs().maxCoeff());
}

const std::vector<FitAxis> k_axes = {{"E", 200.0}, {"t", 0.01, true}, {"rho", 3.0}};
const Eigen::Vector3d k_elsewhere(170.0, 0.0123, 3.7);

TEST(SeparableFit, TakesTwoRunsMoreThanParametersWhereAllEnterLinearlyAndAlone) {
  const Source source = [](const Eigen::VectorXd& x) { return chain(x(0), 1e4 * x(1), x(2)); };
  const SeparableFit fit = fit_separable({{"E", 200.0}, {"t", 0.01}, {"rho", 3.0}}, source);
  EXPECT_EQ(fit.runs, 5);
  EXPECT_LE(error_at(fit, source, k_elsewhere), 1e-10);
}

TEST(SeparableFit, FindsPowersAndProducts) {
  const Source source = [](const Eigen::VectorXd& x) {
    return chain(x(0) * x(1) + 1.0, x(0) * (0.01 / x(1) + 1e5 * std::pow(x(1), 3)), x(2) * x(1) * 100.0);
  };
  const SeparableFit fit = fit_separable(k_axes, source);
  EXPECT_LE(fit.error, 1e-10);
  EXPECT_LE(error_at(fit, source, k_elsewhere), 1e-8 * 200.0);
}

TEST(SeparableFit, NamesTheParameterThatNoPowersFit) {
  const Source source = [](const Eigen::VectorXd& x) { return chain(std::exp(x(0) / 200.0), x(1), x(2)); };
  EXPECT_THAT(test::message_of<NotSeparable>([&] { fit_separable(k_axes, source); }), HasSubstr("parameter 'E'"));
}

TEST(SeparableFit, RefusesThreeParametersThatEnterTogether) {
  const Source source = [](const Eigen::VectorXd& x) { return chain(x(0) * x(1) * x(2), 1.0, 1.0); };
  EXPECT_THAT(test::message_of<NotSeparable>([&] { fit_separable(k_axes, source); }),
              HasSubstr("off the best sum of products of two parameters' powers"));
}

TEST(SeparableFit, RefusesRowsThatChange) {
  const Source source = [](const Eigen::VectorXd& x) {
    MatrixRun run = chain(x(0), x(1), x(2));
    if (x(0) > 220.0) run.stiffness.names = {"1", "2", "3"};
    return run;
  };
  EXPECT_THAT(test::message_of<NotSeparable>([&] { fit_separable(k_axes, source); }),
              HasSubstr("rows or entries of the solver's matrices change"));
}

}  // namespace
}  // namespace mottle::drivers
