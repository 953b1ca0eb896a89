#include "mottle/stats/population/mixture_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/parallel.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/moments/covariance_axes.hpp"
#include "stats/population/mixture_starts.hpp"

namespace mottle::stats {
namespace {

constexpr double k_near_enough = 1e-3;  // change of the likelihood in a step at which a likelihood ratio rests
constexpr int k_most_steps = 200;
constexpr int k_first_steps = 10;  // of every start; the best go on
constexpr int k_polished = 2;
constexpr int k_splits = 4;

bool has_batches(const MixtureFit& fit) {
  constexpr double k_rounding = 0.5;
  for (std::size_t k = 0; k < fit.components.size(); ++k) {
    if (fit.size_of(static_cast<Eigen::Index>(k)) < k_smallest_batch - k_rounding) return false;
  }
  return true;
}

std::optional<MixtureFit> best_of(const MixtureData& data, const std::vector<Eigen::MatrixXd>& starts,
                                  const MixtureSettings& settings) {
  MixtureSettings first = settings;
  first.iterations = k_first_steps;
  std::vector<MixtureFit> begun;
  for (const Eigen::MatrixXd& start : starts) {
    if (auto fit = fit_mixture(data, start, first)) begun.push_back(*std::move(fit));
  }
  std::stable_sort(begun.begin(), begun.end(),
                   [](const MixtureFit& a, const MixtureFit& b) { return a.log_likelihood > b.log_likelihood; });
  std::optional<MixtureFit> best;
  int polished = 0;
  for (const MixtureFit& fit : begun) {
    if (polished == k_polished) break;
    auto whole = fit_mixture(data, fit, settings);
    if (!whole || !has_batches(*whole)) continue;
    ++polished;
    if (!best || whole->log_likelihood > best->log_likelihood) best = std::move(whole);
  }
  return best;
}

MixtureSettings coarse(MixtureSettings settings) {
  settings.tolerance = k_near_enough;
  settings.iterations = k_most_steps;
  return settings;
}

/// Fits with K and K + 1 components to one set of units.
struct Pair {
  std::optional<MixtureFit> fewer;
  std::optional<MixtureFit> more;

  double statistic() const {
    return fewer && more ? std::max(2.0 * (more->log_likelihood - fewer->log_likelihood), 0.0) : 0.0;
  }
};

/// K components found as in the data: from 1 on, each from the fit before it.
Pair find_pair(const MixtureData& data, int components, const MixtureSearch& search, const StreamKey& key) {
  const MixtureSettings settings = coarse(search.settings_for(data));
  Pair pair;
  for (int k = 1; k <= components + 1; ++k) {
    pair.fewer = std::move(pair.more);
    pair.more = find_mixture(data, k, pair.fewer ? &*pair.fewer : nullptr, settings, search.starts, key);
  }
  return pair;
}

/// The outliers' population with as many of them as a fit names: a few that it only thinks possible, drawn into a
/// twentieth of the samples, would be the tail that a test of 5 % looks at.
OutlierPopulation named_outliers(OutlierPopulation outliers, const MixtureFit& fit) {
  constexpr double k_named = 0.5;
  const auto named = static_cast<double>((fit.probabilities.rightCols(1).array() > k_named).count());
  if (outliers.fraction > 0.0) outliers.fraction = named / static_cast<double>(fit.probabilities.rows());
  return outliers;
}

StreamKey key_of(const RunContext& context, StreamPurpose purpose, int kind, int sample) {
  constexpr int k_samples = 1 << 20;
  return {.seed = context.seed, .purpose = purpose, .iteration = static_cast<std::uint32_t>(kind * k_samples + sample)};
}

/// Statistics of drawn samples first .. last - 1.
std::vector<double> null_statistics(const MixtureData& data, const MixtureFit& null, const MixtureSearch& search,
                                    const OutlierPopulation& outliers, int first, int last, const RunContext& context) {
  std::vector<double> statistics(static_cast<std::size_t>(last - first));
  const auto components = static_cast<int>(null.components.size());
  parallel_for(last - first, 1, context.threads, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      context.throw_if_stopped();
      const int sample = first + static_cast<int>(i);
      const MixtureData drawn =
          draw_units(data, null.components, outliers, key_of(context, StreamPurpose::mixture_test, components, sample));
      statistics[static_cast<std::size_t>(i)] =
          find_pair(drawn, components, search, key_of(context, StreamPurpose::mixture_start, components, sample + 1))
              .statistic();
    }
  });
  return statistics;
}

ComponentsTest test_components(const MixtureData& data, const MixtureFit& null, double statistic,
                               const MixtureSearch& search, const OutlierPopulation& outliers,
                               const RunContext& context) {
  constexpr int k_batch = 40;
  ComponentsTest test{.components = static_cast<int>(null.components.size()),
                      .statistic = statistic,
                      .critical = std::numeric_limits<double>::quiet_NaN()};
  // Refused where fewer samples than this are as large.
  const int allowed = static_cast<int>(std::floor(search.level * (search.samples + 1)));
  std::vector<double> drawn;
  int larger = 0;
  for (int first = 0; first < search.samples; first += k_batch) {
    const int last = std::min(first + k_batch, search.samples);
    for (const double value : null_statistics(data, null, search, outliers, first, last, context)) {
      drawn.push_back(value);
      larger += value >= statistic ? 1 : 0;
    }
    if (test.components > 1 && larger >= allowed) break;
    context.progress("samples", last, search.samples);
  }
  test.samples = static_cast<int>(drawn.size());
  test.p_value = (1.0 + larger) / (1.0 + test.samples);
  test.is_refused = larger < allowed;
  if (test.samples == search.samples && allowed > 0) {
    std::nth_element(drawn.begin(), drawn.end() - allowed, drawn.end());
    test.critical = *(drawn.end() - allowed);
  }
  return test;
}

}  // namespace

MixtureSettings MixtureSearch::settings_for(const MixtureData& data) const {
  MixtureSettings own = settings;
  own.outliers = outlier_fraction > 0.0 ? outlier_population(data, outlier_fraction, outlier_width, coarse(settings))
                                        : OutlierPopulation{};
  return own;
}

int fewest_units(int components, Eigen::Index together) {
  return std::max(components * k_smallest_batch, components + static_cast<int>(together) + 1);
}

std::optional<MixtureFit> find_mixture(const MixtureData& data, int components, const MixtureFit* fewer,
                                       const MixtureSettings& settings, int starts, const StreamKey& key) {
  const Eigen::Index q = data.effects();
  const Eigen::MatrixXd points = held_points(data, Eigen::VectorXd::Zero(q), Eigen::MatrixXd::Identity(q, q));
  if (components == 1) return best_of(data, whole_starts(points), settings);
  std::vector<Eigen::MatrixXd> from;
  if (fewer != nullptr) from = split_starts(points, *fewer, k_splits, key);
  for (Eigen::MatrixXd& start : random_starts(points, components, starts, key)) from.push_back(std::move(start));
  return best_of(data, from, settings);
}

MixtureData draw_units(const MixtureData& like, const std::vector<MixtureComponent>& components,
                       const OutlierPopulation& outliers, const StreamKey& key) {
  std::vector<Eigen::MatrixXd> roots;
  for (const MixtureComponent& own : components) roots.push_back(CovarianceAxes(own.covariance).symmetric_root());
  std::vector<Eigen::MatrixXd> noises;
  for (const MixtureDesign& design : like.designs) {
    noises.push_back(CovarianceAxes(design.noise, Eigen::VectorXd::Ones(design.noise.rows())).symmetric_root());
  }
  const Eigen::MatrixXd outlier_root =
      outliers.fraction > 0.0 ? CovarianceAxes(outliers.covariance).symmetric_root() : Eigen::MatrixXd();
  const auto normals = [](RandomStream& stream, Eigen::Index count) {
    Eigen::VectorXd z(count);
    for (double& value : z) value = standard_normal_quantile(stream.uniform());
    return z;
  };
  MixtureData drawn = like;
  const Eigen::Index q = like.effects();
  for (std::size_t s = 0; s < like.size(); ++s) {
    RandomStream stream(key, static_cast<std::uint32_t>(s));
    double place = stream.uniform();
    const Eigen::VectorXd z = normals(stream, q);
    Eigen::VectorXd effects;
    if (place < outliers.fraction) {
      effects = outliers.mean + outlier_root * z;
    } else {
      place = (place - outliers.fraction) / (1.0 - outliers.fraction);
      std::size_t k = 0;
      while (k + 1 < components.size() && place > components[k].weight) place -= components[k++].weight;
      effects = components[k].mean + roots[k] * z;
    }
    const MixtureDesign& design = like.design(s);
    drawn.responses[s] = design.design * effects + noises[like.design_of[s]] * normals(stream, design.noise.rows());
  }
  return drawn;
}

MixtureChoice choose_mixture(const MixtureData& data, const MixtureSearch& search, const RunContext& context) {
  const MixtureSettings settings = coarse(search.settings_for(data));
  const StreamKey key = key_of(context, StreamPurpose::mixture_start, 0, 0);
  MixtureChoice choice;
  std::optional<MixtureFit> fewer = find_mixture(data, 1, nullptr, settings, search.starts, key);
  require(fewer.has_value(), "mixture: the units' scatter is singular");
  choice.fit = *fewer;
  for (int k = 1; k < search.most; ++k) {
    context.phase(
        {.name = "test of the number of batches", .step = k, .steps = search.most - 1, .may_end_early = true});
    std::optional<MixtureFit> more = find_mixture(data, k + 1, &choice.fit, settings, search.starts, key);
    const double statistic = more ? std::max(2.0 * (more->log_likelihood - choice.fit.log_likelihood), 0.0) : 0.0;
    choice.tests.push_back(
        test_components(data, choice.fit, statistic, search, named_outliers(settings.outliers, choice.fit), context));
    if (!more || !choice.tests.back().is_refused) break;
    choice.fit = *std::move(more);
  }
  return choice;
}

std::vector<MixtureFit> redrawn_fits(const MixtureData& data, const MixtureFit& fit, const MixtureSearch& search,
                                     const RunContext& context) {
  const OutlierPopulation outliers = named_outliers(search.settings_for(data).outliers, fit);
  std::vector<std::optional<MixtureFit>> fits(static_cast<std::size_t>(search.samples));
  parallel_for(search.samples, 1, context.threads, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      context.throw_if_stopped();
      const MixtureData drawn = draw_units(data, fit.components, outliers,
                                           key_of(context, StreamPurpose::mixture_intervals, 0, static_cast<int>(i)));
      auto again = fit_mixture(drawn, fit, coarse(search.settings_for(drawn)));
      if (again && has_batches(*again)) fits[static_cast<std::size_t>(i)] = std::move(again);
    }
  });
  std::vector<MixtureFit> kept;
  for (auto& own : fits) {
    if (own) kept.push_back(*std::move(own));
  }
  return kept;
}

std::optional<double> detectable_distance(const MixtureData& data, const Eigen::MatrixXd& within, double critical,
                                          const MixtureSearch& search, int samples, const RunContext& context) {
  constexpr double k_power = 0.8;
  constexpr double k_farthest = 20.0;
  constexpr double k_resolution = 0.05;
  // A batch with the noise of the units that determine their effects; of none, without.
  Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(within.rows(), within.cols());
  double determined = 0.0;
  for (std::size_t s = 0; s < data.size(); ++s) {
    if (data.design(s).design.rows() < within.rows()) continue;
    noise += data.design(s).noise;
    determined += 1.0;
  }
  const CovarianceAxes axes(within + noise / std::max(determined, 1.0));
  const Eigen::VectorXd step = axes.symmetric_root().col(0);
  const auto is_found = [&](double distance, int sample) {
    const Eigen::VectorXd shift = 0.5 * distance * step;
    const std::vector<MixtureComponent> truth{{0.5, -shift, within}, {0.5, shift, within}};
    MixtureData drawn = draw_units(data, {{1.0, Eigen::VectorXd::Zero(shift.size()), within}}, {},
                                   key_of(context, StreamPurpose::mixture_power, 0, sample));
    for (std::size_t s = 0; s < drawn.size(); ++s) {
      drawn.responses[s] += (s % 2 == 0 ? 1.0 : -1.0) * (drawn.design(s).design * shift);
    }
    const MixtureSettings settings = coarse(search.settings_for(drawn));
    const StreamKey key = key_of(context, StreamPurpose::mixture_power, 1, sample);
    const auto fewer = find_mixture(drawn, 1, nullptr, settings, 0, key);
    if (!fewer) return false;
    const auto exceeds = [&](const std::optional<MixtureFit>& more) {
      return more && has_batches(*more) && 2.0 * (more->log_likelihood - fewer->log_likelihood) > critical;
    };
    MixtureFit from;
    from.components = truth;
    return exceeds(fit_mixture(drawn, from, settings)) || exceeds(find_mixture(drawn, 2, &*fewer, settings, 0, key));
  };
  const auto power = [&](double distance) {
    std::vector<char> found(static_cast<std::size_t>(samples), 0);
    parallel_for(samples, 1, context.threads, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) {
        context.throw_if_stopped();
        found[static_cast<std::size_t>(i)] = is_found(distance, static_cast<int>(i)) ? 1 : 0;
      }
    });
    return static_cast<double>(std::count(found.begin(), found.end(), 1)) / samples;
  };
  double low = 0.0;
  double high = 2.5;
  while (power(high) < k_power) {
    low = high;
    high *= 1.5;
    if (high > k_farthest) return std::nullopt;
  }
  while (high - low > k_resolution) {
    const double middle = 0.5 * (low + high);
    (power(middle) < k_power ? low : high) = middle;
  }
  return high;
}

}  // namespace mottle::stats
