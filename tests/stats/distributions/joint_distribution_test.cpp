#include "mottle/stats/distributions/joint_distribution.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <openturns/ComposedDistribution.hxx>
#include <openturns/CorrelationMatrix.hxx>
#include <openturns/LogNormal.hxx>
#include <openturns/NormalCopula.hxx>
#include <openturns/Uniform.hxx>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/stats/sampling/sampling.hpp"
#include "stats/relative_error.hpp"

namespace mottle::stats {
namespace {

using Kind = DistributionKind;

const Distribution k_normal({.kind = Kind::normal, .mean = 2.0, .std = 0.3});
const Distribution k_lognormal({.kind = Kind::lognormal, .mean = 2.0, .std = 0.3});
const Distribution k_uniform({.kind = Kind::uniform, .lower = 0.5, .upper = 3.0});
const Distribution k_truncated({.kind = Kind::truncated_normal, .mean = 2.0, .std = 0.3, .lower = 1.5, .upper = 2.2});
const Distribution k_beta({.kind = Kind::beta, .mean = 2.0, .std = 0.3, .lower = 0.5, .upper = 3.0});
const Distribution k_gamma({.kind = Kind::gamma, .mean = 2.0, .std = 0.3});

Eigen::MatrixXd correlation_of_two(double rho) {
  return (Eigen::MatrixXd(2, 2) << 1.0, rho, rho, 1.0).finished();
}

double covariance_of_two(const Distribution& a, const Distribution& b, double rho) {
  return JointDistribution({a, b}, correlation_of_two(rho)).covariance()(0, 1);
}

TEST(JointDistribution, IndependentVariablesAreTheQuantilesOfTheirUniforms) {
  const JointDistribution joint({k_normal, k_gamma});
  const Eigen::MatrixXd uniforms = (Eigen::MatrixXd(2, 2) << 0.1, 0.9, 1e-12, 0.4).finished();
  const Eigen::MatrixXd samples = joint.from_uniform(uniforms);
  for (Eigen::Index row = 0; row < 2; ++row) {
    EXPECT_EQ(samples(row, 0), k_normal.quantile(uniforms(row, 0)));
    EXPECT_EQ(samples(row, 1), k_gamma.quantile(uniforms(row, 1)));
  }
}

TEST(JointDistribution, IndependentVariablesRiseWithTheirUniforms) {
  const JointDistribution joint({k_normal, k_lognormal, k_uniform, k_truncated, k_beta, k_gamma});
  Eigen::MatrixXd uniforms(1001, 6);
  for (Eigen::Index row = 0; row < uniforms.rows(); ++row) {
    // From 2^-53, the smallest uniform that a stream can give, to its mirror image.
    uniforms.row(row).setConstant(standard_normal_cdf((static_cast<double>(row) - 500.0) / 500.0 * 8.1));
  }
  const Eigen::MatrixXd samples = joint.from_uniform(uniforms);
  EXPECT_TRUE((samples.bottomRows(1000).array() >= samples.topRows(1000).array()).all());
  EXPECT_TRUE(samples.allFinite());
}

TEST(JointDistribution, ARowDoesNotDependOnItsNeighbours) {
  const Eigen::MatrixXd uniforms = uniform_design(SamplingDesign::monte_carlo, 37, 3, {.seed = 5});
  Eigen::MatrixXd correlation = Eigen::MatrixXd::Constant(3, 3, 0.4);
  correlation.diagonal().setOnes();
  const Eigen::MatrixXd covariance = 0.09 * correlation;
  for (const JointDistribution& joint :
       {JointDistribution({k_normal, k_beta, k_lognormal}, correlation),
        JointDistribution::multivariate_normal(Eigen::Vector3d(1.0, 2.0, 3.0), covariance)}) {
    const Eigen::MatrixXd together = joint.from_uniform(uniforms);
    for (Eigen::Index row = 0; row < uniforms.rows(); ++row) {
      EXPECT_EQ(together.row(row), joint.from_uniform(uniforms.row(row)));
    }
  }
}

// cov = m^2 (exp(rho s^2) - 1), s the standard deviation of the logarithm: closed form of the bivariate lognormal.
TEST(JointDistribution, CovarianceOfTwoLognormalsIsTheClosedForm) {
  const double log_variance = std::log1p(0.15 * 0.15);
  for (const double rho : {-0.9, 0.3, 0.8}) {
    EXPECT_TRUE(is_relatively_near(covariance_of_two(k_lognormal, k_lognormal, rho),
                                   4.0 * std::expm1(rho * log_variance), 1e-10));
  }
}

// Pearson correlation of two uniforms under a normal copula: 6 / pi asin(rho / 2), [Kruskal1958].
TEST(JointDistribution, CovarianceOfTwoUniformsIsTheClosedForm) {
  for (const double rho : {-0.99, 0.3, 0.8}) {
    const double expected = 6.0 / std::numbers::pi * std::asin(0.5 * rho) * 2.5 * 2.5 / 12.0;
    EXPECT_TRUE(is_relatively_near(covariance_of_two(k_uniform, k_uniform, rho), expected, 1e-10));
  }
}

// SciPy 1.10 and NumPy, Gauss-Hermite rule of 120 x 120 nodes (80 x 80 agrees to 14 digits):
//   z, w = numpy.polynomial.hermite_e.hermegauss(120)
//   sum w_i w_j (ppf_a(Phi(z_i)) - mean_a) (ppf_b(Phi(rho z_i + sqrt(1 - rho^2) z_j)) - mean_b)
TEST(JointDistribution, CovarianceOfOtherPairsIsThatOfATwoDimensionalQuadrature) {
  EXPECT_TRUE(is_relatively_near(covariance_of_two(k_gamma, k_beta, 0.6), 0.05365449729696245, 1e-10));
  EXPECT_TRUE(is_relatively_near(covariance_of_two(k_gamma, k_truncated, -0.7), -0.0372348244719164, 1e-10));
  EXPECT_TRUE(is_relatively_near(covariance_of_two(k_beta, k_truncated, 0.95), 0.050813335387018654, 1e-10));
}

// OpenTURNS integrates on a coarse grid: 1.9 % from the closed form for lognormals at rho = 0.3, less elsewhere.
TEST(JointDistribution, CovarianceAgreesWithOpenTurnsWithinItsQuadrature) {
  const double log_std = std::sqrt(std::log1p(0.15 * 0.15));
  OT::CorrelationMatrix correlation(2);
  correlation(1, 0) = 0.8;
  OT::ComposedDistribution::DistributionCollection marginals;
  marginals.add(OT::LogNormal(std::log(2.0) - 0.5 * log_std * log_std, log_std));
  marginals.add(OT::Uniform(0.5, 3.0));
  const OT::ComposedDistribution reference(marginals, OT::NormalCopula(correlation));
  EXPECT_TRUE(
      is_relatively_near(covariance_of_two(k_lognormal, k_uniform, 0.8), reference.getCovariance()(1, 0), 0.025));
}

TEST(JointDistribution, CovarianceOfNormalsIsTheCorrelationTimesTheDeviations) {
  EXPECT_TRUE(is_relatively_near(covariance_of_two(k_normal, k_normal, -0.95), -0.95 * 0.09, 1e-12));
}

// OpenTURNS' own transform for one point, from the definition: the copula's uniforms at (w1, w2) are Phi(w1), Phi(w2).
TEST(JointDistribution, JointProbabilityBelowASampleIsThatOfOpenTurnsCopula) {
  OT::CorrelationMatrix correlation(2);
  correlation(1, 0) = 0.6;
  const OT::NormalCopula copula(correlation);
  const JointDistribution joint({k_gamma, k_beta}, correlation_of_two(0.6));
  constexpr Eigen::Index k_samples = 20000;
  const Eigen::MatrixXd samples =
      joint.from_uniform(uniform_design(SamplingDesign::monte_carlo, k_samples, 2, {.seed = 11}));
  for (const double level : {0.1, 0.5, 0.8}) {
    const double a = k_gamma.quantile(level);
    const double b = k_beta.quantile(0.5);
    const double expected = copula.computeCDF(OT::Point({level, 0.5}));
    const auto below = (samples.col(0).array() < a && samples.col(1).array() < b).count();
    const double four_errors = 4.0 * std::sqrt(expected * (1.0 - expected) / k_samples);
    EXPECT_NEAR(static_cast<double>(below) / k_samples, expected, four_errors);
  }
}

TEST(JointDistribution, SamplesHaveTheMeanAndCovarianceThatAreClaimed) {
  Eigen::MatrixXd correlation(3, 3);
  correlation << 1.0, 0.6, -0.3, 0.6, 1.0, 0.2, -0.3, 0.2, 1.0;
  const JointDistribution joint({k_gamma, k_beta, k_lognormal}, correlation);
  constexpr Eigen::Index k_samples = 100000;
  const Eigen::MatrixXd samples =
      joint.from_uniform(uniform_design(SamplingDesign::monte_carlo, k_samples, 3, {.seed = 3}));
  const Eigen::MatrixXd covariance = sample_covariance(samples);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(samples.col(i).mean(), joint.mean()[i], 4.0 * 0.3 / std::sqrt(k_samples));
    for (Eigen::Index j = 0; j < 3; ++j) {
      // Standard error of a covariance, at most sqrt((1 + rho^2) / n) s_i s_j times a little for kurtosis up to 4.
      EXPECT_NEAR(covariance(i, j), joint.covariance()(i, j), 4.0 * std::sqrt(3.0 / k_samples) * 0.09);
    }
  }
}

TEST(JointDistribution, MultivariateNormalHasItsMomentsAndAllowsSingularCovariance) {
  const Eigen::Vector3d direction(1.0, -2.0, 0.0);
  const Eigen::Vector3d mean(5.0, 6.0, 7.0);
  const Eigen::MatrixXd covariance = direction * direction.transpose();
  const JointDistribution joint = JointDistribution::multivariate_normal(mean, covariance);
  EXPECT_EQ(joint.dimension(), 3);
  EXPECT_EQ(joint.covariance(), covariance);
  EXPECT_TRUE(joint.marginals().empty());
  constexpr Eigen::Index k_samples = 10000;
  const Eigen::MatrixXd samples =
      joint.from_uniform(uniform_design(SamplingDesign::monte_carlo, k_samples, 3, {.seed = 2}));
  EXPECT_LT((samples.col(2).array() - 7.0).abs().maxCoeff(), 1e-7);  // square root of a rounding of 1e-16
  EXPECT_LT((2.0 * (samples.col(0).array() - 5.0) + samples.col(1).array() - 6.0).abs().maxCoeff(), 1e-6);
  EXPECT_NEAR(sample_covariance(samples)(0, 1), -2.0, 4.0 * 2.0 * std::sqrt(2.0 / k_samples));
}

TEST(JointDistribution, MultivariateNormalUsesTheSymmetricSquareRoot) {
  const Eigen::MatrixXd covariance = (Eigen::MatrixXd(2, 2) << 5.0, 4.0, 4.0, 5.0).finished();  // root [2 1; 1 2]
  const JointDistribution joint = JointDistribution::multivariate_normal(Eigen::Vector2d::Zero(), covariance);
  Eigen::MatrixXd uniforms(1, 2);
  uniforms << standard_normal_cdf(1.0), 0.5;
  EXPECT_NEAR(joint.from_uniform(uniforms)(0, 0), 2.0, 1e-14);
  EXPECT_NEAR(joint.from_uniform(uniforms)(0, 1), 1.0, 1e-14);
}

/// Against central differences: a relative error of 1e-9 by the step, and some rounding of the quantiles over it.
void expect_derivatives_of_differences(const JointDistribution& joint) {
  constexpr double k_step = 1e-5;
  for (const double score : {-2.5, -0.3, 1.7}) {
    const Eigen::VectorXd point = Eigen::VectorXd::LinSpaced(joint.dimension(), score, score + 0.8);
    const Eigen::MatrixXd derivatives = joint.standard_normal_derivatives(point);
    for (Eigen::Index i = 0; i < point.size(); ++i) {
      const Eigen::VectorXd step = k_step * Eigen::VectorXd::Unit(point.size(), i);
      const Eigen::RowVectorXd difference = joint.from_standard_normal((point + step).transpose()) -
                                            joint.from_standard_normal((point - step).transpose());
      for (Eigen::Index j = 0; j < point.size(); ++j) {
        const double rounding = 1e-15 / k_step * std::abs(joint.from_standard_normal(point.transpose())(0, j));
        EXPECT_NEAR(derivatives(j, i), difference(j) / (2.0 * k_step),
                    1e-7 * derivatives.row(j).cwiseAbs().maxCoeff() + rounding)
            << j << ' ' << i;
      }
    }
  }
}

TEST(JointDistribution, KnowsTheDerivativesOfItsTransform) {
  const std::vector<Distribution> marginals{
      k_normal,
      k_beta,
      Distribution({.kind = DistributionKind::lognormal, .mean = 1.5, .std = 0.5}),
      Distribution({.kind = DistributionKind::uniform, .lower = 1.0, .upper = 3.0}),
      Distribution({.kind = DistributionKind::gamma, .mean = 2.0, .std = 0.7}),
      Distribution({.kind = DistributionKind::truncated_normal, .mean = 1.0, .std = 0.5, .lower = 0.2, .upper = 1.4})};
  expect_derivatives_of_differences(JointDistribution(marginals));
  Eigen::MatrixXd correlation = Eigen::MatrixXd::Constant(6, 6, 0.4);
  correlation.diagonal().setOnes();
  expect_derivatives_of_differences(JointDistribution(marginals, correlation));
  const Eigen::Matrix2d covariance = (Eigen::Matrix2d() << 0.04, 0.01, 0.01, 0.09).finished();
  expect_derivatives_of_differences(JointDistribution::multivariate_normal(Eigen::Vector2d(1.0, 2.0), covariance));
  const std::vector<ParameterTransform> scales{{.kind = ParameterTransform::Kind::log},
                                               {.kind = ParameterTransform::Kind::logit, .lower = 1.0, .upper = 4.0}};
  expect_derivatives_of_differences(
      JointDistribution::transformed_normal(scales, Eigen::Vector2d(0.1, -0.4), covariance));
}

template <typename Make>
std::string message_of(const Make& make) {
  try {
    make();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

TEST(JointDistribution, SaysWhatIsWrongWithAMatrix) {
  using ::testing::HasSubstr;
  const auto joint = [](double diagonal, double upper, double lower) {
    return [=] {
      const Eigen::MatrixXd matrix = (Eigen::MatrixXd(2, 2) << diagonal, upper, lower, 1.0).finished();
      JointDistribution({k_normal, k_beta}, matrix);
    };
  };
  EXPECT_THAT(message_of(joint(1.0, 0.5, 0.4)), HasSubstr("not symmetric"));
  EXPECT_THAT(message_of(joint(0.9, 0.5, 0.5)), HasSubstr("diagonal entry 0 is 0.9"));
  EXPECT_THAT(message_of(joint(1.0, 1.5, 1.5)), HasSubstr("smallest eigenvalue is -0.5"));
  EXPECT_THAT(message_of(joint(1.0, NAN, NAN)), HasSubstr("not finite"));
  EXPECT_THAT(message_of([] { JointDistribution({k_normal}, correlation_of_two(0.1)); }), HasSubstr("2 x 2"));
  EXPECT_THAT(
      message_of([] {
        static_cast<void>(JointDistribution::multivariate_normal(Eigen::Vector2d::Zero(), correlation_of_two(1.5)));
      }),
      HasSubstr("smallest eigenvalue is -0.5"));
}

TEST(JointDistribution, RefusesUniformsOutsideTheOpenInterval) {
  const JointDistribution joint({k_normal});
  EXPECT_THROW(static_cast<void>(joint.from_uniform(Eigen::MatrixXd::Zero(1, 1))), InvalidInput);
  EXPECT_THROW(static_cast<void>(joint.from_uniform(Eigen::MatrixXd::Ones(1, 1))), InvalidInput);
  EXPECT_THROW(static_cast<void>(joint.from_uniform(Eigen::MatrixXd::Constant(1, 1, NAN))), InvalidInput);
  EXPECT_THROW(static_cast<void>(joint.from_uniform(Eigen::MatrixXd::Constant(1, 2, 0.5))), InvalidInput);
}

}  // namespace
}  // namespace mottle::stats
