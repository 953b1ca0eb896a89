// One random variable as a study describes it: six families, given by mean and standard deviation and, where the
// family has them, by bounds. Samples are drawn in joint_distribution.hpp.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::stats {

/// The families of distributions that a study may name.
enum class DistributionKind { normal, lognormal, uniform, truncated_normal, beta, gamma };

/// What a user writes: the kind and the values that it needs; nan = not given.
struct DistributionSpec {
  DistributionKind kind = DistributionKind::normal;
  double mean = std::numeric_limits<double>::quiet_NaN();  ///< truncated normal: of the parent normal
  double std = std::numeric_limits<double>::quiet_NaN();   ///< truncated normal: of the parent normal
  double lower = std::numeric_limits<double>::quiet_NaN();
  double upper = std::numeric_limits<double>::quiet_NaN();
};

/// One line of the table of families.
struct DistributionKindInfo {
  std::string name;  ///< as a study writes it
  DistributionKind kind;
  std::vector<std::string> required;  ///< of "mean", "std", "lower", "upper": all of these and no other
  std::string meaning;                ///< one sentence
};

/// Every family, in the order of the documentation.
const std::vector<DistributionKindInfo>& distribution_kinds();

/// The table's line for `kind`.
const DistributionKindInfo& distribution_kind_info(DistributionKind kind);

/// A continuous distribution on an interval. Value type, cheap to copy; const members may be called from many threads.
class Distribution {
 public:
  /// @throws InvalidInput  names the value: missing, not among those of the kind, not finite; std <= 0; lower >= upper;
  ///                       lognormal and gamma with mean <= 0; beta with mean outside (lower, upper) or
  ///                       std^2 >= (mean - lower)(upper - mean); gamma with std outside 1e-4 to 1e3 of the mean,
  ///                       beta with shape parameters beyond 1e8: the special functions end there; truncated normal
  ///                       whose bounds hold less than 1e-10 of the parent normal
  explicit Distribution(const DistributionSpec& spec);

  const DistributionSpec& spec() const;

  /// Of the variable itself: for a truncated normal after truncation, unlike spec().
  double mean() const;
  double standard_deviation() const;

  /// Ends of the support; may be infinite.
  double lower() const;
  double upper() const;

  double cdf(double value) const;
  double pdf(double value) const;

  /// Value x with P(X <= x) = probability.
  ///
  /// @param probability  in [0, 1]; 0 and 1 give the ends of the support
  /// @throws InvalidInput  probability outside [0, 1] or nan
  double quantile(double probability) const;

  /// Value x with P(X > x) = probability; keeps its digits where quantile(1 - probability) has lost them.
  double upper_quantile(double probability) const;

  /// Value x with P(X <= x) = P(N <= z) for a standard normal N: the inverse iso-probabilistic transform, accurate in
  /// both tails.
  ///
  /// @param z  finite
  /// Source: [Liu1986].
  double from_standard_normal(double z) const;

  class Implementation;

 private:
  DistributionSpec spec_;
  std::shared_ptr<const Implementation> implementation_;
};

}  // namespace mottle::stats
