// Hotelling's two-sample test for the difference of the means of tests and cloud, and the number of samples it needs.
#pragma once

#include <Eigen/Core>

#include "mottle/layers.hpp"

namespace mottle::stats {

/// Critical value of Hotelling's two-sample statistic, as T (not T^2).
///
///   T^2 = nu p / (nu - p + 1) * F^-1(1 - alpha; p, nu - p + 1),   nu = n_test + n_model - 2
///
/// @param n_test, n_model  sample sizes, each >= 1, n_test + n_model > p + 1
/// @param p                number of outputs, >= 1
/// @param alpha            significance level, in (0, 1)
/// @return                 T, dimensionless; decreases towards sqrt(chi2_p(1 - alpha)) as samples are added
/// @throws InvalidInput    too few samples for p outputs, or alpha outside (0, 1)
/// Source: [Mares2006], Fig. 2; [Anderson2003], ch. 5.
double hotelling_t_critical(int n_test, int n_model, int p, double alpha);

/// Smallest number of model samples at which the critical value T has come within `tolerance` of its limit:
///
///   T(n_model) <= (1 + tolerance) sqrt(chi2_p(1 - alpha))
///
/// More samples no longer help the test; what the estimate itself needs is another question.
///
/// @param n_test     number of specimens, >= 1
/// @param p          number of outputs, >= 1
/// @param alpha      significance level, in (0, 1)
/// @param tolerance  relative, > 0
/// @throws InvalidInput  an argument outside its range, or a tolerance that a thousand million samples do not reach
/// Source: [Mares2006], section 2.
int sufficient_samples(int n_test, int p, double alpha, double tolerance);

/// Outcome of a two-sample test on means.
struct TwoSampleTest {
  double t_squared = 0.0;
  double f = 0.0;                   ///< t_squared (df2) / (nu p), F-distributed where the means agree
  double p_value = 1.0;             ///< chance of an f at least as large where the means agree
  double critical_t_squared = 0.0;  ///< at alpha
  int df1 = 0;                      ///< p
  int df2 = 0;                      ///< n_a + n_b - p - 1
  bool rejects = false;             ///< t_squared > critical_t_squared
};

/// Hotelling's two-sample test that two normal populations of one covariance have one mean:
///
///   T^2 = n_a n_b / (n_a + n_b) (a - b)' S^-1 (a - b),   S = ((n_a - 1) S_a + (n_b - 1) S_b) / (n_a + n_b - 2)
///
/// @param mean_a, mean_b  [output]
/// @param cov_a, cov_b    [output x output], unbiased; not read for a sample of one
/// @param n_a, n_b        sample sizes, >= 1
/// @param alpha           significance level, in (0, 1)
/// @throws InvalidInput   sizes that do not match, alpha outside (0, 1), more outputs than n_a + n_b - 2 (says how many
///                        samples are needed), or a singular pooled covariance (says its smallest eigenvalue)
/// Source: [Hotelling1931]; [Anderson2003], section 5.3.
TwoSampleTest hotelling_two_sample(const Eigen::Ref<const Eigen::VectorXd>& mean_a,
                                   const Eigen::Ref<const Eigen::MatrixXd>& cov_a, int n_a,
                                   const Eigen::Ref<const Eigen::VectorXd>& mean_b,
                                   const Eigen::Ref<const Eigen::MatrixXd>& cov_b, int n_b, double alpha);

}  // namespace mottle::stats
