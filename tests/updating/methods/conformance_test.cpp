// What every updating method must do, over problems that carry their own answer.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <atomic>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "support/linear_model.hpp"
#include "support/methods.hpp"
#include "support/three_masses.hpp"

namespace mottle::updating {
namespace {

/// Tests of a linear model whose parameters are known: four outputs, two parameters, six specimens with mean (3, 5).
struct Reference {
  Reference() : model(Eigen::Vector4d(1.0, 2.0, 0.0, -1.0), slope()) {
    const Distribution first({.kind = DistributionKind::normal, .mean = 2.5, .std = 1.0});
    const Distribution second({.kind = DistributionKind::normal, .mean = 6.0, .std = 1.0});
    space = std::make_unique<ParameterSpace>(std::vector<Parameter>{{"a", "-"}, {"b", "-"}},
                                             JointDistribution({first, second}));
    Eigen::MatrixXd x(6, 2);
    x << 2.8, 5.1, 3.2, 4.9, 3.1, 5.3, 2.9, 4.7, 3.3, 5.2, 2.7, 4.8;
    tests = model.evaluate(x, {}).outputs;
    // A little independent scatter keeps the covariance of four outputs regular; it sums to zero over specimens.
    for (int i = 0; i < 6; ++i) {
      tests(i, 2) += (i % 2 == 0 ? 0.02 : -0.02);
      tests(i, 3) += (i < 3 ? 0.02 : -0.02);
    }
    model.runs = 0;
  }
  static Eigen::MatrixXd slope() {
    Eigen::MatrixXd g(4, 2);
    g << 1.0, 0.5, -1.0, 2.0, 0.3, 0.7, 1.5, -0.2;
    return g;
  }
  UpdatingProblem problem() const {
    return {.model = model,
            .space = *space,
            .tests = {tests, Eigen::VectorXd::Constant(4, 1e-3)},
            .cloud = {.samples = 400},
            .iterations = 100};
  }
  test::LinearModel model;
  std::unique_ptr<ParameterSpace> space;
  Eigen::MatrixXd tests;
};

/// Four standard errors of the mean of 400 samples whose deviation is that of the specimens, 0.24: what a method that
/// matches the mean of its cloud may be off.
constexpr double k_monte_carlo = 4.0 * 0.24 / 20.0;

class EveryMethod : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Updater> method() const { return test::tested_method(GetParam()); }
};

TEST_P(EveryMethod, RecoversTheMeanOfALinearModel) {
  const Reference reference;
  const UpdatingResult result = method()->update(reference.problem(), {});
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  EXPECT_LT((result.mean - Eigen::Vector2d(3.0, 5.0)).cwiseAbs().maxCoeff(), k_monte_carlo);
}

TEST_P(EveryMethod, GivesASymmetricPositiveCovariance) {
  const Reference reference;
  const UpdatingResult result = method()->update(reference.problem(), {});
  EXPECT_EQ(result.covariance, Eigen::MatrixXd(result.covariance.transpose()));
  EXPECT_GT(result.covariance.determinant(), 0.0);
}

TEST_P(EveryMethod, GivesAnEstimateOfWhichItsMomentsAre) {
  const Reference reference;
  const UpdatingResult result = method()->update(reference.problem(), {});
  ASSERT_TRUE(result.estimate);
  EXPECT_EQ(result.mean, result.estimate->mean());
  EXPECT_EQ(result.covariance, result.estimate->covariance());
  EXPECT_EQ(result.is_population, result.estimate->kind() == EstimateKind::population);
  const StreamKey key{.seed = 3, .purpose = StreamPurpose::truth};
  const Eigen::MatrixXd drawn =
      result.estimate->from_uniform(uniform_design(SamplingDesign::latin_hypercube, 20000, 2, key));
  const Eigen::VectorXd standard_deviation = result.covariance.diagonal().cwiseSqrt();
  EXPECT_LT((drawn.colwise().mean().transpose() - result.mean).cwiseQuotient(standard_deviation).norm(), 0.02);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const double median = result.estimate->quantile(i, 0.5);
    const auto below = (drawn.col(i).array() < median).count();
    EXPECT_NEAR(static_cast<double>(below) / 20000.0, 0.5, 0.02);
  }
}

TEST_P(EveryMethod, RepeatsUnderItsSeedAtAnyThreadCount) {
  const test::ThreeMasses structure;
  // What is compared are bits, and the sampler of populations is slow: six specimens, particles few and moved little.
  const OptionValues brief{{"particles", std::int64_t{100}}, {"decorrelation", 0.9}};
  const Eigen::MatrixXd specimens = test::oracle_parameters().topRows(6);
  const UpdatingProblem problem = structure.problem(test::frequencies_of(structure, specimens));
  const auto update_with = [&](int threads) {
    const MethodEntry& entry = find_method(GetParam());
    return entry.make(entry.name == "hierarchical" ? brief : OptionValues{}, "test")
        ->update(problem, {.seed = 5, .threads = threads});
  };
  const UpdatingResult once = update_with(1);
  const UpdatingResult again = update_with(3);
  EXPECT_EQ(once.mean, again.mean);
  EXPECT_EQ(once.covariance, again.covariance);
  EXPECT_EQ(once.history.back().cloud.outputs, again.history.back().cloud.outputs);
}

TEST_P(EveryMethod, StopsWhenAsked) {
  const Reference reference;
  const std::atomic<bool> stop{true};
  const UpdatingResult result = method()->update(reference.problem(), {.stop = &stop});
  EXPECT_EQ(result.status, UpdatingStatus::stopped);
}

TEST_P(EveryMethod, CountsItsModelEvaluations) {
  const Reference reference;
  const UpdatingResult result = method()->update(reference.problem(), {});
  EXPECT_EQ(result.model_evaluations, reference.model.runs);
}

TEST_P(EveryMethod, SurvivesFailedEvaluations) {
  Reference reference;
  // About one sample in ten fails, by a rule that has nothing to do with the outputs.
  reference.model.fails = [](const Eigen::RowVectorXd& x) {
    return std::fmod(std::abs(x(0)) * 314159.26535, 1.0) < 0.1;
  };
  const UpdatingResult result = method()->update(reference.problem(), {});
  std::size_t failed = 0;
  for (const IterationRecord& state : result.history) failed += state.failures.size();
  EXPECT_GT(failed, 0U);
  EXPECT_LT((result.mean - Eigen::Vector2d(3.0, 5.0)).cwiseAbs().maxCoeff(), k_monte_carlo);
}

TEST_P(EveryMethod, StopsWhenTooManyEvaluationsFail) {
  Reference reference;
  reference.model.fails = [](const Eigen::RowVectorXd& x) { return x(0) > 2.0; };
  EXPECT_THROW(method()->update(reference.problem(), {}), SystemFailure);
}

TEST_P(EveryMethod, KeepsItsMeanWithinTheBounds) {
  const Reference reference;
  const Distribution first({.kind = DistributionKind::normal, .mean = 2.5, .std = 1.0});
  const Distribution second({.kind = DistributionKind::normal, .mean = 6.0, .std = 1.0});
  const ParameterSpace bounded({{"a", "-", 2.0, 2.8, {}}, {"b", "-", 5.5, 7.0, {}}},
                               JointDistribution({first, second}));
  const UpdatingProblem free = reference.problem();
  const UpdatingResult result =
      method()->update({.model = free.model, .space = bounded, .tests = free.tests, .cloud = free.cloud}, {});
  EXPECT_TRUE(result.mean(0) >= 2.0 && result.mean(0) <= 2.8 && result.mean(1) >= 5.5 && result.mean(1) <= 7.0);
  if (result.posterior) return;                              // whose mean is never on a bound
  if (result.estimate->kind() == EstimateKind::box) return;  // whose middle is on none where it has width
  EXPECT_EQ(bounded.active_bounds(result.mean), Eigen::Vector2i(1, -1));
}

TEST_P(EveryMethod, SaysWhatItsNumbersMean) {
  const Reference reference;
  EXPECT_FALSE(method()->update(reference.problem(), {}).notes.empty());
}

TEST_P(EveryMethod, RefusesAnUnknownOptionWithTheNearestKnownOne) {
  const MethodEntry& entry = find_method(GetParam());
  const std::string known = entry.options.front().name;
  try {
    entry.make({{known + "x", OptionValue(1.0)}}, "study.toml: [update]");
    FAIL() << "an unknown option was accepted";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean '" + known), std::string::npos) << error.what();
  }
}

/// Methods that estimate a population.
class EveryPopulationMethod : public EveryMethod {
 protected:
  /// What a standard deviation may be off. That of `abc` is another functional of the six specimens than the sample's.
  /// They lie at even distances, and the normal distribution nearest to such by the energy distance is 15 % wider; with
  /// 0.81 of the sample's efficiency it differs by a further 0.49 of a standard error of 0.075: 0.036 + 3 * 0.037 more.
  double scatter_tolerance(double usual) const { return GetParam() == "abc" ? usual + 0.15 : usual; }
};

TEST_P(EveryPopulationMethod, RecoversTheScatterOfALinearModel) {
  const Reference reference;
  const UpdatingResult result = method()->update(reference.problem(), {});
  // Deviations of the six specimens, 0.2366 and 0.2366; the scatter of the last two outputs adds less than 0.02.
  EXPECT_LT((result.covariance.diagonal().cwiseSqrt() - Eigen::Vector2d(0.23664, 0.23664)).cwiseAbs().maxCoeff(),
            scatter_tolerance(0.02));
  EXPECT_TRUE(result.is_population);
  EXPECT_EQ(result.noise_covariance.rows(), 4);
}

TEST_P(EveryPopulationMethod, GivesThePopulationAndWhatTheSpecimensShowOfIt) {
  const Reference reference;
  UpdatingProblem problem = reference.problem();
  problem.tests.repeatability_std.setConstant(0.05);
  const UpdatingResult result = method()->update(problem, {});
  ASSERT_TRUE(result.estimate);
  const PopulationOnScales* population = result.estimate->population();
  ASSERT_NE(population, nullptr);
  const PopulationEvidence& evidence = population->evidence;
  EXPECT_LT((population->mean - result.mean).norm(), 1e-12);
  EXPECT_LT((population->covariance - result.covariance).norm(), 1e-12);
  EXPECT_EQ(evidence.degrees_of_freedom, Eigen::MatrixXd::Constant(2, 2, 5.0));
  EXPECT_LT((6.0 * evidence.mean_covariance - evidence.total).norm(), 0.1 * evidence.total.norm());
  // What the noise adds to the specimens' own estimates: (G' R^-1 G)^-1. Inversion leaves it in its deviations.
  const Eigen::MatrixXd share = 0.0025 * (Reference::slope().transpose() * Reference::slope()).inverse();
  if (GetParam() == "inversion") {
    EXPECT_TRUE(evidence.noise.isZero(0.0));
  } else {
    EXPECT_LT((evidence.noise - share).norm(), 1e-6 * share.norm());
  }
}

TEST_P(EveryPopulationMethod, UsesSpecimensWithMissingEntries) {
  Reference reference;
  reference.tests(0, 1) = std::numeric_limits<double>::quiet_NaN();
  reference.tests(3, 2) = std::numeric_limits<double>::quiet_NaN();
  const UpdatingResult result = method()->update(reference.problem(), {});
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  // What is missing shifts the mean of an output by up to its deviation over five: 0.1 in the parameters.
  EXPECT_LT((result.mean - Eigen::Vector2d(3.0, 5.0)).cwiseAbs().maxCoeff(), 0.1);
  EXPECT_LT((result.covariance.diagonal().cwiseSqrt() - Eigen::Vector2d(0.23664, 0.23664)).cwiseAbs().maxCoeff(),
            scatter_tolerance(0.1));
}

TEST_P(EveryPopulationMethod, KeepsParametersOfDifferentGroupsUncorrelated) {
  const Reference reference;
  UpdatingProblem problem = reference.problem();
  problem.covariance_groups = {0, 1};
  const UpdatingResult result = method()->update(problem, {});
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  EXPECT_EQ(result.covariance(0, 1), 0.0);
  EXPECT_LT((result.covariance.diagonal().cwiseSqrt() - Eigen::Vector2d(0.23664, 0.23664)).cwiseAbs().maxCoeff(),
            scatter_tolerance(0.03));
}

TEST_P(EveryPopulationMethod, TakesAParameterAsNormalOnItsLogarithm) {
  const Reference reference;
  std::vector<Parameter> parameters = reference.space->parameters();
  for (Parameter& parameter : parameters) parameter.transform.kind = ParameterTransform::Kind::log;
  const ParameterSpace space(parameters, reference.space->prior());
  const UpdatingProblem plain = reference.problem();
  const UpdatingProblem problem{
      .model = plain.model, .space = space, .tests = plain.tests, .cloud = plain.cloud, .iterations = plain.iterations};
  const UpdatingResult result = method()->update(problem, {});
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  // Mean and deviation are those of x itself: with 8 % of scatter, second-order terms stay below 0.02.
  EXPECT_LT((result.mean - Eigen::Vector2d(3.0, 5.0)).cwiseAbs().maxCoeff(), 0.02);
  EXPECT_LT((result.covariance.diagonal().cwiseSqrt() - Eigen::Vector2d(0.23664, 0.23664)).cwiseAbs().maxCoeff(),
            scatter_tolerance(0.03));
  EXPECT_GT(result.history.back().cloud.samples.minCoeff(), 0.0);
}

TEST_P(EveryPopulationMethod, ChangesNoMoreThanItMustWhereOutputsAreFewerThanParameters) {
  const Reference reference;
  const test::LinearModel narrow(Eigen::VectorXd::Constant(1, 1.0), Eigen::RowVector2d(1.0, 0.5));
  const UpdatingProblem problem{.model = narrow,
                                .space = *reference.space,
                                .tests = {reference.tests.leftCols(1), Eigen::VectorXd::Zero(1)},
                                .cloud = {.samples = 400},
                                .iterations = 100};
  const UpdatingResult result = method()->update(problem, {});
  EXPECT_EQ(result.status, UpdatingStatus::converged) << result.message;
  // Equal prior deviations: the mean moves along the slope of the one output.
  const double missing = 3.0 + 0.5 * 5.0 - (2.5 + 0.5 * 6.0);
  const Eigen::Vector2d nearest = Eigen::Vector2d(2.5, 6.0) + missing / 1.25 * Eigen::Vector2d(1.0, 0.5);
  EXPECT_LT((result.mean - nearest).cwiseAbs().maxCoeff(), 0.02);
  // The scatter of the output is the tests'.
  const Eigen::VectorXd z = reference.tests.col(0);
  const double variance = (z.array() - z.mean()).square().sum() / 5.0;
  const Eigen::Vector2d slope(1.0, 0.5);
  EXPECT_NEAR(slope.dot(result.covariance * slope), variance, (GetParam() == "abc" ? 0.5 : 0.05) * variance);
  EXPECT_GE(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(result.covariance).eigenvalues()(0), -1e-12);
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryMethod, testing::ValuesIn(test::method_names(false)), test::instance_name);
INSTANTIATE_TEST_SUITE_P(Registry, EveryPopulationMethod, testing::ValuesIn(test::population_estimators()),
                         test::instance_name);

TEST(Registry, RefusesAnUnknownMethodWithTheNearestKnownOne) {
  try {
    find_method("mare");
    FAIL() << "an unknown method was found";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean 'mares'"), std::string::npos);
  }
}

}  // namespace
}  // namespace mottle::updating
