// The evidence of unknown noise by importance sampling, against quadrature over the level.
#include "updating/methods/evidence_about_best.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numbers>

#include "support/common_linear.hpp"

namespace mottle::updating {
namespace {

using test::CommonLinear;

/// ln N(z; E z, cov z) of all specimens' values at one level.
double log_density(const UpdatingProblem& problem, const Eigen::VectorXd& variances) {
  const Eigen::MatrixXd slope = CommonLinear::slope();
  const Eigen::Index n = problem.tests.values.rows(), p = problem.tests.values.cols();
  const Eigen::VectorXd mean = problem.model.evaluate(problem.space.prior().mean().transpose(), {}).outputs.row(0);
  const Eigen::MatrixXd shared = slope * problem.space.prior().covariance() * slope.transpose();
  Eigen::VectorXd apart(n * p);
  Eigen::MatrixXd covariance(n * p, n * p);
  for (Eigen::Index s = 0; s < n; ++s) {
    apart.segment(s * p, p) = problem.tests.values.row(s).transpose() - mean;
    for (Eigen::Index t = 0; t < n; ++t) covariance.block(s * p, t * p, p, p) = shared;
    covariance.block(s * p, s * p, p, p).diagonal() += variances;
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  const double log_root = Eigen::MatrixXd(factor.matrixL()).diagonal().array().log().sum();
  return -0.5 * apart.dot(factor.solve(apart)) - log_root -
         0.5 * static_cast<double>(n * p) * std::log(2.0 * std::numbers::pi);
}

double evidence_by_quadrature(const UpdatingProblem& problem, const NoiseLevels& noise, const BayesOptions& options) {
  constexpr double k_step = 1e-3;
  const boost::math::students_t t(options.noise_degrees_of_freedom);
  double sum = 0.0;
  for (double log_level = std::log(1e-7); log_level < std::log(10.0); log_level += k_step) {
    const double level = std::exp(log_level);
    const double prior = 2.0 * boost::math::pdf(t, level / options.noise_scale) / options.noise_scale;
    sum +=
        prior * level * k_step * std::exp(log_density(problem, noise.variances(Eigen::VectorXd::Constant(1, level))));
  }
  return std::log(sum);
}

std::optional<EvidenceAboutBest> found_about(const UpdatingProblem& problem, std::int64_t& evaluations) {
  const NoiseLevels noise(problem, {});
  const CommonLikelihood likelihood(problem.tests);
  const RunContext context;
  PosteriorTarget target(problem, noise, likelihood, context);
  const Eigen::VectorXd mean = problem.space.prior().mean();
  const PosteriorPeak peak{.scores = Eigen::Vector3d::Zero(),
                           .parameters = mean,
                           .outputs = problem.model.evaluate(mean.transpose(), context).outputs.row(0).transpose(),
                           .sensitivity = CommonLinear::slope()};
  return evidence_about_best(problem, noise, likelihood, {peak}, Eigen::MatrixXd::Constant(10, 1, 0.01),
                             target.target(), context, evaluations);
}

void expect_evidence(const CommonLinear& linear) {
  const BayesOptions options;
  const UpdatingProblem problem = linear.problem();
  const NoiseLevels noise(problem, options);
  ASSERT_EQ(noise.count(), 1);
  std::int64_t evaluations = 0;
  const auto found = found_about(problem, evaluations);
  ASSERT_TRUE(found);
  EXPECT_LT(found->standard_error, 0.03);
  EXPECT_LT(found->pareto_k, 0.5);
  EXPECT_NEAR(found->log_evidence, evidence_by_quadrature(problem, noise, options), 4.0 * found->standard_error);
}

TEST(EvidenceAboutBest, IsThatOfQuadratureWithOrdinaryNoise) {
  CommonLinear linear;
  linear.tests.repeatability_std.setZero();
  expect_evidence(linear);
}

TEST(EvidenceAboutBest, IsThatOfQuadratureWhereTheTestsAreMetNearlyExactly) {
  CommonLinear linear;
  linear.tests.repeatability_std.setZero();
  linear.tests.values = linear.model.evaluate(Eigen::RowVector2d(1.1, 2.2), {}).outputs;
  linear.tests.values(0, 0) += 1e-4;
  expect_evidence(linear);
}

TEST(EvidenceAboutBest, IsNotLookedForWhereDirectionsOfTheOutputsAreAllMoved) {
  CommonLinear linear;
  linear.tests.repeatability_std.setZero();
  linear.tests.values = linear.model.evaluate(Eigen::RowVector2d(1.1, 2.2), {}).outputs;
  linear.tests.values(0, 2) = std::nan("");  // two values, two parameters
  std::int64_t evaluations = 0;
  EXPECT_FALSE(found_about(linear.problem(), evaluations));
  EXPECT_EQ(evaluations, 0);
}

/// y1 = x^2, y2 = 2 x^2, which x and -x give alike.
class Squares final : public model::Model {
 public:
  Eigen::Index parameter_count() const override { return 1; }
  const std::vector<Quantity>& outputs() const override { return outputs_; }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext&) const override {
    Evaluation evaluation;
    evaluation.outputs = samples.cwiseAbs2() * Eigen::RowVector2d(1.0, 2.0);
    return evaluation;
  }

 private:
  std::vector<Quantity> outputs_ = {model::named_quantity("y1", "-"), model::named_quantity("y2", "-")};
};

/// Over ln level and x > 0, twice; f = x^2 (1, 2).
double evidence_of_squares(const NoiseLevels& noise, const Eigen::RowVector2d& test, const BayesOptions& options) {
  constexpr double k_step = 0.01;
  constexpr int k_cells = 400;  // across eight deviations of x to either side of the best
  const boost::math::students_t t(options.noise_degrees_of_freedom);
  const double best = std::sqrt((test(0) + 2.0 * test(1)) / 5.0);
  double sum = 0.0;
  for (double log_level = std::log(1e-7); log_level < std::log(10.0); log_level += k_step) {
    const double level = std::exp(log_level);
    const Eigen::VectorXd variances = noise.variances(Eigen::VectorXd::Constant(1, level));
    const double reach = std::min(best, 8.0 * std::sqrt(variances.maxCoeff()) / best);
    const double width = 2.0 * reach / k_cells;
    double inner = 0.0;
    for (int cell = 0; cell < k_cells; ++cell) {
      const double x = best - reach + (cell + 0.5) * width;
      const Eigen::Vector2d off = test.transpose() - x * x * Eigen::Vector2d(1.0, 2.0);
      inner +=
          std::exp(-0.5 * (off.cwiseAbs2().cwiseQuotient(variances).sum() + variances.array().log().sum() + x * x));
    }
    sum +=
        2.0 * boost::math::pdf(t, level / options.noise_scale) / options.noise_scale * level * k_step * inner * width;
  }
  return std::log(2.0 * sum) - 1.5 * std::log(2.0 * std::numbers::pi);
}

TEST(EvidenceAboutBest, IsThatOfBothModesWhereBothPeaksAreGiven) {
  const Squares squares;
  const ParameterSpace space({{.name = "x", .unit = "-", .limit = {.lower = -HUGE_VAL}}},
                             JointDistribution({Distribution({.mean = 0.0, .std = 1.0})}));
  const Eigen::RowVector2d test(1.44, 2.8808);
  const UpdatingProblem problem{.model = squares, .space = space, .tests = {test, Eigen::Vector2d::Zero()}};
  const BayesOptions options;
  const NoiseLevels noise(problem, options);
  const CommonLikelihood likelihood(problem.tests);
  const RunContext context;
  PosteriorTarget target(problem, noise, likelihood, context);
  std::vector<PosteriorPeak> peaks;
  for (const double x : {1.19, -1.21}) {
    peaks.push_back({.scores = Eigen::Vector2d(x, 0.0),
                     .parameters = Eigen::VectorXd::Constant(1, x),
                     .outputs = x * x * Eigen::Vector2d(1.0, 2.0),
                     .sensitivity = 2.0 * x * Eigen::Vector2d(1.0, 2.0)});
  }
  std::int64_t evaluations = 0;
  const auto found = evidence_about_best(problem, noise, likelihood, peaks, Eigen::MatrixXd::Constant(10, 1, 1e-3),
                                         target.target(), context, evaluations);
  ASSERT_TRUE(found);
  EXPECT_LT(found->standard_error, 0.03);
  EXPECT_NEAR(found->log_evidence, evidence_of_squares(noise, test, options), 4.0 * found->standard_error);
}

}  // namespace
}  // namespace mottle::updating
