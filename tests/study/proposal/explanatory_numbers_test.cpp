// The likelihood by which numbers are chosen as parameters, and what it chooses.
#include "study/proposal/explanatory_numbers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

namespace mottle::study {
namespace {

using testing::IsEmpty;
using testing::UnorderedElementsAre;

/// Wishart's ln density of the scatter and the normal one of the mean, without constants.
double log_density(const Eigen::MatrixXd& v, const Eigen::MatrixXd& w, const Eigen::MatrixXd& scatter,
                   const Eigen::VectorXd& mean, double specimens) {
  const double of_scatter = -0.5 * (specimens - 1.0) * (std::log(v.determinant()) + (v.inverse() * scatter).trace());
  return of_scatter - 0.5 * (std::log(w.determinant()) + mean.dot(w.inverse() * mean));
}

double log_density(const Eigen::MatrixXd& changes, const Eigen::VectorXd& variances, const Eigen::VectorXd& noise,
                   const Eigen::MatrixXd& scatter, const Eigen::VectorXd& mean, double specimens) {
  const Eigen::MatrixXd r = noise.cwiseAbs2().asDiagonal();
  const Eigen::MatrixXd v = changes * variances.asDiagonal() * changes.transpose() + r;
  const Eigen::VectorXd wide = Eigen::VectorXd::Ones(variances.size()) + variances / specimens;
  const Eigen::MatrixXd w = changes * wide.asDiagonal() * changes.transpose() + r / specimens;
  return log_density(v, w, scatter, mean, specimens);
}

Eigen::MatrixXd two_changes() {
  return (Eigen::MatrixXd(3, 2) << 0.01, 0.004, 0.002, 0.01, -0.003, 0.005).finished();
}

/// Tests of a population: numbers of `shifts` are off by that many prior standard deviations and scatter by 0.3 of
/// them, with noise of 0.001.
LinearisedTests drawn(const Eigen::MatrixXd& changes, const Eigen::VectorXd& shifts, int specimens, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  LinearisedTests problem{.differences = Eigen::MatrixXd(specimens, changes.rows()),
                          .changes = changes,
                          .preferences = Eigen::VectorXd::Zero(changes.cols()),
                          .typical_noise = Eigen::VectorXd::Constant(changes.rows(), 0.001),
                          .curvature = Eigen::VectorXd::Zero(changes.rows())};
  for (int s = 0; s < specimens; ++s) {
    Eigen::VectorXd numbers = shifts;
    for (double& number : numbers) number *= 1.0 + 0.3 * normal(engine);
    Eigen::VectorXd noise(changes.rows());
    for (double& value : noise) value = 0.001 * normal(engine);
    problem.differences.row(s) = (changes * numbers + noise).transpose();
  }
  return problem;
}

Eigen::MatrixXd random_changes(int outputs, int numbers, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd changes(outputs, numbers);
  for (double& value : changes.reshaped()) value = 0.01 * normal(engine);
  return changes;
}

TEST(LinearExplanation, HasSciPysDensities) {
  const Eigen::MatrixXd scatter =
      1e-5 * (Eigen::MatrixXd(3, 3) << 9.0, 3.0, -1.0, 3.0, 4.0, 1.0, -1.0, 1.0, 2.0).finished();
  const Eigen::Vector3d mean(0.01, 0.004, -0.002);
  const Eigen::VectorXd noise = Eigen::VectorXd::Constant(3, 0.002);
  const auto at = [&](double first, double second) {
    return log_density(two_changes(), Eigen::Vector2d(first, second), noise, scatter, mean, 6.0);
  };
  // scipy.stats.wishart.logpdf(5 S, 5, V) + multivariate_normal.logpdf(e, 0, W), the difference at two gamma.
  EXPECT_NEAR(at(0.09, 0.25) - at(0.04, 0.01), 23.514172680226487, 1e-8);
}

// The gain is by updates of rank 1, the value from factors of the whole matrices, the density from inverses.
TEST(LinearExplanation, GainsWhatTheDensityGains) {
  const Eigen::MatrixXd changes = two_changes();
  const LinearisedTests problem = drawn(changes, Eigen::Vector2d(1.0, -0.7), 6, 5);
  LinearExplanation explanation(problem);
  const Eigen::VectorXd mean = problem.differences.colwise().mean().transpose();
  const Eigen::MatrixXd centred = problem.differences.rowwise() - mean.transpose();
  const Eigen::MatrixXd scatter = centred.transpose() * centred / 5.0;
  std::vector<double> variances;
  for (const Eigen::Index number : {0, 1}) {
    const LinearExplanation::Gain gain = explanation.gain(number);
    const double before = explanation.value();
    const Eigen::VectorXd earlier = Eigen::Map<const Eigen::VectorXd>(variances.data(), number);
    variances.push_back(gain.variance);
    const Eigen::VectorXd later = Eigen::Map<const Eigen::VectorXd>(variances.data(), number + 1);
    const double expected = log_density(changes.leftCols(number + 1), later, explanation.noise(), scatter, mean, 6.0) -
                            log_density(changes.leftCols(number), earlier, explanation.noise(), scatter, mean, 6.0);
    explanation.add(number, gain.variance);
    EXPECT_NEAR(gain.value, expected, 1e-8 * std::abs(expected) + 1e-8);
    EXPECT_NEAR(explanation.value() - before, expected, 1e-8 * std::abs(expected) + 1e-8);
  }
}

TEST(SelectExplanatory, FindsTheNumbersThatWereMoved) {
  Eigen::VectorXd shifts = Eigen::VectorXd::Zero(20);
  shifts(3) = 1.0;
  shifts(7) = -0.8;
  shifts(16) = 0.6;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const LinearisedTests problem = drawn(random_changes(10, 20, seed), shifts, 12, 100 + seed);
    EXPECT_THAT(select_explanatory(problem, 8).chosen, UnorderedElementsAre(3, 7, 16)) << seed;
  }
}

TEST(SelectExplanatory, FindsThemDespiteGaps) {
  Eigen::VectorXd shifts = Eigen::VectorXd::Zero(20);
  shifts(3) = 1.0;
  shifts(7) = -0.8;
  LinearisedTests problem = drawn(random_changes(10, 20, 2), shifts, 12, 7);
  for (const auto& [specimen, output] : {std::pair{0, 3}, {4, 9}, {4, 2}, {11, 0}}) {
    problem.differences(specimen, output) = std::nan("");
  }
  EXPECT_THAT(select_explanatory(problem, 8).chosen, UnorderedElementsAre(3, 7));
}

// One mean says nothing of scatter: a number is chosen for the mean alone.
TEST(SelectExplanatory, FindsThemInOneSpecimen) {
  Eigen::VectorXd shifts = Eigen::VectorXd::Zero(20);
  shifts(3) = 1.5;
  EXPECT_THAT(select_explanatory(drawn(random_changes(10, 20, 2), shifts, 1, 7), 8).chosen, UnorderedElementsAre(3));
}

// Of 200 populations that differ from the model by noise alone; a gain of 1 + ln 20 by chance is about as rare as 1 in
// 20 for all candidates together: at 10 % the chance of more than 30 is 0.5 %.
TEST(SelectExplanatory, SeldomExplainsNoise) {
  int wrong = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const LinearisedTests problem = drawn(random_changes(10, 20, seed), Eigen::VectorXd::Zero(20), 12, 1000 + seed);
    wrong += select_explanatory(problem, 8).chosen.empty() ? 0 : 1;
  }
  EXPECT_LE(wrong, 30);
}

TEST(SelectExplanatory, TakesTheJointWhereTwoExplainTheSame) {
  Eigen::MatrixXd changes = random_changes(10, 20, 4);
  changes.col(11) = 1.02 * changes.col(3);
  Eigen::VectorXd shifts = Eigen::VectorXd::Zero(20);
  shifts(3) = 1.0;
  LinearisedTests problem = drawn(changes, shifts, 12, 8);
  problem.preferences(11) = 3.0;
  EXPECT_THAT(select_explanatory(problem, 8).chosen, UnorderedElementsAre(11));
}

TEST(SelectExplanatory, ChoosesNoMoreThanItMay) {
  const LinearisedTests problem = drawn(random_changes(10, 20, 6), Eigen::VectorXd::Ones(20), 12, 9);
  EXPECT_LE(select_explanatory(problem, 4).chosen.size(), 4U);
}

TEST(SelectExplanatory, KeepsThoseThatAreFixed) {
  const LinearisedTests problem = drawn(random_changes(10, 20, 6), Eigen::VectorXd::Ones(20), 12, 9);
  EXPECT_THAT(select_explanatory(problem, 8, {5, 2}, true).chosen, UnorderedElementsAre(2, 5));
}

}  // namespace
}  // namespace mottle::study
