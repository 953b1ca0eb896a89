// Held-out tests against a prediction.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mottle/core/text.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/tests/binomial_range.hpp"
#include "updating/prediction/prediction_draws.hpp"

namespace mottle::updating {
namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

/// P(D >= d) of Kolmogorov's statistic with an effective number of values.
double kolmogorov_p(double d, double number) {
  const double root = std::sqrt(number);
  const double lambda = (root + 0.12 + 0.11 / root) * d;
  if (lambda < 0.2) return 1.0;
  double sum = 0.0;
  for (int j = 1; j <= 100; ++j) sum += (j % 2 == 1 ? 2.0 : -2.0) * std::exp(-2.0 * j * j * lambda * lambda);
  return std::clamp(sum, 0.0, 1.0);
}

/// p-value of values in (0, 1) being uniform.
double uniformity_p(std::vector<double> values, Eigen::Index estimated_from) {
  if (values.size() < 2) return k_nan;
  std::sort(values.begin(), values.end());
  const auto m = static_cast<double>(values.size());
  double d = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    d = std::max({d, values[i] - static_cast<double>(i) / m, static_cast<double>(i + 1) / m - values[i]});
  }
  const auto n = static_cast<double>(estimated_from);
  return kolmogorov_p(d, estimated_from > 0 ? m * n / (m + n) : m);
}

double smallest_after_holm(const Eigen::VectorXd& p) {
  double smallest = 1.0;
  double count = 0.0;
  for (const double value : p) {
    if (std::isnan(value)) continue;
    smallest = std::min(smallest, value);
    count += 1.0;
  }
  return count > 0.0 ? std::min(smallest * count, 1.0) : k_nan;
}

/// About ten transforms a part, four to ten parts.
HeldOutCheck::Histogram histogram_of(const std::vector<double>& transforms) {
  constexpr std::size_t k_to_a_part = 8;
  constexpr double k_level = 0.95;
  const std::size_t parts = std::clamp<std::size_t>(transforms.size() / k_to_a_part, 4, 10);
  HeldOutCheck::Histogram histogram{std::vector<int>(parts, 0)};
  for (const double u : transforms) {
    const double place = std::clamp(u * static_cast<double>(parts), 0.0, static_cast<double>(parts - 1));
    ++histogram.counts[static_cast<std::size_t>(place)];
  }
  const CountRange range =
      binomial_range(static_cast<int>(transforms.size()), 1.0 / static_cast<double>(parts), k_level);
  histogram.fewest = range.min_successes;
  histogram.most = range.max_successes;
  return histogram;
}

/// Of tests of which 95 % should lie inside.
int min_inside(int tests) {
  constexpr double k_inside = 0.95;
  constexpr double k_level = 0.99;
  return binomial_range(tests, k_inside, k_level).min_successes;
}

std::string percent(double part) {
  return fmt::format("{:.0f} %", 100.0 * part);
}

}  // namespace

HeldOutCheck check_held_out(const Prediction& prediction, const Estimate& estimate,
                            const Eigen::Ref<const Eigen::MatrixXd>& values) {
  const Eigen::Index p = values.cols();
  HeldOutCheck check;
  check.coverage = Eigen::VectorXd::Constant(p, k_nan);
  check.uniformity = Eigen::VectorXd::Constant(p, k_nan);
  check.transforms = Eigen::MatrixXd::Constant(values.rows(), p, k_nan);
  check.min_inside.resize(p);
  for (Eigen::Index k = 0; k < p; ++k) {
    Eigen::VectorXd sorted = prediction.draws.col(k);
    std::sort(sorted.begin(), sorted.end());
    std::vector<double> transforms;
    double inside = 0.0;
    for (Eigen::Index s = 0; s < values.rows(); ++s) {
      const double value = values(s, k);
      if (std::isnan(value)) continue;
      const auto below = static_cast<double>(std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin());
      check.transforms(s, k) = (below + 0.5) / (static_cast<double>(sorted.size()) + 1.0);
      transforms.push_back(check.transforms(s, k));
      if (value >= prediction.interval(k, 0) && value <= prediction.interval(k, 1)) inside += 1.0;
    }
    if (!transforms.empty()) check.coverage(k) = inside / static_cast<double>(transforms.size());
    check.min_inside(k) = min_inside(static_cast<int>(transforms.size()));
    check.histograms.push_back(histogram_of(transforms));
    check.uniformity(k) = uniformity_p(std::move(transforms), estimate.specimens());
  }
  check.scores = check.transforms.unaryExpr([](double u) { return std::isnan(u) ? u : standard_normal_quantile(u); });
  check.adjusted_p = smallest_after_holm(check.uniformity);
  check.distances = squared_distances(prediction, values);
  const auto complete = (!check.distances.array().isNaN()).count();
  const auto inside = (check.distances.array() <= prediction.joint_critical).count();
  const bool has_region = complete > 0 && !std::isnan(prediction.joint_critical);
  check.joint_coverage = has_region ? static_cast<double>(inside) / static_cast<double>(complete) : k_nan;
  return check;
}

std::vector<std::string> prediction_sentences(const Prediction& prediction, const HeldOutCheck* check,
                                              const Estimate& estimate, const std::vector<Quantity>& outputs,
                                              double level) {
  std::vector<std::string> sentences;
  const std::string inside = percent(1.0 - level);
  if (const std::string note = estimate.prediction_note(); !note.empty()) {
    sentences.push_back(note);
  } else if (std::isnan(prediction.joint_critical)) {
    sentences.push_back(fmt::format("Prediction: {} specimens are too few for a joint region of {} parameters.",
                                    estimate.specimens(), estimate.parameter_count()));
  }
  if (prediction.impossible > 0) {
    sentences.push_back(fmt::format("Prediction: {} draws were physically impossible or failed and are left out.",
                                    prediction.impossible));
  }
  if (check == nullptr) return sentences;
  double sum = 0.0;
  double count = 0.0;
  for (const double coverage : check->coverage) {
    if (std::isnan(coverage)) continue;
    sum += coverage;
    count += 1.0;
  }
  sentences.push_back(
      fmt::format("Held-out tests: on average over the outputs {} lie inside the {} intervals{}.",
                  percent(sum / std::max(count, 1.0)), inside,
                  std::isnan(check->joint_coverage)
                      ? ""
                      : fmt::format(", {} inside the joint {} region", percent(check->joint_coverage), inside)));
  std::vector<std::string> odd;
  for (Eigen::Index k = 0; k < check->uniformity.size(); ++k) {
    const bool is_odd = check->uniformity(k) * count <= level;
    if (is_odd) odd.push_back(outputs[static_cast<std::size_t>(k)].name());
  }
  if (std::isnan(check->adjusted_p)) {
    sentences.emplace_back(
        "Whether their probabilities in the predicted distributions are uniform was not tested: at least two held-out "
        "tests of an output are needed.");
    return sentences;
  }
  sentences.push_back(odd.empty() ? fmt::format("Their probabilities in the predicted distributions are uniform within "
                                                "chance (smallest p after correction {:.2g}).",
                                                check->adjusted_p)
                                  : fmt::format("The predicted distributions of {} do not fit the held-out tests (p = "
                                                "{:.2g} after correction).",
                                                join(odd), check->adjusted_p));
  return sentences;
}

}  // namespace mottle::updating
