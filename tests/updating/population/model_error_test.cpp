// Errors of the model that all specimens share, in every method.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/core/subject.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/updating/methods/deterministic.hpp"
#include "mottle/updating/methods/maximum_likelihood.hpp"
#include "support/linear_problem.hpp"
#include "support/methods.hpp"
#include "support/three_masses.hpp"

namespace mottle::updating {
namespace {

UpdatingProblem problem_of(const test::LinearProblem& linear, const Eigen::VectorXd& error = {}) {
  UpdatingProblem problem = linear.problem(linear.noise);
  problem.tests.model_error_std = error;
  problem.iterations = 100;
  problem.tolerance = 1e-9;
  return problem;
}

UpdatingResult update(const UpdatingProblem& problem, const MaximumLikelihoodOptions& options = {}) {
  return MaximumLikelihoodUpdater(options).update(problem, {});
}

TEST(ModelError, MeanIsThatOfGeneralisedLeastSquaresOnAllTestsStacked) {
  test::LinearProblem linear;
  linear.tests(4, 2) = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector4d error(0.3, 0.1, 0.2, 0.0);
  const UpdatingResult result = update(problem_of(linear, error));
  const Eigen::Index rows = 47;
  Eigen::MatrixXd x(rows, 2);
  Eigen::MatrixXd picks = Eigen::MatrixXd::Zero(rows, 4);
  Eigen::MatrixXd v = Eigen::MatrixXd::Zero(rows, rows);
  Eigen::VectorXd y(rows);
  Eigen::Index row = 0;
  for (Eigen::Index s = 0; s < 12; ++s) {
    const Eigen::Index first = row;
    for (Eigen::Index k = 0; k < 4; ++k) {
      if (std::isnan(linear.tests(s, k))) continue;
      x.row(row) = test::LinearProblem::slope().row(k);
      picks(row, k) = 1.0;
      v(row, row) = linear.noise(k) * linear.noise(k);
      y(row++) = linear.tests(s, k) - Eigen::Vector4d(1.0, 2.0, 0.0, -1.0)(k);
    }
    const auto own = x.middleRows(first, row - first);
    v.block(first, first, row - first, row - first) += own * result.covariance * own.transpose();
  }
  v += picks * error.cwiseAbs2().asDiagonal() * picks.transpose();
  const Eigen::MatrixXd weighted = x.transpose() * v.inverse();
  const Eigen::MatrixXd covariance = (weighted * x).inverse();
  EXPECT_LT((result.mean - covariance * weighted * y).norm(), 1e-6);
  const Eigen::VectorXd shift =
      error.cwiseAbs2().asDiagonal() * picks.transpose() * v.inverse() * (y - x * result.mean);
  ASSERT_TRUE(result.model_error);
  EXPECT_LT((result.model_error->shift - shift).norm(), 1e-6);
  EXPECT_EQ(result.model_error->shift(3), 0.0);
}

TEST(ModelError, ChangesNoBitWhereItIsZero) {
  const test::LinearProblem linear;
  const UpdatingResult without = update(problem_of(linear));
  const UpdatingResult with = update(problem_of(linear, Eigen::Vector4d::Zero()));
  EXPECT_EQ(with.mean, without.mean);
  EXPECT_EQ(with.covariance, without.covariance);
  EXPECT_EQ(with.intervals->mean, without.intervals->mean);
  EXPECT_FALSE(with.model_error);
}

TEST(ModelError, WidensTheMeansAloneWithAsManyOutputsAsParameters) {
  const test::ThreeMasses structure;
  UpdatingProblem problem = structure.problem(test::frequencies_of(structure, test::oracle_parameters()));
  const UpdatingResult without = update(problem);
  problem.tests.model_error_std = 0.003 * sample_mean(problem.tests.values);
  const UpdatingResult with = update(problem);
  // Specimens of a curved model see a little of the error, for their sensitivities differ: a third of a standard error.
  const Eigen::VectorXd standard_error = without.covariance.diagonal().cwiseSqrt() / std::sqrt(10.0);
  EXPECT_LT((with.mean - without.mean).cwiseQuotient(standard_error).cwiseAbs().maxCoeff(), 0.5);
  EXPECT_TRUE(with.intervals->std.isApprox(without.intervals->std, 2e-2));
  const Eigen::VectorXd wide = with.intervals->mean.col(1) - with.intervals->mean.col(0);
  const Eigen::VectorXd narrow = without.intervals->mean.col(1) - without.intervals->mean.col(0);
  EXPECT_TRUE((wide.array() > narrow.array()).all());
  EXPECT_LT(with.model_error->shift.cwiseQuotient(problem.tests.model_error_std).cwiseAbs().maxCoeff(), 0.5);
  EXPECT_TRUE(test::says(with, "as given"));
}

TEST(ModelError, FindsWhichOutputIsOff) {
  test::LinearProblem linear;
  linear.tests.col(2).array() += 1.0;
  const UpdatingResult misled = update(problem_of(linear));
  const UpdatingResult result = update(problem_of(linear, Eigen::Vector4d(0.0, 0.0, 10.0, 0.0)));
  const UpdatingResult truth = update(problem_of(test::LinearProblem()));
  EXPECT_LT((result.mean - truth.mean).norm(), 0.1 * (misled.mean - truth.mean).norm());
  EXPECT_NEAR(result.model_error->shift(2), 1.0, 3.0 * std::sqrt(result.model_error->covariance(2, 2)));
}

TEST(ModelError, EstimatedNeedsMoreOutputsThanParametersAndSaysOnHowFewItRests) {
  const test::ThreeMasses structure;
  UpdatingProblem problem = structure.problem(test::frequencies_of(structure, test::oracle_parameters()));
  problem.tests.is_model_error_estimated = true;
  try {
    update(problem);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("model error: cannot be estimated"), std::string::npos);
  }
  test::LinearProblem linear;
  linear.tests.rowwise() += Eigen::RowVector4d(0.3, -0.5, 0.4, -0.2);
  UpdatingProblem more = problem_of(linear);
  more.tests.is_model_error_estimated = true;
  const UpdatingResult result = update(more);
  ASSERT_TRUE(result.model_error);
  ASSERT_EQ(result.model_error->degrees_of_freedom.size(), 1U);
  EXPECT_NEAR(result.model_error->degrees_of_freedom[0], 2.0, 0.1);
  EXPECT_TRUE(test::says(result, "This estimate has only"));
  // Four numbers about 0.36 of root mean square; two of their combinations are seen.
  EXPECT_GT(result.model_error->std(0), 0.05);
  EXPECT_LT(result.model_error->std(0), 2.0);
  const UpdatingResult without = update(problem_of(linear));
  EXPECT_GT(result.intervals->mean(0, 1) - result.intervals->mean(0, 0),
            without.intervals->mean(0, 1) - without.intervals->mean(0, 0));
}

TEST(ModelError, AddsToTheMeasurementsOfOneStructure) {
  const test::LinearProblem linear;
  const auto standard_deviations = [&](const Eigen::VectorXd& noise, const Eigen::VectorXd& error) {
    UpdatingProblem problem = problem_of(linear, error);
    problem.tests.repeatability_std = noise;
    return test::standard_deviations(DeterministicUpdater({.specimen = 1}).update(problem, {}));
  };
  const Eigen::VectorXd error = Eigen::Vector4d(0.3, 0.1, 0.2, 0.4);
  const Eigen::VectorXd both = (linear.noise.cwiseAbs2() + error.cwiseAbs2()).cwiseSqrt();
  EXPECT_TRUE(standard_deviations(linear.noise, error).isApprox(standard_deviations(both, {}), 1e-12));
}

TEST(ModelError, BootstrapWidensTheMeansToo) {
  const test::LinearProblem linear;
  const MaximumLikelihoodOptions options{.intervals = MaximumLikelihoodOptions::Intervals::bootstrap,
                                         .bootstrap_samples = 100};
  const auto width = [&](const Eigen::VectorXd& error) {
    UpdatingProblem problem = problem_of(linear, error);
    problem.tolerance = 1e-3;
    const ParameterIntervals ends = *update(problem, options).intervals;
    return ends.mean(0, 1) - ends.mean(0, 0);
  };
  EXPECT_GT(width(Eigen::Vector4d::Constant(0.5)), 1.5 * width({}));
}

class EveryMethodAndModelError : public testing::TestWithParam<std::string> {};

TEST_P(EveryMethodAndModelError, IsNeverPassedOverInSilence) {
  const test::LinearProblem linear;
  const std::unique_ptr<Updater> method = test::tested_method(GetParam());
  UpdatingProblem problem = problem_of(linear, Eigen::Vector4d::Constant(0.1));
  problem.tolerance = 1e-3;
  EXPECT_TRUE(test::says(method->update(problem, {}), "rror of the model") ||
              test::says(method->update(problem, {}), "model's error"));
  problem.tests.model_error_std.resize(0);
  problem.tests.is_model_error_estimated = true;
  try {
    const UpdatingResult estimated = method->update(problem, {});
    EXPECT_TRUE(test::says(estimated, "is not used") || estimated.model_error.has_value());
  } catch (const SubjectError& refused) {
    EXPECT_EQ(refused.subject().kind, Subject::Kind::model_error);
  }
}

TEST_P(EveryMethodAndModelError, MakesTheMeansOfAPopulationLessSure) {
  const test::LinearProblem linear;
  const std::unique_ptr<Updater> method = test::tested_method(GetParam());
  UpdatingProblem problem = problem_of(linear);
  problem.tolerance = 1e-3;
  const UpdatingResult without = method->update(problem, {});
  problem.tests.model_error_std = Eigen::Vector4d::Constant(0.2);
  const UpdatingResult with = method->update(problem, {});
  if (!with.intervals) return;
  EXPECT_GT(with.intervals->mean(0, 1) - with.intervals->mean(0, 0),
            without.intervals->mean(0, 1) - without.intervals->mean(0, 0));
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryMethodAndModelError, testing::ValuesIn(test::method_names(false)),
                         test::instance_name);

}  // namespace
}  // namespace mottle::updating
