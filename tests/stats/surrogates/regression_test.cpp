#include "mottle/stats/surrogates/regression.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <openturns/LinearLeastSquares.hxx>
#include <openturns/Matrix.hxx>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/joint_distribution.hpp"
#include "mottle/stats/sampling/sampling.hpp"
#include "stats/relative_error.hpp"

namespace mottle::stats {
namespace {

Eigen::MatrixXd small_inputs() {
  return (Eigen::MatrixXd(8, 2) << 1.0, 210.0, 1.2, 190.0, 0.8, 205.0, 1.1, 220.0, 0.9, 180.0, 1.3, 215.0, 1.05, 199.0,
          0.7, 208.0)
      .finished();
}

Eigen::MatrixXd small_outputs() {
  return (Eigen::MatrixXd(8, 2) << 3.1, 10.2, 3.4, 9.1, 2.7, 10.9, 3.5, 9.9, 2.6, 9.8, 3.9, 8.7, 3.0, 9.6, 2.5, 11.2)
      .finished();
}

Eigen::MatrixXd standard_normals(Eigen::Index samples, Eigen::Index dimension, std::uint32_t draw) {
  const JointDistribution normal = JointDistribution::multivariate_normal(
      Eigen::VectorXd::Zero(dimension), Eigen::MatrixXd::Identity(dimension, dimension));
  return normal.from_uniform(uniform_design(SamplingDesign::monte_carlo, samples, dimension,
                                            {.seed = 17, .purpose = StreamPurpose::bootstrap, .iteration = draw}));
}

OT::Sample to_openturns(const Eigen::MatrixXd& values) {
  OT::Sample sample(static_cast<OT::UnsignedInteger>(values.rows()), static_cast<OT::UnsignedInteger>(values.cols()));
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    for (Eigen::Index j = 0; j < values.cols(); ++j) {
      sample(static_cast<OT::UnsignedInteger>(i), static_cast<OT::UnsignedInteger>(j)) = values(i, j);
    }
  }
  return sample;
}

template <typename Regression>
std::string message_of(const Regression& regression, const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) {
  try {
    static_cast<void>(regression(x, y));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

// NumPy: numpy.linalg.lstsq(numpy.c_[ones, X - X.mean(0)], Y); standard errors from inv(Z.T @ Z), leverage
// diag(Z @ inv(Z.T @ Z) @ Z.T), condition numpy.linalg.cond of the centred columns at length 1.
TEST(LinearRegression, AgreesWithNumpyForASmallSample) {
  const LinearRegression fit = linear_regression(small_inputs(), small_outputs());
  EXPECT_TRUE(is_relatively_near(fit.intercept[0], 3.0875, 1e-14));
  EXPECT_TRUE(is_relatively_near(fit.intercept[1], 9.925, 1e-14));
  EXPECT_TRUE(is_relatively_near(fit.sensitivity(0, 0), 2.1678666857038085, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.sensitivity(0, 1), 0.011758826768923338, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.sensitivity(1, 0), -4.138825174254656, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.sensitivity(1, 1), 0.017934829973094646, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.residual_std[0], 0.07273002625990628, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.residual_std[1], 0.17620427279608897, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.r_squared[0], 0.9841508412890887, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.r_squared[1], 0.9686700850135231, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.standard_error(0, 0), 0.1385888417839911, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.standard_error(1, 1), 0.005098369537360139, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.leverage[0], 0.16259500794552909, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.leverage[7], 0.5076738791426617, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.condition, 1.169177367535661, 1e-10));
}

// More rows than three blocks of the factorisation. OpenTURNS does not scale its columns and drops small singular
// values, so the inputs must be of similar size for its answer to be one.
TEST(LinearRegression, AgreesWithOpenTurnsForALargeSample) {
  constexpr Eigen::Index k_samples = 4000;
  const Eigen::Vector3d scale(0.1, 1.0, 10.0);
  const Eigen::MatrixXd x =
      (standard_normals(k_samples, 3, 0) * scale.asDiagonal()).rowwise() + scale.transpose() * 7.0;
  Eigen::MatrixXd y(k_samples, 2);
  y.col(0) = x.col(0).cwiseProduct(x.col(1)) + 1e-5 * x.col(2);
  y.col(1) = x.col(2).array().sqrt();
  const LinearRegression fit = linear_regression(x, y);
  OT::LinearLeastSquares reference(to_openturns(x), to_openturns(y));
  reference.run();
  const OT::Matrix linear = reference.getLinear();  // [input x output]
  for (OT::UnsignedInteger i = 0; i < 3; ++i) {
    for (OT::UnsignedInteger o = 0; o < 2; ++o) {
      const double ours = fit.sensitivity(static_cast<Eigen::Index>(o), static_cast<Eigen::Index>(i));
      EXPECT_NEAR(ours, linear(i, o), 1e-10 * fit.sensitivity.row(static_cast<Eigen::Index>(o)).norm())
          << "output " << o << ", input " << i;
    }
  }
  EXPECT_NEAR(fit.leverage.sum(), 4.0, 1e-10);
}

TEST(LinearRegression, DoesNotDependOnTheUnitsOfTheInputs) {
  const Eigen::Vector2d units(1e-12, 1e11);
  const LinearRegression fit = linear_regression(small_inputs() * units.asDiagonal(), small_outputs());
  EXPECT_TRUE(is_relatively_near(fit.sensitivity(0, 0) * units[0], 2.1678666857038085, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.sensitivity(1, 1) * units[1], 0.017934829973094646, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.condition, 1.169177367535661, 1e-10));
}

TEST(LinearRegression, RecoversAnExactlyLinearModel) {
  const Eigen::MatrixXd x = standard_normals(3000, 5, 1);
  const Eigen::MatrixXd slope = standard_normals(5, 2, 2);
  const Eigen::MatrixXd y = (x * slope).array() + 10.0;
  const LinearRegression fit = linear_regression(x, y);
  EXPECT_LT((fit.sensitivity - slope.transpose()).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_LT(fit.residual_std.maxCoeff(), 1e-12);
  EXPECT_NEAR(fit.r_squared.minCoeff(), 1.0, 1e-14);
}

// X'X of these columns has condition 1e16: normal equations keep no digit where QR keeps eight.
TEST(LinearRegression, KeepsItsDigitsWhereNormalEquationsLoseThem) {
  Eigen::MatrixXd x = standard_normals(500, 2, 3);
  x.col(1) = x.col(0) + 1e-8 * x.col(1);
  const Eigen::MatrixXd y = x.col(0) + x.col(1);
  const LinearRegression fit = linear_regression(x, y);
  EXPECT_GT(fit.condition, 1e7);
  EXPECT_NEAR(fit.sensitivity(0, 0), 1.0, 1e-6);
  EXPECT_NEAR(fit.sensitivity(0, 1), 1.0, 1e-6);
}

TEST(LinearRegression, OutputWithoutScatterIsExplainedInFull) {
  const LinearRegression fit = linear_regression(small_inputs(), Eigen::MatrixXd::Constant(8, 1, 0.1));
  EXPECT_EQ(fit.r_squared[0], 1.0);
  EXPECT_EQ(fit.residual_std[0], 0.0);
  EXPECT_EQ(fit.sensitivity(0, 0), 0.0);
}

TEST(LinearRegression, NamesTheColumnThatCannotBeResolved) {
  Eigen::MatrixXd x = standard_normals(50, 3, 4);
  const Eigen::MatrixXd y = x.leftCols(1);
  x.col(1).setConstant(0.1);
  EXPECT_THAT(message_of(linear_regression, x, y), ::testing::HasSubstr("input column 1 (from 0) does not vary"));
  x.col(1) = x.col(0) + 2.0 * x.col(2);
  EXPECT_THAT(message_of(linear_regression, x, y), ::testing::HasSubstr("depends linearly on the others"));
}

TEST(LinearRegression, RefusesTooFewSamplesAndEntriesThatAreNotFinite) {
  Eigen::MatrixXd x = small_inputs();
  const Eigen::MatrixXd y = small_outputs();
  EXPECT_THAT(message_of(linear_regression, x.topRows(3), y.topRows(3)), ::testing::HasSubstr("need at least 4"));
  EXPECT_EQ(message_of(linear_regression, x.topRows(4), y.topRows(4)), "accepted");
  EXPECT_THAT(message_of(linear_regression, x, y.topRows(4)), ::testing::HasSubstr("8 rows of inputs"));
  EXPECT_THAT(message_of(linear_regression, Eigen::MatrixXd(8, 0), y), ::testing::HasSubstr("0 inputs"));
  x(3, 1) = NAN;
  EXPECT_THAT(message_of(linear_regression, x, y), ::testing::HasSubstr("an input is not finite"));
}

// t(0.975; 27) = 2.0518305164802833, SciPy 1.10: t.ppf(.975, 27).
TEST(LinearRegression, StandardErrorsCoverTheTruthAsOftenAsTheyClaim) {
  constexpr int k_replications = 2000;
  const Eigen::MatrixXd x = standard_normals(30, 2, 5);
  int covered = 0;
  for (std::uint32_t replication = 0; replication < k_replications; ++replication) {
    const Eigen::MatrixXd y = 3.0 * x.col(0) - x.col(1) + 0.7 * standard_normals(30, 1, 100 + replication);
    const LinearRegression fit = linear_regression(x, y);
    if (std::abs(fit.sensitivity(0, 0) - 3.0) <= 2.0518305164802833 * fit.standard_error(0, 0)) ++covered;
  }
  EXPECT_NEAR(static_cast<double>(covered) / k_replications, 0.95, 4.0 * std::sqrt(0.95 * 0.05 / k_replications));
}

// NumPy: D = X - X.mean(0), lstsq(c_[ones, D, D0^2, D0 D1, D1^2], Y).
TEST(QuadraticRegression, AgreesWithNumpyForASmallSample) {
  Eigen::MatrixXd x(12, 2);
  x << 1.76, 173.51, 1.93, 208.41, 2.34, 202.19, 1.83, 184.3, 2.22, 232.7, 2.08, 175.33, 1.71, 232.0, 2.06, 165.36,
      1.97, 176.74, 1.81, 190.24, 1.79, 211.07, 1.98, 188.21;
  Eigen::MatrixXd y(12, 1);
  y << 17.516, 20.139, 21.587, 18.339, 22.631, 19.079, 19.789, 18.459, 18.656, 18.526, 19.333, 19.265;
  const QuadraticRegression fit = quadratic_regression(x, y);
  EXPECT_TRUE(is_relatively_near(fit.constant[0], 19.527909613223866, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.sensitivity(0, 0), 4.949039763953628, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.sensitivity(0, 1), 0.04919415745927637, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.hessian[0](0, 0), 2.0 * -1.6701906026292987, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.hessian[0](0, 1), 0.01715657992071218, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.hessian[0](1, 1), 2.0 * -6.323637392856922e-05, 1e-9));
  EXPECT_TRUE(is_relatively_near(fit.residual_std[0], 0.05438882160063812, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.r_squared[0], 0.9992249793876342, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.standard_error(0, 0), 0.11251909596501064, 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.standard_error(0, 1), 0.0009577491958876568, 1e-10));
}

TEST(QuadraticRegression, RecoversAnExactlyQuadraticModelEverywhere) {
  const Eigen::Vector3d scale(1.0, 1e-3, 1e4);
  const Eigen::MatrixXd x = (standard_normals(3000, 3, 6) * scale.asDiagonal()).rowwise() + 5.0 * scale.transpose();
  const auto model = [&](const Eigen::Vector3d& point) {
    const Eigen::Vector3d u = point.cwiseQuotient(scale);
    return 1.0 + u[0] - 2.0 * u[1] + 0.5 * u[0] * u[2] + 3.0 * u[1] * u[1];
  };
  Eigen::MatrixXd y(x.rows(), 1);
  for (Eigen::Index row = 0; row < x.rows(); ++row) y(row, 0) = model(x.row(row).transpose());
  const QuadraticRegression fit = quadratic_regression(x, y);
  const Eigen::Vector3d point = Eigen::Vector3d(4.0, 7.0, 3.0).cwiseProduct(scale);
  EXPECT_TRUE(is_relatively_near(fit.predict(point)[0], model(point), 1e-11));
  const Eigen::Vector3d slope = Eigen::Vector3d(1.0 + 0.5 * 3.0, -2.0 + 6.0 * 7.0, 0.5 * 4.0).cwiseQuotient(scale);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_TRUE(is_relatively_near(fit.sensitivity_at(point)(0, i), slope[i], 1e-10));
  }
  EXPECT_TRUE(is_relatively_near(fit.hessian[0](0, 2), 0.5 / scale[0] / scale[2], 1e-10));
  EXPECT_TRUE(is_relatively_near(fit.hessian[0](1, 1), 6.0 / scale[1] / scale[1], 1e-10));
}

TEST(QuadraticRegression, SaysHowManySamplesItNeedsAndWhichTermDepends) {
  Eigen::MatrixXd x = standard_normals(50, 2, 7);
  const Eigen::MatrixXd y = x.leftCols(1);
  EXPECT_THAT(message_of(quadratic_regression, x.topRows(6), y.topRows(6)), ::testing::HasSubstr("need at least 7"));
  x.col(1) = x.col(1).array().sign();  // two levels: the square is a combination of the column and a constant
  EXPECT_THAT(message_of(quadratic_regression, x, y), ::testing::HasSubstr("input column"));
  const QuadraticRegression fit = quadratic_regression(standard_normals(50, 2, 8), y);
  EXPECT_THROW(static_cast<void>(fit.predict(Eigen::Vector3d::Zero())), InvalidInput);
  EXPECT_THROW(static_cast<void>(fit.sensitivity_at(Eigen::Vector3d::Zero())), InvalidInput);
}

}  // namespace
}  // namespace mottle::stats
