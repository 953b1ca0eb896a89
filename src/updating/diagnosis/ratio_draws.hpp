// Replications of a likelihood ratio: how probable the observed one is, and whether more of them could change an
// answer.
#pragma once

#include <cstddef>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::updating {

/// Draws of a likelihood ratio where no candidate is missing.
class RatioDraws {
 public:
  /// @param draws  at least 20, finite
  explicit RatioDraws(std::vector<double> draws);

  /// Probability of a ratio of at least `observed`: up to a tail of 10 % the fraction of draws beyond it, further out
  ///
  ///   p = 0.1 exp( -(x - x90) / m ),     m the mean excess of the draws over x90
  ///
  /// Source: [Davison1997], ch. 4.
  double upper_tail(double observed) const;

  /// Whether that probability is below `least` or above `most` with hardly a doubt, so that further draws may be saved:
  /// the answer is wrong in about one of 1,000 cases in which the true probability is just on the other side.
  ///
  /// Below `least`: the sum of n exponential excesses is m chi-squared(2 n) / 2, whose lower limit bounds m, and the
  /// tail is taken to begin at the largest draw. Above `most`: by the lower limit of the frequency.
  bool decide(double observed, double least, double most) const;

 private:
  double count() const { return static_cast<double>(draws_.size()); }
  double border() const { return draws_[draws_.size() - excesses_ - 1]; }
  double beyond(double observed) const;

  std::vector<double> draws_;  // ascending
  std::size_t excesses_ = 0;
  double mean_excess_ = 0.0;
};

}  // namespace mottle::updating
