// Forward search: orders the specimens of a sample outwards from a core of least scatter, so that outliers cannot mask
// one another. For complete samples and for samples with noise; the test itself is in outliers.cpp.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "stats/population/effect_evidence.hpp"

namespace mottle::stats {

/// How far a specimen lies from a core that it is not part of.
struct DeletedDistance {
  double distance = 0.0;  ///< in standard deviations of a new specimen of the core's population
  double evidence = 0.0;  ///< -ln of the probability of a larger one
};

/// Specimens whose effects are known, each with the same covariance.
class CompleteSample {
 public:
  struct Estimate {
    Eigen::VectorXd mean;
    CholeskyFactor factor;  ///< of the covariance
    double count = 0.0;
  };

  /// @param points  [specimen x effect]
  explicit CompleteSample(const Eigen::Ref<const Eigen::MatrixXd>& points)
      : points_(points), columns_(points.transpose()) {}

  Eigen::Index size() const { return points_.rows(); }
  Eigen::Index effects() const { return points_.cols(); }
  double complete_specimens() const { return static_cast<double>(size()); }
  /// Combinations of effects, one a row of `axes` [specimen x axis].
  Eigen::MatrixXd along(const Eigen::Ref<const Eigen::MatrixXd>& axes) const { return points_ * axes.transpose(); }
  const Eigen::MatrixXd& points() const { return points_; }
  Estimate estimate(const std::vector<Eigen::Index>& core, const Estimate* near) const;
  /// Ascending with the distance from the core [specimen].
  Eigen::VectorXd ranking(const Estimate& estimate) const;
  DeletedDistance deleted(Eigen::Index specimen, const Estimate& estimate) const;

 private:
  Eigen::MatrixXd points_;
  Eigen::MatrixXd columns_;
};

/// Specimens that are known in part or with noise, each with its own covariance A Sigma A' + noise.
class PartialSample {
 public:
  struct Estimate {
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
    Eigen::MatrixXd mean_variance;
    double count = 0.0;  ///< complete specimens that have as many rows as the core
  };

  /// @param shrinkage  weight, in specimens, of a prior towards uncorrelated effects
  PartialSample(std::vector<EffectEvidence> specimens, double shrinkage);

  Eigen::Index size() const { return static_cast<Eigen::Index>(specimens_.size()); }
  Eigen::Index effects() const { return specimens_.front().design.cols(); }
  /// Complete specimens that would have as many rows.
  double complete_specimens() const;
  /// E[axis x | y] in its own standard deviations [specimen x axis].
  Eigen::MatrixXd along(const Eigen::Ref<const Eigen::MatrixXd>& axes) const;
  /// E[x | y] at the population of all specimens [specimen x effect].
  const Eigen::MatrixXd& points() const { return effects_.points; }
  Estimate estimate(const std::vector<Eigen::Index>& core, const Estimate* near) const;
  Eigen::VectorXd ranking(const Estimate& estimate) const;
  DeletedDistance deleted(Eigen::Index specimen, const Estimate& estimate) const;

 private:
  struct Sums;
  Sums pass(const std::vector<Eigen::Index>& core, const Eigen::MatrixXd& covariance) const;

  std::vector<EffectEvidence> specimens_;
  double shrinkage_;
  ShrunkenEffects effects_;
};

/// A division into core and suspects.
struct ForwardStep {
  std::vector<Eigen::Index> suspects;  ///< nearest first
  double evidence = 0.0;               ///< of the nearest suspect, as in DeletedDistance
};

/// The core without the `suspects` specimens whose absence leaves the least scatter, two at a time (two that lie
/// together hide each other).
///
/// @param points  [specimen x effect]
std::vector<Eigen::Index> core_without_pairs(const Eigen::Ref<const Eigen::MatrixXd>& points, Eigen::Index suspects);

/// The `count` specimens that rank lowest.
std::vector<Eigen::Index> nearest_specimens(const Eigen::VectorXd& ranking, Eigen::Index count);

/// The steps of numbers: each core is the window of the ordered values that scatters least.
std::vector<ForwardStep> line_search(const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index max_suspects);

/// Forward search: from the core without `max_suspects` suspects, concentrated until it keeps its members, specimens
/// join in the order of their distance.
///
/// @return  the step with k suspects at index k - 1
/// Source: [Wilks1963] for pairs, [Rousseeuw1999] for the concentration, [Riani2009] for the search.
template <class Sample>
std::vector<ForwardStep> forward_search(const Sample& sample, Eigen::Index max_suspects) {
  constexpr int k_concentrations = 5;
  const Eigen::Index size = sample.size();
  std::vector<Eigen::Index> core = core_without_pairs(sample.points(), max_suspects);
  typename Sample::Estimate estimate = sample.estimate(core, nullptr);
  for (int step = 0; step < k_concentrations; ++step) {
    std::vector<Eigen::Index> next = nearest_specimens(sample.ranking(estimate), size - max_suspects);
    if (next == core) break;
    core = std::move(next);
    estimate = sample.estimate(core, &estimate);
  }
  std::vector<ForwardStep> steps(static_cast<std::size_t>(max_suspects));
  for (Eigen::Index suspects = max_suspects; suspects > 0; --suspects) {
    const Eigen::VectorXd ranking = sample.ranking(estimate);
    ForwardStep& step = steps[static_cast<std::size_t>(suspects - 1)];
    std::vector<bool> is_core(static_cast<std::size_t>(size), false);
    for (const Eigen::Index s : core) is_core[static_cast<std::size_t>(s)] = true;
    for (Eigen::Index s = 0; s < size; ++s) {
      if (!is_core[static_cast<std::size_t>(s)]) step.suspects.push_back(s);
    }
    std::stable_sort(step.suspects.begin(), step.suspects.end(),
                     [&](Eigen::Index a, Eigen::Index b) { return ranking(a) < ranking(b); });
    step.evidence = sample.deleted(step.suspects.front(), estimate).evidence;
    if (suspects == 1) break;
    core = nearest_specimens(ranking, size - suspects + 1);
    estimate = sample.estimate(core, &estimate);
  }
  return steps;
}

}  // namespace mottle::stats
