#include "mottle/updating/methods/bayes.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "mottle/core/error.hpp"
#include "mottle/updating/estimate/posterior.hpp"
#include "support/bayes_three_masses.hpp"
#include "support/common_linear.hpp"
#include "support/methods.hpp"

namespace mottle::updating {
namespace {

using test::CommonLinear;
using test::k_stated_errors;
using test::mean_error;
using test::says;

class OneTest : public testing::TestWithParam<int> {};

TEST_P(OneTest, ReproducesThePosteriorOfThreeMassesByQuadrature) {
  const test::ThreeMassesReference reference = test::three_masses_references()[static_cast<std::size_t>(GetParam())];
  const test::OneTestOfThreeMasses one(reference.k6);
  const UpdatingResult result = BayesUpdater({}).update(one.problem(), {});
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  ASSERT_TRUE(result.posterior);
  const Evidence& evidence = result.posterior->evidence;
  EXPECT_NEAR(evidence.log_evidence, reference.log_evidence, k_stated_errors * evidence.standard_error);
  EXPECT_LT(evidence.standard_error, 0.1);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(result.mean(i), reference.mean(i), mean_error(result, i));
    EXPECT_NEAR(std::sqrt(result.covariance(i, i)), reference.standard_deviation(i),
                0.08 * reference.standard_deviation(i));  // 4 errors of 1,250 independent draws
  }
}

INSTANTIATE_TEST_SUITE_P(Models, OneTest, testing::Values(0, 1, 2));

/// All measured values as one normal vector: mean and covariance of (x, z), conditioned on z.
struct ClosedForm {
  Eigen::Vector2d mean;
  Eigen::Matrix2d covariance;
  double log_evidence = 0.0;

  ClosedForm(const TestData& tests, const Eigen::VectorXd& noise) {
    const Eigen::VectorXd error = tests.model_error_variance();
    std::vector<double> apart;
    std::vector<int> outputs;
    for (Eigen::Index s = 0; s < tests.values.rows(); ++s) {
      for (int k = 0; k < 3; ++k) {
        if (std::isnan(tests.values(s, k))) continue;
        outputs.push_back(k);
        apart.push_back(tests.values(s, k) -
                        (Eigen::Vector3d(1.0, 0.0, 2.0) + CommonLinear::slope() * Eigen::Vector2d(1.0, 2.0))(k));
      }
    }
    const auto n = static_cast<Eigen::Index>(outputs.size());
    const Eigen::Matrix2d prior = Eigen::Vector2d(0.04, 0.25).asDiagonal();
    Eigen::MatrixXd g(n, 2);
    for (Eigen::Index i = 0; i < n; ++i) g.row(i) = CommonLinear::slope().row(outputs[static_cast<std::size_t>(i)]);
    Eigen::MatrixXd c = g * prior * g.transpose();
    for (Eigen::Index i = 0; i < n; ++i) {
      const int k = outputs[static_cast<std::size_t>(i)];
      c(i, i) += noise(k) * noise(k);
      for (Eigen::Index j = 0; j < n; ++j) {
        if (outputs[static_cast<std::size_t>(j)] == k) c(i, j) += error(k);
      }
    }
    const Eigen::VectorXd r = Eigen::Map<const Eigen::VectorXd>(apart.data(), n);
    const Eigen::MatrixXd gain = prior * g.transpose() * c.inverse();
    mean = Eigen::Vector2d(1.0, 2.0) + gain * r;
    covariance = prior - gain * g * prior;
    log_evidence = -0.5 * (r.dot(c.inverse() * r) + std::log(c.determinant()) +
                           static_cast<double>(n) * std::log(2.0 * std::numbers::pi));
  }
};

void expect_closed_form(const CommonLinear& linear) {
  const UpdatingResult result = BayesUpdater({}).update(linear.problem(), {});
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  const ClosedForm exact(linear.tests, linear.tests.repeatability_std);
  const Evidence& evidence = result.posterior->evidence;
  EXPECT_NEAR(evidence.log_evidence, exact.log_evidence, k_stated_errors * evidence.standard_error);
  for (Eigen::Index i = 0; i < 2; ++i) {
    EXPECT_NEAR(result.mean(i), exact.mean(i), mean_error(result, i));
    EXPECT_NEAR(result.covariance(i, i), exact.covariance(i, i), 0.15 * exact.covariance(i, i));
  }
}

TEST(Bayes, HasTheClosedFormOfALinearModel) {
  expect_closed_form(CommonLinear());
}

TEST(Bayes, LeavesMissingEntriesOut) {
  CommonLinear linear;
  linear.tests.values(0, 1) = std::numeric_limits<double>::quiet_NaN();
  linear.tests.values(2, 0) = std::numeric_limits<double>::quiet_NaN();
  linear.tests.values(3, 0) = std::numeric_limits<double>::quiet_NaN();
  expect_closed_form(linear);
}

TEST(Bayes, IntegratesTheModelsErrorOut) {
  CommonLinear linear;
  linear.tests.model_error_std = Eigen::Vector3d(0.3, 0.0, 0.1);
  linear.tests.values(1, 2) = std::numeric_limits<double>::quiet_NaN();
  expect_closed_form(linear);
}

/// The level integrated over its prior by quadrature, the parameters in closed form for each level.
void expect_level_of_quadrature(BayesOptions::NoisePrior prior) {
  CommonLinear linear;
  linear.tests.repeatability_std.setZero();
  const BayesOptions options{.noise_prior = prior, .noise_scale = 0.03, .noise_degrees_of_freedom = 5.0};
  const UpdatingResult result = BayesUpdater(options).update(linear.problem(), {});
  ASSERT_TRUE(result.posterior);
  // Outputs of no known kind have one level for all, a fraction of the root mean square of all values.
  const double rms = std::sqrt(linear.tests.values.squaredNorm() / 12.0);
  const double nu = options.noise_degrees_of_freedom;
  const double s = options.noise_scale;
  const auto log_prior = [&](double level) {
    if (prior == BayesOptions::NoisePrior::half_t) {
      return std::log(2.0 / s) + std::lgamma(0.5 * (nu + 1.0)) - std::lgamma(0.5 * nu) -
             0.5 * std::log(nu * std::numbers::pi) - 0.5 * (nu + 1.0) * std::log1p(level * level / (nu * s * s));
    }
    const double variance = level * level;  // density of the variance times 2 level
    return 0.5 * nu * std::log(0.5 * nu * s * s) - std::lgamma(0.5 * nu) - (0.5 * nu + 1.0) * std::log(variance) -
           0.5 * nu * s * s / variance + std::log(2.0 * level);
  };
  const double reference = ClosedForm(linear.tests, Eigen::Vector3d::Constant(0.04 * rms)).log_evidence;
  const auto integral = [&](auto of_level) {
    const auto density = [&](double level) {
      const ClosedForm exact(linear.tests, Eigen::Vector3d::Constant(level * rms));
      return std::exp(exact.log_evidence - reference + log_prior(level)) * of_level(level, exact);
    };
    return boost::math::quadrature::gauss_kronrod<double, 31>::integrate(density, 1e-3, 1.0, 12, 1e-9);
  };
  const double mass = integral([](double, const ClosedForm&) { return 1.0; });
  const double level = integral([](double value, const ClosedForm&) { return value; }) / mass;
  const double first = integral([](double, const ClosedForm& exact) { return exact.mean(0); }) / mass;
  const SampledPosterior& posterior = *result.posterior;
  ASSERT_EQ(posterior.names.back(), "noise:outputs");
  EXPECT_NEAR(posterior.evidence.log_evidence, reference + std::log(mass),
              k_stated_errors * posterior.evidence.standard_error);
  const Eigen::VectorXd levels = posterior.values.col(2);
  const double std = std::sqrt((levels.array() - levels.mean()).square().mean());
  EXPECT_NEAR(levels.mean(), level, k_stated_errors * std / std::sqrt(posterior.ess_bulk(2)));
  EXPECT_NEAR(result.mean(0), first, mean_error(result, 0));
}

TEST(Bayes, SamplesALevelOfTheNoiseUnderAHalfT) {
  expect_level_of_quadrature(BayesOptions::NoisePrior::half_t);
}

TEST(Bayes, SamplesALevelOfTheNoiseUnderAnInverseGamma) {
  expect_level_of_quadrature(BayesOptions::NoisePrior::inverse_gamma);
}

/// Twice the tests halve the variance: it is no scatter of specimens.
TEST(Bayes, KnowsCommonParametersTheBetterTheMoreSpecimensThereAre) {
  CommonLinear linear;
  const double few = BayesUpdater({}).update(linear.problem(), {}).covariance(1, 1);
  const Eigen::MatrixXd once = linear.tests.values;
  linear.tests.values = once.replicate(4, 1);
  const UpdatingResult result = BayesUpdater({}).update(linear.problem(), {});
  EXPECT_NEAR(result.covariance(1, 1), 0.25 * few, 0.05 * few);
  EXPECT_FALSE(result.is_population);
  EXPECT_TRUE(says(result, "do not describe the scatter of specimens"));
}

TEST(Bayes, RefusesSpecimensThatScatterByMoreThanTheNoise) {
  CommonLinear linear;
  linear.tests.values.col(0) += Eigen::Vector4d(-0.5, 0.5, -0.5, 0.5);  // five times the noise
  const UpdatingResult result = BayesUpdater({}).update(linear.problem(), {});
  bool is_refused = false;
  for (const VerdictTest& test : result.tests) is_refused = is_refused || (test.name == "specimens" && !test.passed);
  EXPECT_TRUE(is_refused);
}

TEST(Bayes, PassesALinearModelThatIsRight) {
  CommonLinear linear;
  linear.tests.values << 3.28, 3.2, 3.9, 3.1, 3.5, 3.83, 3.15, 3.1, 3.88, 3.3, 3.45, 3.85;  // about y(1.1, 2.2)
  const UpdatingResult result = BayesUpdater({}).update(linear.problem(), {});
  EXPECT_GE(result.tests.size(), 2U);
  for (const VerdictTest& test : result.tests) EXPECT_TRUE(test.passed) << test.name;
}

TEST(Bayes, RefusesNoiseThatIsNeitherKnownNorEstimated) {
  CommonLinear linear;
  linear.tests.repeatability_std(1) = 0.0;
  try {
    BayesUpdater({.noise = BayesOptions::Noise::given}).update(linear.problem(), {});
    FAIL() << "noise that is not known was accepted";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("y2"), std::string::npos) << error.what();
  }
}

TEST(Bayes, CountsFailedRunsWhoseLikelihoodIsZero) {
  CommonLinear linear;
  linear.model.fails = [](const Eigen::RowVectorXd& x) { return x(0) > 1.15; };
  const UpdatingResult result = BayesUpdater({}).update(linear.problem(), {});
  EXPECT_GT(result.posterior->failed_runs, 0);
  EXPECT_LE(result.posterior->values.col(0).maxCoeff(), 1.15);
  EXPECT_TRUE(says(result, "likelihood zero"));
}

/// Two outputs that are the same twice say what one says with half the variance, and are no fault.
TEST(Bayes, TakesIdenticalOutputsForTwoMeasurements) {
  CommonLinear linear;
  Eigen::MatrixXd g(4, 2);
  g << CommonLinear::slope(), CommonLinear::slope().row(2);
  const test::LinearModel twice(Eigen::Vector4d(1.0, 0.0, 2.0, 2.0), g);
  Eigen::MatrixXd values(4, 4);
  values << linear.tests.values, linear.tests.values.col(2);
  const UpdatingProblem problem{.model = twice,
                                .space = *linear.space,
                                .tests = {values, Eigen::Vector4d(0.1, 0.2, 0.05, 0.05)},
                                .cloud = {.samples = 100}};
  const UpdatingResult result = BayesUpdater({}).update(problem, {});
  TestData half = linear.tests;
  half.repeatability_std(2) /= std::sqrt(2.0);
  const ClosedForm exact(half, half.repeatability_std);
  EXPECT_NEAR(result.mean(0), exact.mean(0), mean_error(result, 0));
  EXPECT_NEAR(result.mean(1), exact.mean(1), mean_error(result, 1));
}

}  // namespace
}  // namespace mottle::updating
