#include "study/tests/rank_numbering.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "mottle/core/random.hpp"
#include "mottle/model/structures/affine_matrices.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/updating/methods/maximum_likelihood.hpp"

namespace mottle::study {
namespace {

/// Two masses on springs of their own, tied by next to nothing: their modes cross where k1 = k2.
struct CrossingMasses {
  explicit CrossingMasses(ModeTracking tracking) {
    const MassSpringSystem system{.masses = {{"m1", 1.0}, {"m2", 1.0}},
                                  .springs = {{"k1", k_ground, 0, 1.0}, {"k2", k_ground, 1, 1.2}, {"k3", 0, 1, 1e-4}},
                                  .dampers = {}};
    const std::vector<ParameterTargets> targets{{"k1", {"spring:k1"}}, {"k2", {"spring:k2"}}};
    const Distribution prior1({.kind = DistributionKind::normal, .mean = 1.0, .std = 0.2});
    const Distribution prior2({.kind = DistributionKind::normal, .mean = 1.2, .std = 0.2});
    space = std::make_unique<ParameterSpace>(
        std::vector<Parameter>{{.name = "k1", .unit = "N/m"}, {.name = "k2", .unit = "N/m"}},
        JointDistribution({prior1, prior2}));
    selection = {.frequencies = {1, 2}, .tracking = tracking};
    model = std::make_unique<StructureModel>(separate(system, targets), selection, Eigen::Vector2d(1.0, 1.2));
  }

  /// k1 ~ N(1, 0.2), k2 ~ N(1.2, 0.2).
  static Eigen::MatrixXd specimens(Eigen::Index count) {
    RandomStream stream({.seed = 15}, 0);
    Eigen::MatrixXd x(count, 2);
    for (double& value : x.col(0)) value = 1.0 + 0.2 * standard_normal_quantile(stream.uniform());
    for (double& value : x.col(1)) value = 1.2 + 0.2 * standard_normal_quantile(stream.uniform());
    return x;
  }

  /// Their frequencies as found in the laboratory: by rank.
  Eigen::MatrixXd tests(Eigen::Index count) const {
    Eigen::MatrixXd frequencies = model->evaluate(specimens(count), {}).outputs;
    for (auto row : frequencies.rowwise()) {
      if (row(0) > row(1)) std::swap(row(0), row(1));
    }
    return frequencies;
  }

  UpdatingResult update(const Eigen::MatrixXd& tests) const {
    const UpdatingProblem problem{.model = *model,
                                  .derivatives = model.get(),
                                  .space = *space,
                                  .tests = {tests, Eigen::Vector2d::Zero()},
                                  .cloud = {.samples = 500}};
    return MaximumLikelihoodUpdater({}).update(problem, {});
  }

  std::unique_ptr<ParameterSpace> space;
  OutputSelection selection;
  std::unique_ptr<StructureModel> model;
};

TEST(RankNumbering, OfTestsIsNamedWhereModesCrossInTheCloud) {
  const CrossingMasses by_shape(ModeTracking::mac);
  const Eigen::MatrixXd tests = by_shape.tests(40);
  const UpdatingResult result = by_shape.update(tests);
  // The bias that goes with it: two numbers 0.2 apart with deviations of 0.2 are 0.28 apart once they are ordered.
  const Eigen::MatrixXd own = CrossingMasses::specimens(40);
  EXPECT_GT(result.mean(1) - result.mean(0), own.col(1).mean() - own.col(0).mean() + 0.04);
  const std::optional<std::string> warning = rank_warning(by_shape.selection, tests, result.history);
  ASSERT_TRUE(warning.has_value());
  EXPECT_NE(warning->find("modes 1 and 2 crossed"), std::string::npos) << *warning;
  EXPECT_NE(warning->find("test.pairing = \"mac\""), std::string::npos) << *warning;
}

TEST(RankNumbering, IsNamedWithoutACloud) {
  const CrossingMasses by_shape(ModeTracking::mac);
  const std::optional<std::string> note = rank_note(by_shape.selection, by_shape.tests(40));
  ASSERT_TRUE(note.has_value());
  EXPECT_NE(note->find("test.pairing = \"named\""), std::string::npos) << *note;
}

TEST(RankNumbering, IsSoundWhereTheModelCountsByRankToo) {
  const CrossingMasses by_rank(ModeTracking::order);
  const Eigen::MatrixXd tests = by_rank.tests(40);
  const UpdatingResult result = by_rank.update(tests);
  EXPECT_FALSE(rank_warning(by_rank.selection, tests, result.history).has_value());
  EXPECT_FALSE(rank_note(by_rank.selection, tests).has_value());
}

/// Outputs by rank bend where modes cross; where they stay apart nothing is said.
TEST(RankNumbering, IsNamedWhereOutputsByRankBend) {
  const CrossingMasses by_rank(ModeTracking::order);
  const UpdatingResult result = by_rank.update(by_rank.tests(40));
  const std::optional<std::string> warning = bend_warning(by_rank.selection, result.history.back());
  ASSERT_TRUE(warning.has_value());
  EXPECT_NE(warning->find("Modes 1 and 2 cross"), std::string::npos) << *warning;
  IterationRecord apart = result.history.back();
  apart.cloud.outputs.col(1).array() += 0.2;
  EXPECT_FALSE(bend_warning(by_rank.selection, apart).has_value());
  const CrossingMasses by_shape(ModeTracking::mac);
  EXPECT_FALSE(bend_warning(by_shape.selection, result.history.back()).has_value());
}

TEST(RankNumbering, IsNotThatOfTestsWhoseFrequenciesDoNotAscend) {
  const CrossingMasses by_shape(ModeTracking::mac);
  Eigen::MatrixXd tests = by_shape.tests(40);
  const UpdatingResult result = by_shape.update(tests);
  std::swap(tests(5, 0), tests(5, 1));
  EXPECT_FALSE(rank_warning(by_shape.selection, tests, result.history).has_value());
  EXPECT_FALSE(rank_note(by_shape.selection, tests).has_value());
}

}  // namespace
}  // namespace mottle::study
