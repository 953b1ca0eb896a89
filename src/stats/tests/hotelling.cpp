#include "mottle/stats/tests/hotelling.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <cstdint>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"

namespace mottle::stats {

namespace {

constexpr int k_max_samples = 1'000'000'000;

void require_test_arguments(std::int64_t n_a, std::int64_t n_b, int p, double alpha) {
  require(p >= 1, "p: {} outputs, need at least 1", p);
  require(1 <= n_a && n_a <= k_max_samples && 1 <= n_b && n_b <= k_max_samples,
          "sample sizes: {} and {}, each must be within 1 and {}", n_a, n_b, k_max_samples);
  require(n_a + n_b - 2 >= p, "{} tests and {} samples cannot support {} outputs; together at least {} are needed", n_a,
          n_b, p, std::int64_t{p} + 2);
  require(0.0 < alpha && alpha < 1.0, "alpha: {} is outside (0, 1)", alpha);
}

/// Critical T^2 for nu degrees of freedom of the pooled covariance.
double critical_t_squared(double nu, int p, double alpha) {
  const double denominator = nu - p + 1.0;
  const boost::math::fisher_f f_distribution(p, denominator);
  return quantile(complement(f_distribution, alpha)) * nu * p / denominator;
}

}  // namespace

double hotelling_t_critical(int n_test, int n_model, int p, double alpha) {
  require_test_arguments(n_test, n_model, p, alpha);
  return std::sqrt(critical_t_squared(n_test - 1.0 + (n_model - 1.0), p, alpha));
}

int sufficient_samples(int n_test, int p, double alpha, double tolerance) {
  require_test_arguments(n_test, k_max_samples, p, alpha);
  require(tolerance > 0.0, "tolerance: {} must be positive", tolerance);
  const double limit = (1.0 + tolerance) * std::sqrt(chi_squared_quantile(1.0 - alpha, p));
  const auto is_enough = [&](int n_model) { return hotelling_t_critical(n_test, n_model, p, alpha) <= limit; };
  require(is_enough(k_max_samples), "tolerance: {} is not reached by {} samples", tolerance, k_max_samples);

  int too_few = std::max(1, p + 2 - n_test) - 1;
  int enough = k_max_samples;
  while (enough - too_few > 1) {
    const int middle = too_few + (enough - too_few) / 2;
    (is_enough(middle) ? enough : too_few) = middle;
  }
  return enough;
}

namespace {

/// ((n_a - 1) S_a + (n_b - 1) S_b) / (n_a + n_b - 2); the covariance of a sample of one is not read.
Eigen::MatrixXd pooled_covariance(Eigen::Index size, const Eigen::Ref<const Eigen::MatrixXd>& cov_a, int n_a,
                                  const Eigen::Ref<const Eigen::MatrixXd>& cov_b, int n_b) {
  Eigen::MatrixXd pooled = Eigen::MatrixXd::Zero(size, size);
  const auto add = [&](const Eigen::Ref<const Eigen::MatrixXd>& covariance, int n) {
    if (n == 1) return;
    require(covariance.rows() == size && covariance.cols() == size, "covariance: {} x {} for {} outputs",
            covariance.rows(), covariance.cols(), size);
    pooled += (n - 1.0) / (n_a - 1.0 + (n_b - 1.0)) * covariance;
  };
  add(cov_a, n_a);
  add(cov_b, n_b);
  require(pooled.allFinite(), "covariance: an entry is not finite");
  return pooled;
}

/// difference' S^-1 difference; throws where S is singular.
double squared_distance(const Eigen::VectorXd& difference, const Eigen::MatrixXd& pooled) {
  // Scaled to unit diagonal, so that "singular" does not depend on the units of the outputs.
  const Eigen::VectorXd standard_deviation = pooled.diagonal().cwiseSqrt();
  for (Eigen::Index i = 0; i < standard_deviation.size(); ++i) {
    require(standard_deviation[i] > 0.0, "pooled covariance: singular, output {} (from 0) does not vary; leave it out",
            i);
  }
  const Eigen::VectorXd scale = standard_deviation.cwiseInverse();
  const Eigen::MatrixXd correlation = scale.asDiagonal() * pooled * scale.asDiagonal();
  const double smallest = symmetric_eigenvalues(correlation)[0];
  require(smallest > 1e-12,
          "pooled covariance: singular, the smallest eigenvalue of its correlation is {:.3g}; leave out an output that "
          "follows from the others",
          smallest);
  const Eigen::VectorXd scaled = scale.cwiseProduct(difference);
  return scaled.dot(CholeskyFactor(correlation).solve(scaled));
}

}  // namespace

TwoSampleTest hotelling_two_sample(const Eigen::Ref<const Eigen::VectorXd>& mean_a,
                                   const Eigen::Ref<const Eigen::MatrixXd>& cov_a, int n_a,
                                   const Eigen::Ref<const Eigen::VectorXd>& mean_b,
                                   const Eigen::Ref<const Eigen::MatrixXd>& cov_b, int n_b, double alpha) {
  const int p = static_cast<int>(mean_a.size());
  require(mean_b.size() == mean_a.size(), "means: {} outputs against {}", mean_a.size(), mean_b.size());
  require(mean_a.allFinite() && mean_b.allFinite(), "means: an entry is not finite");
  require_test_arguments(n_a, n_b, p, alpha);
  const Eigen::MatrixXd pooled = pooled_covariance(p, cov_a, n_a, cov_b, n_b);
  const double nu = n_a - 1.0 + (n_b - 1.0);

  TwoSampleTest test{.df1 = p, .df2 = n_a + n_b - p - 1};
  test.t_squared = squared_distance(mean_a - mean_b, pooled) / (1.0 / n_a + 1.0 / n_b);
  test.f = test.t_squared * test.df2 / (nu * p);
  test.p_value = cdf(complement(boost::math::fisher_f(test.df1, test.df2), test.f));
  test.critical_t_squared = critical_t_squared(nu, p, alpha);
  test.rejects = test.t_squared > test.critical_t_squared;
  return test;
}

}  // namespace mottle::stats
