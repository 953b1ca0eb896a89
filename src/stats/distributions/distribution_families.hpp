// Behind Distribution: one class a family. OpenTURNS knows densities and probabilities; quantiles are written
// here, because its own stop at a tail probability of 1e-14 and take no score of a copula directly.
#pragma once

#include <memory>
#include <openturns/Distribution.hxx>

#include "mottle/layers.hpp"
#include "mottle/stats/distributions/distribution.hpp"

namespace mottle::stats {

class Distribution::Implementation {
 public:
  /// @param object                    the family's distribution in OpenTURNS
  /// @param mean, standard_deviation  the variable's own
  Implementation(OT::Distribution object, double mean, double standard_deviation);
  virtual ~Implementation() = default;

  double mean() const { return mean_; }
  double standard_deviation() const { return standard_deviation_; }
  double lower() const { return lower_; }
  double upper() const { return upper_; }
  double cdf(double value) const;
  double pdf(double value) const;

  /// Value with P(X <= x) = probability, for probability in (0, 1/2].
  virtual double lower_tail_quantile(double probability) const = 0;
  /// Value with P(X > x) = probability, for probability in (0, 1/2].
  virtual double upper_tail_quantile(double probability) const = 0;
  /// Families with a shorter way than two special functions override this.
  virtual double from_standard_normal(double z) const;

 private:
  OT::Distribution object_;
  double mean_;
  double standard_deviation_;
  double lower_;
  double upper_;
};

/// The family's object for a specification that has passed the checks common to all families.
/// Throws InvalidInput for what is particular to the family.
std::shared_ptr<const Distribution::Implementation> make_distribution_family(const DistributionSpec& spec);

}  // namespace mottle::stats
