#include "updating/fits/mean_solutions.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "mottle/model/function_model.hpp"
#include "updating/fits/exchanged_parameters.hpp"
#include "updating/population/solved_population.hpp"

namespace mottle::updating {
namespace {

using Outputs = Eigen::VectorXd (*)(const Eigen::VectorXd&);

/// A function of parameters with normal priors about 1, and specimens about the outputs at `truth`.
struct Case {
  Case(Eigen::Index parameters, Outputs outputs, const Eigen::VectorXd& truth, double scatter = 0.01)
      : model(parameters, names(outputs(truth).size()), outputs) {
    std::vector<Parameter> list;
    std::vector<Distribution> priors;
    for (Eigen::Index i = 0; i < parameters; ++i) {
      list.push_back({fmt::format("x{}", i), "-", -100.0, 100.0, {.lower = -1e9, .excludes_lower = false}});
      priors.emplace_back(DistributionSpec{.kind = DistributionKind::normal, .mean = 1.0, .std = 0.3});
    }
    space = std::make_unique<ParameterSpace>(list, JointDistribution(priors));
    const Eigen::VectorXd mean = outputs(truth);
    tests.values = mean.transpose().replicate(4, 1);
    for (Eigen::Index s = 0; s < 4; ++s) tests.values.row(s) *= 1.0 + scatter * (s < 2 ? -1.0 : 1.0);
    tests.repeatability_std = 1e-4 * mean.cwiseAbs();
  }

  static std::vector<Quantity> names(Eigen::Index count) {
    std::vector<Quantity> list;
    for (Eigen::Index k = 0; k < count; ++k) list.push_back(named_quantity(fmt::format("y{}", k + 1), "-"));
    return list;
  }

  UpdatingProblem problem(int starts) const {
    return {.model = model, .space = *space, .tests = tests, .cloud = {.samples = 200}, .starts = starts};
  }

  MeanSolutions find(int starts = k_usual_starts) const {
    const UpdatingProblem problem = this->problem(starts);
    const Cloud cloud = evaluate_cloud(model, *space, space->prior(), problem.cloud,
                                       {.seed = 1, .purpose = StreamPurpose::parameter_cloud}, {});
    std::int64_t evaluations = 0;
    return find_mean_solutions(problem, cloud, {}, evaluations);
  }

  FunctionModel model;
  std::unique_ptr<ParameterSpace> space;
  TestData tests;
};

bool has(const MeanSolutions& found, const Eigen::VectorXd& point) {
  return std::ranges::any_of(found.solutions,
                             [&](const MeanSolution& one) { return (one.point - point).cwiseAbs().maxCoeff() < 1e-3; });
}

/// Sums of powers: symmetric in all parameters.
Eigen::VectorXd power_sums(const Eigen::VectorXd& x) {
  Eigen::VectorXd sums(x.size());
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    sums(k) = x.array().pow(static_cast<double>(k + 1)).sum();
  }
  return sums;
}

TEST(MeanSolutions, OfASymmetricFunctionAreAllPermutations) {
  // At the equal means of the priors the derivatives of all outputs are parallel: a descent from there stays on x1 = x2
  // = x3.
  const MeanSolutions found = Case(3, power_sums, Eigen::Vector3d(0.8, 1.0, 1.3)).find();
  ASSERT_GE(found.solutions.size(), 6U);
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_LT(found.solutions[k].residual, 1e-3);
    EXPECT_GE(found.solutions[k].met, 2);
  }
  Eigen::Vector3d truth(0.8, 1.0, 1.3);
  do EXPECT_TRUE(has(found, truth)) << truth.transpose();
  while (std::next_permutation(truth.begin(), truth.end()));
}

// Rounding may lead the descent from the prior's mean off the saddle between exchanged solutions, to one of them; the
// population's fit from there may stay on it.
TEST(MeanSolutions, OfSeveralEachIsWhereItsPopulationStarts) {
  const Case one(3, power_sums, Eigen::Vector3d(0.8, 1.0, 1.3));
  MeanSolutions means = one.find();
  ASSERT_GE(means.solutions.size(), 2U);
  means.solutions.resize(2);
  for (MeanSolution& solution : means.solutions) solution.is_from_prior = true;
  const PopulationFitSettings settings{
      .noise = known_noise(one.tests.repeatability_std.cwiseAbs2()), .iterations = 30, .tolerance = 1e-6};
  std::int64_t evaluations = 0;
  for (const PopulationSolution& found : fit_solutions(one.problem(k_usual_starts), settings, means, {}, evaluations))
    EXPECT_LT((found.fit.mean - found.mean.point).cwiseAbs().maxCoeff(), 0.1) << found.fit.mean.transpose();
}

/// Ordered as frequencies by rank are: kinks where two are equal.
Eigen::VectorXd sorted(const Eigen::VectorXd& x) {
  Eigen::VectorXd y(4);
  y << x(0) + 0.1 * x(1), x(1) - 0.1 * x(0), x(2) + 0.1 * x(0), x(0) + x(1) + x(2);
  std::sort(y.begin(), y.begin() + 3);
  return y;
}

TEST(MeanSolutions, AreFoundBeyondTheKinksOfOutputsByRank) {
  const Eigen::Vector3d truth(1.4, 1.0, 0.7);
  const MeanSolutions found = Case(3, sorted, truth, 0.001).find();
  ASSERT_TRUE(has(found, truth));
  EXPECT_LT(found.solutions.front().residual, 1e-3);
  EXPECT_TRUE(has({{found.solutions.front()}}, truth)) << found.solutions.front().point.transpose();
}

Eigen::VectorXd linear(const Eigen::VectorXd& x) {
  return Eigen::Vector3d(x(0) + x(1), x(0) - x(1), 2.0 * x(0));
}

TEST(MeanSolutions, OfALinearFunctionIsOneToWhichThePriorLeads) {
  const MeanSolutions found = Case(2, linear, Eigen::Vector2d(1.2, 0.7)).find();
  ASSERT_EQ(found.solutions.size(), 1U);
  EXPECT_TRUE(found.solutions.front().is_from_prior);
  EXPECT_LT(found.starts, 40);  // the prior's mean, sixteen others, and exchanges
}

TEST(MeanSolutions, WithoutStartsAreThePriorsMean) {
  const MeanSolutions found = Case(2, linear, Eigen::Vector2d(1.2, 0.7)).find(0);
  ASSERT_EQ(found.solutions.size(), 1U);
  EXPECT_EQ(found.solutions.front().point, Eigen::Vector2d(1.0, 1.0));
  EXPECT_EQ(found.starts, 0);
}

Eigen::VectorXd squares(const Eigen::VectorXd& x) {
  return x.cwiseAbs2();
}

TEST(Exchanges, AreAllPermutationsOfParametersWithOnePriorOrPairsWhereTheseAreMany) {
  const Case few(4, squares, Eigen::VectorXd::Ones(4));
  EXPECT_EQ(exchanges(ScaledParameters(*few.space)).size(), 23U);
  const Case many(8, squares, Eigen::VectorXd::Ones(8));
  EXPECT_EQ(exchanges(ScaledParameters(*many.space)).size(), 28U);
}

}  // namespace
}  // namespace mottle::updating
