// No method fails on a sound problem: few specimens, singular populations, gaps, scales.
#include <gtest/gtest.h>

#include "mottle/core/error.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "support/instrumented.hpp"
#include "support/methods.hpp"
#include "support/random_problem.hpp"
#include "support/soundness.hpp"
#include "support/three_masses.hpp"

namespace mottle::updating {
namespace {

class SoundProblems : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Updater> method() const { return test::tested_method(GetParam()); }
};

/// A few of the thousand that validation/sound-problems goes through.
TEST_P(SoundProblems, AreSolvedHoweverSingular) {
  const bool is_slow = test::k_is_instrumented || GetParam() == "abc";
  for (std::uint32_t number = 0; number < (is_slow ? 8U : 40U); ++number) {
    const test::RandomProblem drawn(number);
    const UpdatingProblem problem = drawn.problem();
    try {
      const UpdatingResult result = method()->update(problem, {});
      EXPECT_EQ(test::fault_of(problem, result, {}), "") << number << ": " << drawn.description();
    } catch (const std::exception& error) {
      ADD_FAILURE() << number << ": " << drawn.description() << ": " << error.what();
    }
  }
}

/// Three masses, few specimens, all parameters the same in each: the covariance has one direction. The estimate of
/// methods that invert the model is that of the specimens themselves; the others are right to first order.
TEST_P(SoundProblems, GiveOneDirectionForPerfectlyCorrelatedParameters) {
  if (GetParam() == "abc") GTEST_SKIP() << "finds no covariance of the sample, but one whose cloud is near";
  const test::ThreeMasses structure;
  for (Eigen::Index specimens = 2; specimens <= 5; ++specimens) {
    for (std::uint32_t number = 0; number < 10; ++number) {
      RandomStream stream({.seed = 3, .purpose = StreamPurpose::truth},
                          10 * static_cast<std::uint32_t>(specimens) + number);
      Eigen::MatrixXd x(specimens, 3);
      for (Eigen::Index s = 0; s < specimens; ++s)
        x.row(s).setConstant(1.0 + 0.1 * standard_normal_quantile(stream.uniform()));
      UpdatingProblem problem = structure.problem(test::frequencies_of(structure, x));
      problem.cloud.samples = 50;
      const UpdatingResult result = method()->update(problem, {});
      EXPECT_EQ(test::fault_of(problem, result, {}), "") << specimens << " specimens, " << number;
      const Eigen::MatrixXd expected = sample_covariance(x);
      EXPECT_LT((result.covariance - expected).cwiseAbs().maxCoeff(), 0.2 * expected(0, 0));
    }
  }
}

TEST_P(SoundProblems, HaveNoScatterForIdenticalSpecimens) {
  const test::ThreeMasses structure;
  const Eigen::MatrixXd x = Eigen::MatrixXd::Ones(3, 3);
  UpdatingProblem problem = structure.problem(test::frequencies_of(structure, x));
  problem.cloud.samples = 50;
  const UpdatingResult result = method()->update(problem, {});
  EXPECT_EQ(test::fault_of(problem, result, {}), "");
  EXPECT_LT((result.mean - Eigen::Vector3d::Ones()).cwiseAbs().maxCoeff(), 1e-2);
  // `abc` compares outputs that do not scatter to a thousandth of their values, which is 0.002 of a stiffness.
  EXPECT_LT(test::standard_deviations(result).maxCoeff(), GetParam() == "abc" ? 5e-3 : 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Registry, SoundProblems, testing::ValuesIn(test::population_estimators()),
                         test::instance_name);

}  // namespace
}  // namespace mottle::updating
