#include "mottle/stats/tests/outliers.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <numeric>
#include <utility>

#include "mottle/core/process_mutex.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "stats/distributions/standard_normals.hpp"
#include "stats/tests/forward_search.hpp"

namespace mottle::stats {
namespace {

constexpr Eigen::Index k_largest_group = 10;  // more of them are a population of their own

/// Largest number of suspects: the core must determine mean and covariance.
Eigen::Index max_suspects(Eigen::Index specimens, double complete, Eigen::Index effects) {
  const double needed = static_cast<double>(effects + 2) / std::max(complete, 1e-9);
  const auto spared = static_cast<Eigen::Index>(std::floor(static_cast<double>(specimens) * (1.0 - needed) + 1e-9));
  return std::max<Eigen::Index>(std::min({specimens / 3, k_largest_group, spared}), 0);
}

/// All divisions of a sample: in all effects together, and by each column of `along` [specimen x axis].
template <class Sample>
std::vector<ForwardStep> all_steps(const Sample& sample, const Eigen::MatrixXd& along) {
  const Eigen::Index effects = sample.effects();
  const Eigen::Index max_suspect_count = max_suspects(sample.size(), sample.complete_specimens(), effects);
  std::vector<ForwardStep> steps;
  if (max_suspect_count > 0) steps = forward_search(sample, max_suspect_count);
  if (effects < 2) return steps;
  const Eigen::Index max_along = max_suspects(sample.size(), static_cast<double>(sample.size()), 1);
  for (const auto& column : along.colwise()) {
    for (ForwardStep& step : line_search(column, max_along)) steps.push_back(std::move(step));
  }
  return steps;
}

/// t of all divisions.
Eigen::RowVectorXd evidence_of(const std::vector<ForwardStep>& steps) {
  constexpr double k_min = 1e-3;
  Eigen::RowVectorXd evidence(static_cast<Eigen::Index>(steps.size()));
  for (std::size_t k = 0; k < steps.size(); ++k) {
    evidence(static_cast<Eigen::Index>(k)) = std::log(std::max(steps[k].evidence, k_min));
  }
  return evidence;
}

/// The suspects with the largest evidence, and its p-value.
struct Group {
  std::vector<Eigen::Index> suspects;
  double p_value = 1.0;
  bool is_beyond = false;  ///< more than any simulated sample shows
};

/// @param rows  t of samples without outliers [sample x division]
Group judge_steps(const std::vector<ForwardStep>& steps, const Eigen::MatrixXd& rows) {
  const Eigen::RowVectorXd mean = rows.colwise().mean();
  const Eigen::MatrixXd centred = rows.rowwise() - mean;
  const Eigen::RowVectorXd standard_deviation =
      (centred.colwise().squaredNorm() / static_cast<double>(rows.rows())).cwiseMax(1e-30).cwiseSqrt();
  const Eigen::VectorXd largest = (centred * standard_deviation.cwiseInverse().asDiagonal()).rowwise().maxCoeff();
  Eigen::Index step = 0;
  const double seen = (evidence_of(steps) - mean).cwiseQuotient(standard_deviation).maxCoeff(&step);
  const auto above = static_cast<double>((largest.array() >= seen).count());
  return {steps[static_cast<std::size_t>(step)].suspects, (above + 1.0) / static_cast<double>(rows.rows() + 1),
          above == 0.0};
}

/// Simulates until the p-value is surely above the level, or `last` samples are drawn. Source: [Besag1991].
///
/// @param rows  t of the samples so far; more are added
/// @param level  significance level of the test
/// @param last  samples at most
/// @param draw  t of one more sample, by its number
Group judge_by_simulation(const std::vector<ForwardStep>& steps, Eigen::MatrixXd& rows, double level, Eigen::Index last,
                          const std::function<Eigen::RowVectorXd(Eigen::Index)>& draw) {
  struct Stage {
    Eigen::Index samples;
    double enough;  // p-value above which 5 % is out of reach, but for one in a hundred
  };
  if (steps.empty()) return {};
  Group group;
  for (const Stage& stage : {Stage{19, 0.35}, Stage{49, 0.2}, Stage{99, 0.14}, Stage{249, 0.09}, Stage{last, 0.0}}) {
    const Eigen::Index done = rows.rows();
    if (done < stage.samples) {
      rows.conservativeResize(stage.samples, static_cast<Eigen::Index>(steps.size()));
      for (Eigen::Index r = done; r < stage.samples; ++r) rows.row(r) = draw(r);
    }
    group = judge_steps(steps, rows.topRows(stage.samples));
    if (group.p_value > stage.enough * std::max(level / 0.05, 1.0)) break;
  }
  return group;
}

/// The reference of complete samples depends on their size alone: it is kept.
Group find_group(const CompleteSample& sample, const Eigen::MatrixXd& axes, double level) {
  static constinit ProcessMutex mutex;
  static std::map<std::array<Eigen::Index, 3>, Eigen::MatrixXd> kept;
  const Eigen::Index specimens = sample.size();
  const Eigen::Index effects = sample.effects();
  const std::vector<ForwardStep> steps = all_steps(sample, sample.along(axes));
  const std::lock_guard lock(mutex);
  Eigen::MatrixXd& rows = kept[{specimens, effects, axes.rows()}];
  return judge_by_simulation(steps, rows, level, 999, [&](Eigen::Index r) {
    // Axes count as uncorrelated, more of them than effects too: the most that chance can show.
    const Eigen::Index columns = std::max(effects, axes.rows());
    const Eigen::MatrixXd drawn =
        standard_normals(specimens * columns, k_outlier_stream, r).reshaped(specimens, columns);
    return evidence_of(all_steps(CompleteSample(drawn.leftCols(effects)), drawn.leftCols(axes.rows())));
  });
}

/// Draws of specimens from N(0, 1) with their own designs and noise.
class PartialDraws {
 public:
  explicit PartialDraws(const std::vector<EffectEvidence>& specimens) : specimens_(specimens) {
    for (const EffectEvidence& own : specimens) {
      const SymmetricEigen solver(own.noise);
      roots_.emplace_back(solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal());
      normals_ += own.design.cols() + own.noise.cols();
    }
  }

  std::vector<EffectEvidence> draw(Eigen::Index replicate) const {
    const Eigen::VectorXd normals = standard_normals(normals_, k_partial_outlier_stream, replicate);
    std::vector<EffectEvidence> drawn = specimens_;
    Eigen::Index used = 0;
    const auto next = [&](Eigen::Index count) { return normals.segment(std::exchange(used, used + count), count); };
    for (std::size_t s = 0; s < drawn.size(); ++s) {
      drawn[s].response = drawn[s].design * next(drawn[s].design.cols());
      drawn[s].response += roots_[s] * next(roots_[s].cols());
    }
    return drawn;
  }

 private:
  const std::vector<EffectEvidence>& specimens_;
  std::vector<Eigen::MatrixXd> roots_;
  Eigen::Index normals_ = 0;
};

Group find_group(const std::vector<EffectEvidence>& specimens, const Eigen::MatrixXd& axes, double shrinkage,
                 double level) {
  const PartialDraws draws(specimens);
  Eigen::MatrixXd rows;
  const auto steps_of = [&](std::vector<EffectEvidence> sample) {
    const PartialSample partial(std::move(sample), shrinkage);
    return all_steps(partial, partial.along(axes));
  };
  return judge_by_simulation(steps_of(specimens), rows, level, 499,
                             [&](Eigen::Index r) { return evidence_of(steps_of(draws.draw(r))); });
}

/// Distances of the outliers from all others, the farthest first.
template <class Sample>
std::vector<Outlier> describe(const Sample& sample, const std::vector<Group>& groups,
                              const std::vector<Eigen::Index>& core) {
  const typename Sample::Estimate estimate = sample.estimate(core, nullptr);
  std::vector<Outlier> outliers;
  for (const Group& group : groups) {
    for (const Eigen::Index s : group.suspects) {
      const DeletedDistance deleted = sample.deleted(s, estimate);
      // Where no simulated sample is as extreme: the p-value of the distance itself, for all specimens (Bonferroni).
      const double own = static_cast<double>(core.size() + 1) * std::exp(-deleted.evidence);
      outliers.push_back({s, deleted.distance, group.is_beyond ? std::min(group.p_value, own) : group.p_value});
    }
  }
  std::stable_sort(outliers.begin(), outliers.end(),
                   [](const Outlier& a, const Outlier& b) { return a.distance > b.distance; });
  return outliers;
}

/// Takes groups out of all specimens while there are any.
std::vector<Group> take_groups(Eigen::Index specimens, double level, std::vector<Eigen::Index>& left,
                               const std::function<Group(const std::vector<Eigen::Index>&)>& find) {
  left.resize(static_cast<std::size_t>(specimens));
  std::iota(left.begin(), left.end(), Eigen::Index{0});
  std::vector<Group> groups;
  while (3 * (specimens - static_cast<Eigen::Index>(left.size()) + 1) <= specimens) {
    Group group = find(left);
    if (group.suspects.empty() || group.p_value > level) break;
    for (Eigen::Index& s : group.suspects) s = left[static_cast<std::size_t>(s)];
    for (const Eigen::Index s : group.suspects) left.erase(std::find(left.begin(), left.end(), s));
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace

std::vector<Outlier> find_outliers(const Eigen::Ref<const Eigen::MatrixXd>& samples, double level) {
  if (samples.rows() < 2) return {};
  const auto scattered = [](const Eigen::MatrixXd& chosen, const ScatterRoot& scatter) {
    return CompleteSample(chosen * scatter.inverse.transpose());
  };
  std::vector<Eigen::Index> left;
  const std::vector<Group> groups =
      take_groups(samples.rows(), level, left, [&](const std::vector<Eigen::Index>& rows) {
        const Eigen::MatrixXd chosen = samples(rows, Eigen::all);
        const ScatterRoot scatter = scatter_root(sample_covariance(chosen));
        return scatter.root.cols() == 0 ? Group{} : find_group(scattered(chosen, scatter), scatter.root, level);
      });
  if (groups.empty()) return {};
  return describe(scattered(samples, scatter_root(sample_covariance(samples))), groups, left);
}

std::vector<Outlier> find_outliers(const std::vector<RandomEffectsUnit>& units, const RandomEffectsFit& fit,
                                   const RandomEffectsSettings& settings, const Eigen::Ref<const Eigen::MatrixXd>& map,
                                   double level) {
  constexpr double k_likeness = 0.2;
  std::vector<Eigen::Index> left;
  const std::vector<Group> groups =
      take_groups(static_cast<Eigen::Index>(units.size()), level, left, [&](const std::vector<Eigen::Index>& rows) {
        std::vector<RandomEffectsUnit> chosen;
        for (const Eigen::Index s : rows) chosen.push_back(units[static_cast<std::size_t>(s)]);
        const bool is_whole = chosen.size() == units.size();
        const WhitenedEffects effects =
            whiten_effects(chosen, is_whole ? fit : fit_random_effects(chosen, fit.covariance, settings));
        if (effects.root.cols() == 0) return Group{};
        const Eigen::MatrixXd axes = map * effects.root;
        if (const auto own = alike_estimates(effects, k_likeness)) return find_group(CompleteSample(*own), axes, level);
        return find_group(effects.specimens, axes, settings.shrinkage, level);
      });
  if (groups.empty()) return {};
  const WhitenedEffects effects = whiten_effects(units, fit);
  if (const auto own = alike_estimates(effects, k_likeness)) return describe(CompleteSample(*own), groups, left);
  return describe(PartialSample(effects.specimens, settings.shrinkage), groups, left);
}

}  // namespace mottle::stats
