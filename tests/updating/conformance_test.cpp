// What every updating method must do, over problems that carry their own answer.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <atomic>

#include "mottle/core/error.hpp"
#include "mottle/updating/updater.hpp"
#include "support/linear_model.hpp"
#include "support/three_masses.hpp"

namespace mottle {
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
  std::unique_ptr<Updater> method() const { return find_method(GetParam()).make({}, "test"); }
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

TEST_P(EveryMethod, RepeatsUnderItsSeedAtAnyThreadCount) {
  const test::ThreeMasses structure;
  const UpdatingProblem problem = structure.problem(test::frequencies_of(structure, test::oracle_parameters()));
  const UpdatingResult once = method()->update(problem, {.seed = 5, .threads = 1});
  const UpdatingResult again = method()->update(problem, {.seed = 5, .threads = 3});
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

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const MethodEntry& method : updating_methods()) names.push_back(method.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryMethod, testing::ValuesIn(method_names()),
                         [](const auto& instance) { return instance.param; });

TEST(Registry, RefusesAnUnknownMethodWithTheNearestKnownOne) {
  try {
    find_method("mare");
    FAIL() << "an unknown method was found";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean 'mares'"), std::string::npos);
  }
}

}  // namespace
}  // namespace mottle
