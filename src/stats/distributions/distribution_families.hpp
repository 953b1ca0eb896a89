// Behind Distribution: one class a family. All of them keep their digits in both tails.
#pragma once

#include <memory>

#include "mottle/layers.hpp"
#include "mottle/stats/distributions/distribution.hpp"

namespace mottle::stats {

class Distribution::Implementation {
 public:
  /// What is known before a family's shape: the variable's own moments, and the ends of its support.
  struct Frame {
    double mean;
    double standard_deviation;
    double lower;
    double upper;
  };

  explicit Implementation(const Frame& frame) : frame_(frame) {}
  virtual ~Implementation() = default;

  double mean() const { return frame_.mean; }
  double standard_deviation() const { return frame_.standard_deviation; }
  double lower() const { return frame_.lower; }
  double upper() const { return frame_.upper; }
  double cdf(double value) const;
  /// 0 outside the support and at its lower end.
  double pdf(double value) const;

  /// Value with P(X <= x) = probability, for probability in (0, 1/2].
  virtual double lower_tail_quantile(double probability) const = 0;
  /// Value with P(X > x) = probability, for probability in (0, 1/2].
  virtual double upper_tail_quantile(double probability) const = 0;
  /// Families with a shorter way than two special functions override this.
  virtual double from_standard_normal(double z) const;

 protected:
  /// Of a value in the support, whose lower end is left out.
  virtual double cdf_inside(double value) const = 0;
  virtual double pdf_inside(double value) const = 0;

 private:
  Frame frame_;
};

/// The family's object for a specification that has passed the checks common to all families.
/// Throws InvalidInput for what is particular to the family.
std::shared_ptr<const Distribution::Implementation> make_distribution_family(const DistributionSpec& spec);

}  // namespace mottle::stats
