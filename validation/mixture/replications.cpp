// Replications of the method `mixture` on a linear model with known answers; see README.md.
//
//   mottle_mixture_replications reference SEED           a mixture without prior, for scikit-learn
//   mottle_mixture_replications splits N REPS NOISE      one batch: how often it is split
//   mottle_mixture_replications power N REPS NOISE D     two batches of equal size D standard deviations apart
//   mottle_mixture_replications intervals N REPS NOISE D the same: bias and coverage with the number of batches given
//   mottle_mixture_replications skewed N REPS NOISE S    one batch, its first parameter log-normal with ln-std S
//   mottle_mixture_replications wide N REPS NOISE D      as power, a batch's standard deviation a quarter of its mean:
//                                                        a logarithm changes the form of the population there
//
// NOISE: none (two outputs of two parameters), known, or estimated (four outputs).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "mottle/core/random.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "support/linear_model.hpp"
#include "updating/methods/mixture.hpp"

namespace mottle::updating {
namespace {

constexpr double k_noise = 0.05;  // half of a batch's standard deviation
constexpr double k_scatter = 0.1;

struct Setting {
  int specimens = 10;
  std::string noise;
  double distance = 0.0;     // in standard deviations of a batch with its noise
  double log_scatter = 0.0;  // of the first parameter, its median 1; 0: it is normal about 3
  bool is_wide = false;      // the lower batch's first parameter is normal, 1 +- 0.25

  Eigen::Index outputs() const { return noise == "none" ? 2 : 4; }
  Eigen::MatrixXd slope() const {
    Eigen::MatrixXd g(4, 2);
    g << 1.0, 0.5, -1.0, 2.0, 0.3, 0.7, 1.5, -0.2;
    return g.topRows(outputs());
  }
  /// Scatter of a batch's first parameter with the noise's share.
  double unit() const {
    if (noise == "none") return k_scatter;
    const Eigen::Matrix2d h = slope().transpose() * slope();
    const double share = h(1, 1) / (h(0, 0) * h(1, 1) - h(0, 1) * h(0, 1));
    return std::sqrt(k_scatter * k_scatter + k_noise * k_noise * share);
  }
};

struct Replicate {
  Replicate(const Setting& setting, int number)
      : model(Eigen::VectorXd::Constant(setting.outputs(), 10.0), setting.slope()),
        space({{"a", "-"}, {"b", "-"}},
              JointDistribution(std::vector<Distribution>(
                  2, Distribution({.kind = DistributionKind::normal, .mean = 3.0, .std = 1.0})))) {
    Eigen::MatrixXd x(setting.specimens, 2);
    Eigen::MatrixXd e = Eigen::MatrixXd::Zero(setting.specimens, setting.outputs());
    for (Eigen::Index s = 0; s < x.rows(); ++s) {
      RandomStream stream(
          {.seed = 2026, .purpose = StreamPurpose::truth, .iteration = static_cast<std::uint32_t>(number)},
          static_cast<std::uint32_t>(s));
      for (double& value : x.row(s)) value = 3.0 + k_scatter * standard_normal_quantile(stream.uniform());
      for (double& value : e.row(s)) value = standard_normal_quantile(stream.uniform());
      const double score = (x(s, 0) - 3.0) / k_scatter;
      if (setting.log_scatter > 0.0) {
        x(s, 0) = std::exp(setting.log_scatter * score);
      } else if (setting.is_wide) {
        x(s, 0) = 1.0 + 0.25 * (score + (s % 2 == 0 ? setting.distance : 0.0));
      } else {
        x(s, 0) += (s % 2 == 0 ? 0.5 : -0.5) * setting.distance * setting.unit();
      }
    }
    tests = model.evaluate(x, {}).outputs;
    if (setting.noise != "none") tests += k_noise * e;
    repeatability = Eigen::VectorXd::Constant(setting.outputs(), setting.noise == "known" ? k_noise : 0.0);
  }
  UpdatingResult update(const MixtureOptions& options, int number) const {
    return MixtureUpdater(options).update(
        {.model = model, .space = space, .tests = {tests, repeatability}, .cloud = {.samples = 10}, .iterations = 50},
        {.seed = static_cast<std::uint64_t>(number)});
  }
  test::LinearModel model;
  ParameterSpace space;
  Eigen::MatrixXd tests;
  Eigen::VectorXd repeatability;
};

int count_batches(const Setting& setting, int replications) {
  int several = 0;
  double stated = 0.0;
  int with_power = 0;
  int outlying = 0;
  int refused = 0;
  for (int r = 1; r <= replications; ++r) {
    const UpdatingResult result = Replicate(setting, r).update({.bootstrap_samples = 99}, r);
    several += result.mixture->batches.size() > 1 ? 1 : 0;
    refused += !result.mixture->tests.empty() && result.mixture->tests.front().is_refused ? 1 : 0;
    outlying += (result.mixture->probabilities.rightCols(1).array() > k_outlying).any() ? 1 : 0;
    if (!result.mixture->detectable) continue;
    stated += *result.mixture->detectable;
    ++with_power;
  }
  fmt::print(
      "{{\"replications\": {}, \"several\": {}, \"one_refused\": {}, \"with_outlier\": {}, \"stated_distance\": {}, "
      "\"with_power\": {}}}\n",
      replications, several, refused, outlying, with_power > 0 ? stated / with_power : -1.0, with_power);
  return 0;
}

bool holds(const Eigen::MatrixXd& interval, double value) {
  return interval(0, 0) <= value && value <= interval(0, 1);
}

int measure_intervals(const Setting& setting, int replications) {
  double bias = 0.0;
  double ratio = 0.0;
  int mean = 0;
  int std = 0;
  int whole_mean = 0;
  int whole_std = 0;
  int right = 0;
  int counted = 0;
  const double shift = 0.5 * setting.distance * setting.unit();
  for (int r = 1; r <= replications; ++r) {
    const UpdatingResult result = Replicate(setting, r).update({.components = 2, .bootstrap_samples = 99}, r);
    if (!result.intervals) continue;
    ++counted;
    const auto& batches = result.mixture->batches;
    const std::size_t upper = batches[0].mean(0) > batches[1].mean(0) ? 0 : 1;
    bias += (batches[upper].mean(0) - 3.0 - shift) / k_scatter;
    ratio += batches[upper].std(0) / k_scatter;
    mean += holds(batches[upper].mean_interval, 3.0 + shift) ? 1 : 0;
    std += holds(batches[upper].std_interval, k_scatter) ? 1 : 0;
    whole_mean += holds(result.intervals->mean, 3.0) ? 1 : 0;
    whole_std += holds(result.intervals->std, std::hypot(k_scatter, shift)) ? 1 : 0;
    for (Eigen::Index s = 0; s < setting.specimens; ++s) {
      const Eigen::Index own = result.mixture->batch_of(s);
      right += own == static_cast<Eigen::Index>(s % 2 == 0 ? upper : 1 - upper) ? 1 : 0;
    }
  }
  fmt::print(
      "{{\"replications\": {}, \"bias\": {}, \"std_ratio\": {}, \"mean\": {}, \"std\": {}, \"whole_mean\": {}, "
      "\"whole_std\": {}, \"right\": {}}}\n",
      counted, bias / counted, ratio / counted, mean, std, whole_mean, whole_std,
      static_cast<double>(right) / (counted * setting.specimens));
  return 0;
}

/// Forty units of three effects in two batches: data and fit.
int print_reference(int seed) {
  MixtureData data;
  data.designs.push_back({Eigen::MatrixXd::Identity(3, 3), Eigen::MatrixXd::Zero(3, 3)});
  for (int s = 0; s < 40; ++s) {
    RandomStream stream({.seed = static_cast<std::uint64_t>(seed)}, static_cast<std::uint32_t>(s));
    Eigen::VectorXd y(3);
    for (double& value : y) value = standard_normal_quantile(stream.uniform());
    if (s % 3 == 0) y(0) += 4.0;
    data.responses.push_back(y);
    data.design_of.push_back(0);
  }
  MixtureSettings settings{.is_restricted = false, .prior_weight = 0.0, .iterations = 20000, .tolerance = 1e-13};
  const auto one = find_mixture(data, 1, nullptr, settings, 8, {});
  const auto fit = find_mixture(data, 2, &*one, settings, 8, {});
  if (!fit) return 1;
  fmt::print("{{\"log_likelihood\": {}, \"weights\": [{}, {}], \"means\": [", fit->log_likelihood,
             fit->components[0].weight, fit->components[1].weight);
  for (int k = 0; k < 2; ++k) {
    const Eigen::VectorXd& m = fit->components[static_cast<std::size_t>(k)].mean;
    fmt::print("{}[{}, {}, {}]", k == 0 ? "" : ", ", m(0), m(1), m(2));
  }
  fmt::print("], \"probabilities\": [");
  for (Eigen::Index s = 0; s < 40; ++s) fmt::print("{}{}", s == 0 ? "" : ", ", fit->probabilities(s, 0));
  fmt::print("], \"data\": [");
  for (std::size_t s = 0; s < data.size(); ++s) {
    const Eigen::VectorXd& y = data.responses[s];
    fmt::print("{}[{}, {}, {}]", s == 0 ? "" : ", ", y(0), y(1), y(2));
  }
  fmt::print("]}}\n");
  return 0;
}

}  // namespace
}  // namespace mottle::updating

int main(int count, char** words) {
  using namespace mottle::updating;
  if (count < 3) return 2;
  const std::string what = words[1];
  if (what == "reference") return print_reference(std::atoi(words[2]));
  if (count < 5) return 2;
  const double number = count > 5 ? std::atof(words[5]) : 0.0;
  Setting setting{.specimens = std::atoi(words[2]), .noise = words[4], .is_wide = what == "wide"};
  (what == "skewed" ? setting.log_scatter : setting.distance) = number;
  return what == "intervals" ? measure_intervals(setting, std::atoi(words[3]))
                             : count_batches(setting, std::atoi(words[3]));
}
