#include "study/results/parameter_findings.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mottle/updating/methods/interval.hpp"
#include "support/linear_model.hpp"

namespace mottle::study {
namespace {

using Mark = ParameterFinding::Mark;

/// Two parameters with a normal prior of standard deviation 0.5, and a population with intervals of its mean.
struct Found {
  Found() {
    const Distribution prior({.kind = DistributionKind::normal, .mean = 1.0, .std = 0.5});
    space = std::make_unique<ParameterSpace>(std::vector<Parameter>{{.name = "a", .unit = "-", .upper_bound = 3.0},
                                                                    {.name = "b", .unit = "-", .upper_bound = 3.0}},
                                             JointDistribution({prior, prior}));
    result.status = UpdatingStatus::converged;
    result.set_estimate(std::make_shared<NormalPopulation>(
        std::vector<ParameterTransform>(2),
        PopulationOnScales{Eigen::Vector2d(1.2, 0.9), Eigen::Vector2d(0.01, 0.01).asDiagonal(), {}}, 0));
    ParameterIntervals intervals;
    intervals.mean.resize(2, 2);
    intervals.mean << 1.1, 1.3, 0.8, 1.0;
    result.intervals = intervals;
  }
  std::vector<ParameterFinding> findings(Conclusion conclusion = Conclusion::adequate,
                                         const Identifiability* seen = nullptr) const {
    return find_parameters({.model = model, .space = *space}, result, conclusion, seen);
  }
  test::LinearModel model{Eigen::VectorXd::Zero(1), Eigen::MatrixXd::Ones(1, 2)};
  std::unique_ptr<ParameterSpace> space;
  UpdatingResult result;
};

TEST(ParameterFindings, OfANarrowIntervalIsFoundWithThePriorBesideIt) {
  const ParameterFinding finding = Found().findings()[0];
  EXPECT_EQ(finding.mark, Mark::found);
  EXPECT_EQ(finding.interval, Eigen::Vector2d(1.1, 1.3));
  EXPECT_NEAR(finding.prior_interval(0), 1.0 - 0.5 * 1.959963984540054, 1e-9);
}

TEST(ParameterFindings, OfARefusedModelIsDoubtful) {
  for (const ParameterFinding& finding : Found().findings(Conclusion::inadequate)) {
    EXPECT_EQ(finding.mark, Mark::doubtful);
  }
}

TEST(ParameterFindings, OfAnUnfinishedUpdateIsDoubtful) {
  Found found;
  found.result.status = UpdatingStatus::max_iterations;
  EXPECT_EQ(found.findings()[0].mark, Mark::doubtful);
}

TEST(ParameterFindings, OfAnIntervalAsWideAsThePriorIsNotSeen) {
  Found found;
  found.result.intervals->mean.row(1) << 0.0, 1.9;  // the prior's: 0.02 to 1.98
  EXPECT_EQ(found.findings()[0].mark, Mark::found);
  EXPECT_EQ(found.findings()[1].mark, Mark::not_seen);
}

TEST(ParameterFindings, OfAnIntervalThatIsNotDeterminedIsNotSeen) {
  Found found;
  found.result.intervals->mean.row(1).setConstant(std::nan(""));
  EXPECT_EQ(found.findings()[1].mark, Mark::not_seen);
}

TEST(ParameterFindings, OfAPartOfAnUnseenCombinationIsNotSeenAndNamesIt) {
  Identifiability seen;
  seen.unseen_directions.push_back(Eigen::Vector2d(1.0, -1.0).normalized());
  for (const ParameterFinding& finding : Found().findings(Conclusion::adequate, &seen)) {
    EXPECT_EQ(finding.mark, Mark::not_seen);
    EXPECT_EQ(finding.reason.rfind("a and b can only be identified together", 0), 0U);
  }
}

TEST(ParameterFindings, OfAMethodThatGivesTheMeanAloneAreOfTheMeanOnly) {
  Found found;
  found.result.intervals.reset();
  found.result.set_estimate(std::make_shared<MomentEstimate>(
      std::vector<ParameterTransform>(2), Eigen::Vector2d(1.2, 0.9), Eigen::Vector2d(0.01, 0.01).asDiagonal()));
  const ParameterFinding finding = found.findings()[0];
  EXPECT_EQ(finding.mark, Mark::mean_only);
  EXPECT_NEAR(finding.interval(1), 1.2 + 0.1 * 1.959963984540054, 1e-9);
}

TEST(ParameterFindings, OfABoxWiderThanThePriorAreFoundAndNameAnEndOnABound) {
  Found found;
  found.result.intervals.reset();
  auto box = std::make_shared<IntervalResult>();
  box->box = {Eigen::Vector2d(-1.0, 0.5), Eigen::Vector2d(2.9, 3.0)};  // the prior's: 0.02 to 1.98
  found.result.interval = box;
  const std::vector<ParameterFinding> findings = found.findings();
  EXPECT_EQ(findings[0].mark, Mark::found);
  EXPECT_EQ(findings[1].mark, Mark::at_bound);
  EXPECT_EQ(findings[1].reason.rfind("Its box ends on the upper bound, 3:", 0), 0U) << findings[1].reason;
}

TEST(ParameterFindings, OfABoundOnALogarithmicScaleNamesTheMedian) {
  const Distribution prior({.kind = DistributionKind::lognormal, .mean = 2.0, .std = 1.0});
  Parameter parameter{.name = "a", .unit = "-", .upper_bound = 3.0};
  parameter.transform = {ParameterTransform::Kind::log};
  const ParameterSpace space({parameter}, JointDistribution({prior}));
  UpdatingResult result;
  result.status = UpdatingStatus::converged;
  // Logarithms of mean log 3 and variance 2.166: the mean is 3 exp(1.083) = 8.86.
  result.set_estimate(std::make_shared<NormalPopulation>(
      std::vector<ParameterTransform>{parameter.transform},
      PopulationOnScales{Eigen::VectorXd::Constant(1, std::log(3.0)), Eigen::MatrixXd::Constant(1, 1, 2.166), {}}, 0));
  const test::LinearModel model{Eigen::VectorXd::Zero(1), Eigen::MatrixXd::Ones(1, 1)};
  const UpdatingProblem problem{.model = model, .space = space};
  const ParameterFinding finding = find_parameters(problem, result, Conclusion::undecided, nullptr)[0];
  EXPECT_EQ(finding.mark, Mark::at_bound);
  EXPECT_EQ(finding.reason.rfind("Its median stopped on the upper bound, 3 (the mean of that population is 8.861)", 0),
            0U)
      << finding.reason;
  EXPECT_EQ(updated_parameters_json(problem, result)["at_bound"][0], "upper");
  EXPECT_NEAR(updated_parameters_json(problem, result)["location"][0].get<double>(), 3.0, 1e-12);
}

}  // namespace
}  // namespace mottle::study
