#include "mottle/updating/methods/hierarchical.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mottle/core/error.hpp"
#include "mottle/model/function_model.hpp"
#include "mottle/updating/estimate/posterior.hpp"
#include "mottle/updating/verdict/verdict.hpp"
#include "support/common_linear.hpp"
#include "support/eight_schools.hpp"
#include "support/linear_problem.hpp"
#include "support/methods.hpp"
#include "support/three_masses.hpp"
#include "updating/population/population_prior.hpp"

namespace mottle::updating {
namespace {

using test::k_stated_errors;
using test::says;

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

Eigen::Index column_of(const SampledPosterior& posterior, const std::string& name) {
  return std::distance(posterior.names.begin(), std::find(posterior.names.begin(), posterior.names.end(), name));
}

/// A posterior mean against a reference, by the effective sample size that the method states.
void expect_mean(const UpdatingResult& result, const std::string& name, double reference) {
  const Eigen::Index k = column_of(*result.posterior, name);
  ASSERT_LT(k, result.posterior->values.cols()) << name;
  const Eigen::ArrayXd values = result.posterior->values.col(k).array();
  const double std = std::sqrt((values - values.mean()).square().mean());
  EXPECT_NEAR(values.mean(), reference, k_stated_errors * std / std::sqrt(result.posterior->ess_bulk(k))) << name;
}

TEST(Hierarchical, ReproducesTheEightSchoolsPosteriorByQuadrature) {
  using test::EightSchools;
  const EightSchools schools;
  const UpdatingResult result = HierarchicalUpdater(EightSchools::options()).update(schools.problem(), {});
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  const Evidence& evidence = result.posterior->evidence;
  EXPECT_NEAR(evidence.log_evidence, EightSchools::log_evidence, k_stated_errors * evidence.standard_error);
  EXPECT_LT(evidence.standard_error, 0.05);
  expect_mean(result, "mu:x", EightSchools::mean);
  expect_mean(result, "sigma:x", EightSchools::scatter);
  expect_mean(result, "x:1", EightSchools::first_school);
  const Eigen::ArrayXd mu = result.posterior->values.col(0).array();
  EXPECT_NEAR(std::sqrt((mu - mu.mean()).square().mean()), EightSchools::mean_std, 0.08 * EightSchools::mean_std);
}

/// y = exp(x) of one parameter x ~ N(mu, sigma), mu ~ N(0, 0.5), sigma half-t with 4 degrees of freedom and scale 0.5,
/// three specimens, noise 0.4: as large as the scatter, so that a linear model is wrong.
struct Exponential {
  Exponential()
      : model(1, {named_quantity("y", "-")},
              [](const Eigen::VectorXd& x) -> Eigen::VectorXd { return x.array().exp().matrix(); }) {
    constexpr PhysicalLimit k_free{.lower = -1e9, .excludes_lower = false};
    const Distribution prior({.kind = DistributionKind::normal, .mean = 0.0, .std = 0.5});
    space = std::make_unique<ParameterSpace>(std::vector<Parameter>{{"x", "-", -50.0, 50.0, k_free}},
                                             JointDistribution({prior}));
    tests.values = Eigen::Vector3d(0.5, 1.4, 2.3);
    tests.repeatability_std = Eigen::VectorXd::Constant(1, 0.4);
  }
  UpdatingProblem problem() const {
    return {.model = model, .space = *space, .tests = tests, .cloud = {.samples = 100}};
  }
  FunctionModel model;
  std::unique_ptr<ParameterSpace> space;
  TestData tests;
};

/// Sums over grids of mu, ln sigma and, for each specimen, (x - mu) / sigma.
struct ExponentialReference {
  double log_evidence = 0.0, mean = 0.0, scatter = 0.0, first = 0.0;

  ExponentialReference() {
    const Eigen::ArrayXd mus = Eigen::ArrayXd::LinSpaced(121, -2.5, 2.5);
    const Eigen::ArrayXd log_sigmas = Eigen::ArrayXd::LinSpaced(161, std::log(1e-3), std::log(5.0));
    double mass = 0.0;
    for (const double mu : mus) {
      for (const double log_sigma : log_sigmas) {
        const double sigma = std::exp(log_sigma);
        const double prior = std::exp(-2.0 * mu * mu) * std::pow(1.0 + sigma * sigma, -2.5) * sigma;
        const auto [density, first_moment] = of_tests(mu, sigma);
        mass += prior * density;
        mean += prior * density * mu;
        scatter += prior * density * sigma;
        first += prior * density * first_moment;
      }
    }
    mean /= mass;
    scatter /= mass;
    first /= mass;
    // Densities at 0: 1 / (0.5 sqrt(2 pi)) of mu, 2 / 0.5 * 3 / 8 of sigma.
    const double steps = (mus(1) - mus(0)) * (log_sigmas(1) - log_sigmas(0));
    log_evidence = std::log(mass * steps * 1.5 / (0.5 * std::sqrt(2.0 * std::numbers::pi)));
  }

  /// Density of the three tests, and the mean of the first specimen's x.
  static std::pair<double, double> of_tests(double mu, double sigma) {
    const Eigen::Vector3d z(0.5, 1.4, 2.3);
    const Eigen::ArrayXd w = Eigen::ArrayXd::LinSpaced(121, -6.0, 6.0);
    const Eigen::ArrayXd x = mu + sigma * w;
    double product = 1.0;
    double first_moment = 0.0;
    for (int s = 0; s < 3; ++s) {
      const Eigen::ArrayXd density = (-0.5 * ((z(s) - x.exp()) / 0.4).square() - 0.5 * w.square()).exp() *
                                     (w(1) - w(0)) / (2.0 * std::numbers::pi * 0.4);
      product *= density.sum();
      if (s == 0) first_moment = density.sum() > 0.0 ? (density * x).sum() / density.sum() : 0.0;
    }
    return {product, first_moment};
  }
};

TEST(Hierarchical, ReproducesACurvedModelsPosteriorByQuadrature) {
  const Exponential curved;
  const ExponentialReference reference;
  const UpdatingResult result = HierarchicalUpdater({}).update(curved.problem(), {.seed = 3});
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  const Evidence& evidence = result.posterior->evidence;
  // The grid leaves out scatters below 0.001 and above 5, which have some thousandths of the mass.
  EXPECT_NEAR(evidence.log_evidence, reference.log_evidence, k_stated_errors * evidence.standard_error + 0.005);
  EXPECT_LT(evidence.standard_error, 0.05);
  expect_mean(result, "mu:x", reference.mean);
  expect_mean(result, "sigma:x", reference.scatter);
  expect_mean(result, "x:1", reference.first);
}

TEST(Hierarchical, LeavesMissingEntriesOutAndRefusesSpecimensWithoutAny) {
  const test::LinearProblem linear;
  UpdatingProblem problem = linear.problem(linear.noise);
  problem.tests.values(0, 1) = k_nan;
  problem.tests.values(5, 2) = k_nan;
  const UpdatingResult result = HierarchicalUpdater({}).update(problem, {});
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  problem.tests.values.row(3).setConstant(k_nan);
  EXPECT_THROW(HierarchicalUpdater({}).update(problem, {}), InvalidInput);
}

TEST(Hierarchical, RefusesOneSpecimenAndNoiseThatIsNotKnown) {
  const test::LinearProblem linear;
  UpdatingProblem problem = linear.problem(linear.noise);
  problem.tests.values = linear.tests.topRows(1);
  try {
    HierarchicalUpdater({}).update(problem, {});
    FAIL() << "one specimen was accepted";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("bayes"), std::string::npos) << error.what();
  }
  HierarchicalOptions given;
  given.noise = BayesOptions::Noise::given;
  try {
    HierarchicalUpdater(given).update(linear.problem(Eigen::Vector4d::Zero()), {});
    FAIL() << "noise that is not known was accepted";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("hierarchical.noise"), std::string::npos) << error.what();
  }
}

TEST(Hierarchical, RefusesOptionsOutOfRange) {
  const MethodEntry& entry = find_method("hierarchical");
  EXPECT_THROW(entry.make({{"scatter_scale", OptionValue(0.0)}}, "test"), InvalidInput);
  EXPECT_THROW(entry.make({{"scatter_degrees_of_freedom", OptionValue(0.0)}}, "test"), InvalidInput);
  EXPECT_THROW(entry.make({{"correlation_shape", OptionValue(0.1)}}, "test"), InvalidInput);
  EXPECT_THROW(entry.make({{"covariance_prior", OptionValue(std::string("wishart"))}}, "test"), InvalidInput);
  EXPECT_THROW(entry.make({{"islands", OptionValue(std::int64_t{4})}}, "test"), InvalidInput);
  HierarchicalOptions many;
  many.islands = 256;
  many.particles = 100000;
  const test::LinearProblem linear;
  EXPECT_THROW(HierarchicalUpdater(many).update(linear.problem(linear.noise), {}), InvalidInput);
}

/// Two specimens say little of a scatter: the result says so, and its interval reaches over a factor of ten.
TEST(Hierarchical, GivesNoFalseComfortFromTwoSpecimens) {
  const test::LinearProblem linear;
  UpdatingProblem problem = linear.problem(linear.noise);
  problem.tests.values = linear.tests.topRows(2);
  const UpdatingResult result = HierarchicalUpdater({}).update(problem, {});
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  ASSERT_TRUE(result.intervals);
  EXPECT_GT(result.intervals->std(0, 1), 6.0 * result.intervals->std(0, 0));
  const bool is_warned = std::any_of(result.warnings.begin(), result.warnings.end(), [](const std::string& text) {
    return text.find("rests on its prior") != std::string::npos;
  });
  EXPECT_TRUE(is_warned);
  const UpdatingResult all = HierarchicalUpdater({}).update(linear.problem(linear.noise), {});
  EXPECT_TRUE(all.warnings.empty()) << all.warnings.front();
}

TEST(Hierarchical, KeepsParametersOfDifferentGroupsUncorrelated) {
  const test::LinearProblem linear;
  UpdatingProblem problem = linear.problem(linear.noise);
  problem.covariance_groups = {0, 1};
  const UpdatingResult result = HierarchicalUpdater({}).update(problem, {});
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  EXPECT_EQ(result.covariance(0, 1), 0.0);
  EXPECT_EQ(column_of(*result.posterior, "rho:a:b"), result.posterior->values.cols());
  // Of twelve specimens the posterior's medians are near the deviations 0.3 and 0.32 that they were drawn with.
  EXPECT_NEAR(std::sqrt(result.covariance(0, 0)), 0.3, 0.2);
  EXPECT_NEAR(std::sqrt(result.covariance(1, 1)), 0.32, 0.2);
}

TEST(Hierarchical, PredictsANewSpecimenWiderThanThePopulationItShows) {
  const test::LinearProblem linear;
  UpdatingProblem problem = linear.problem(linear.noise);
  problem.tests.values = linear.tests.topRows(3);
  const UpdatingResult result = HierarchicalUpdater({}).update(problem, {});
  const auto spread = [&](SpecimenDrawing::Kind kind) {
    const Eigen::ArrayXd x = result.estimate->draw_specimens({.kind = kind, .draws = 4000, .seed = 1}).col(0).array();
    return std::sqrt((x - x.mean()).square().mean());
  };
  EXPECT_NEAR(spread(SpecimenDrawing::Kind::population), std::sqrt(result.covariance(0, 0)),
              0.05 * std::sqrt(result.covariance(0, 0)));
  EXPECT_GT(spread(SpecimenDrawing::Kind::outputs), 1.2 * spread(SpecimenDrawing::Kind::population));
}

/// Scores of points of a good lattice, the same for every number: moments of the prior.
Eigen::MatrixXd scores(Eigen::Index count, Eigen::Index dimension) {
  Eigen::MatrixXd points(count, dimension);
  for (Eigen::Index i = 0; i < count; ++i) {
    RandomStream stream({.seed = 9}, static_cast<std::uint32_t>(i));
    for (double& value : points.row(i)) value = standard_normal_quantile(stream.uniform());
  }
  return points;
}

/// Under LKJ every correlation of q variables is beta on (-1, 1) with shape eta + (q - 2) / 2 [Lewandowski2009]: its
/// variance is 1 / (2 shape + 1).
TEST(Hierarchical, HasThePriorOfCorrelationsThatItStates) {
  const test::ThreeMasses structure;
  UpdatingProblem problem = structure.problem(test::frequencies_of(structure, test::oracle_parameters()));
  problem.tests.repeatability_std.setConstant(1e-3);
  HierarchicalOptions options;
  options.correlation_shape = 1.5;
  const NoiseLevels noise(problem, options);
  const PopulationPrior prior(problem, options, noise);
  constexpr Eigen::Index k_draws = 20000;
  const std::vector<PopulationAt> populations = prior.populations(scores(k_draws, prior.dimension()));
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  Eigen::Array3d squares = Eigen::Array3d::Zero();
  double above = 0.0;
  for (const PopulationAt& population : populations) {
    const Eigen::VectorXd values = prior.values(population);
    sum += values.segment(6, 3).array();
    squares += values.segment(6, 3).array().square();
    above += values(3) > 0.3 * 2.7764451 ? 1.0 : 0.0;  // Student's quantile of 4 degrees of freedom at 97.5 %
  }
  const double variance = 1.0 / (2.0 * 2.0 + 1.0);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(sum(k) / k_draws, 0.0, k_stated_errors * std::sqrt(variance / k_draws));
    EXPECT_NEAR(squares(k) / k_draws, variance, 0.02 * variance * k_stated_errors);
  }
  EXPECT_NEAR(above / k_draws, 0.05, k_stated_errors * std::sqrt(0.05 * 0.95 / k_draws));
  EXPECT_EQ(prior.names()[6], "rho:k1:k2");
  EXPECT_NEAR(prior.standard_deviations(0.95)(0), 0.3 * 2.7764451, 1e-6);
}

/// An inverse Wishart of q variables with nu + q - 1 degrees of freedom has correlations with the density (1 -
/// rho^2)^(nu / 2 - 1): uniform for nu = 2.
TEST(Hierarchical, HasTheInverseWishartPriorThatItStates) {
  const test::ThreeMasses structure;
  UpdatingProblem problem = structure.problem(test::frequencies_of(structure, test::oracle_parameters()));
  problem.tests.repeatability_std.setConstant(1e-3);
  HierarchicalOptions options;
  options.covariance_prior = HierarchicalOptions::CovariancePrior::inverse_wishart;
  options.scatter_degrees_of_freedom = 2.0;
  const NoiseLevels noise(problem, options);
  const PopulationPrior prior(problem, options, noise);
  constexpr Eigen::Index k_draws = 20000;
  const Eigen::VectorXd high = prior.standard_deviations(0.95);
  Eigen::Array3d above = Eigen::Array3d::Zero();
  Eigen::Array3d squares = Eigen::Array3d::Zero();
  for (const PopulationAt& population : prior.populations(scores(k_draws, prior.dimension()))) {
    const Eigen::VectorXd values = prior.values(population);
    above += (values.segment(3, 3).array() > high.array()).cast<double>();
    squares += values.segment(6, 3).array().square();
  }
  // Chi-squared of 2 degrees of freedom is exponential: sigma = a / sqrt(-ln(1 - p)) is exceeded with probability p.
  EXPECT_NEAR(high(0), 0.3 / std::sqrt(-std::log(0.95)), 1e-6);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(above(k) / k_draws, 0.05, k_stated_errors * std::sqrt(0.05 * 0.95 / k_draws));
    EXPECT_NEAR(squares(k) / k_draws, 1.0 / 3.0, k_stated_errors * 0.3 / std::sqrt(1.0 * k_draws));
  }
}

}  // namespace
}  // namespace mottle::updating
