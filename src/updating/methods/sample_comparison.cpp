#include "updating/methods/sample_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/stats/moments/energy_distance.hpp"
#include "mottle/stats/moments/quantiles.hpp"
#include "mottle/stats/moments/robust.hpp"
#include "mottle/stats/moments/spearman.hpp"
#include "mottle/stats/moments/wasserstein.hpp"
#include "updating/fits/measured_outputs.hpp"

namespace mottle::updating {
namespace {

constexpr Eigen::Index k_directions = 40;

/// Of few values, and of those of which half are the same, the usual one.
double deviation_of(const Eigen::Ref<const Eigen::VectorXd>& column) {
  constexpr std::size_t k_few = 5;
  std::vector<double> values;
  std::ranges::copy_if(column, std::back_inserter(values), [](double value) { return !std::isnan(value); });
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  const double plain = std::sqrt(squares / std::max(1.0, static_cast<double>(values.size()) - 1.0));
  const double robust = robust_deviation(column);
  return values.size() <= k_few || robust == 0.0 ? plain : robust;
}

/// Specimens that have all outputs.
std::vector<Eigen::Index> complete_specimens(const Eigen::Ref<const Eigen::MatrixXd>& values) {
  std::vector<Eigen::Index> complete;
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    if (values.row(s).allFinite()) complete.push_back(s);
  }
  return complete;
}

Eigen::MatrixXd rank_correlation(const Eigen::Ref<const Eigen::MatrixXd>& values) {
  constexpr std::size_t k_fewest = 4;
  const std::vector<Eigen::Index> complete = complete_specimens(values);
  Eigen::MatrixXd correlation = Eigen::MatrixXd::Identity(values.cols(), values.cols());
  if (complete.size() < k_fewest) return correlation;
  const Eigen::MatrixXd whole = values(complete, Eigen::all);
  const Eigen::MatrixXd ranks = spearman(whole, whole);
  correlation = ranks.unaryExpr([](double r) { return 2.0 * std::sin(std::numbers::pi / 6.0 * r); });
  correlation.diagonal().setOnes();
  return correlation;
}

/// L'^-1 of the outputs `measured`, embedded into all outputs: whitened rows are y map.
Eigen::MatrixXd whitening(const Eigen::Ref<const Eigen::MatrixXd>& covariance,
                          const std::vector<Eigen::Index>& measured) {
  const auto size = static_cast<Eigen::Index>(measured.size());
  const Eigen::MatrixXd own = covariance(measured, measured);
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(covariance.rows(), size);
  map(measured, Eigen::all) = CholeskyFactor(own).solve_lower(Eigen::MatrixXd::Identity(size, size)).transpose();
  return map;
}

/// Rows of tests without their missing entries, which the map does not use.
Eigen::MatrixXd mapped(const Eigen::Ref<const Eigen::MatrixXd>& tests, const std::vector<Eigen::Index>& specimens,
                       const Eigen::MatrixXd& map) {
  const Eigen::MatrixXd rows = tests(specimens, Eigen::all);
  return rows.unaryExpr([](double value) { return std::isnan(value) ? 0.0 : value; }) * map;
}

}  // namespace

Eigen::MatrixXd comparison_covariance(const TestData& tests, const Eigen::Ref<const Eigen::MatrixXd>& cloud_covariance,
                                      const Eigen::Ref<const Eigen::VectorXd>& noise_std) {
  constexpr double k_least_eigenvalue = 1e-4;
  const Eigen::MatrixXd& values = tests.values;
  const auto n = static_cast<double>(values.rows());
  const auto cloud_weight = static_cast<double>(values.cols() + 1);
  Eigen::MatrixXd covariance =
      (n * rank_correlation(values) + cloud_weight * correlation_from_covariance(cloud_covariance)) /
      (n + cloud_weight);
  Eigen::VectorXd scale(values.cols());
  for (Eigen::Index k = 0; k < values.cols(); ++k) {
    const double measured = std::max(deviation_of(values.col(k)), noise_std(k));
    scale(k) = weighing_deviation(measured, median(values.col(k)));
  }
  covariance = (scale.asDiagonal() * covariance * scale.asDiagonal()).eval();
  repair_covariance(covariance, k_least_eigenvalue);
  return covariance;
}

SampleComparison::SampleComparison(SampleDistance kind, const Eigen::Ref<const Eigen::MatrixXd>& tests,
                                   const Eigen::Ref<const Eigen::MatrixXd>& covariance, std::uint64_t seed)
    : kind_(kind) {
  if (kind == SampleDistance::energy) {
    std::map<std::vector<Eigen::Index>, std::vector<Eigen::Index>> patterns;
    for (Eigen::Index s = 0; s < tests.rows(); ++s) {
      const std::vector<Eigen::Index> measured = measured_outputs(tests, s);
      if (!measured.empty()) patterns[measured].push_back(s);
    }
    for (const auto& [measured, specimens] : patterns) {
      const double weight = static_cast<double>(specimens.size()) / static_cast<double>(tests.rows());
      parts_.push_back({whitening(covariance, measured), specimens, weight});
    }
    return;
  }
  for (Eigen::Index k = 0; k < tests.cols(); ++k) {
    Part part{Eigen::MatrixXd::Zero(tests.cols(), 1), {}};
    part.map(k, 0) = 1.0 / std::sqrt(covariance(k, k));
    for (Eigen::Index s = 0; s < tests.rows(); ++s) {
      if (!std::isnan(tests(s, k))) part.specimens.push_back(s);
    }
    parts_.push_back(std::move(part));
  }
  const std::vector<Eigen::Index> complete = complete_specimens(tests);
  if (complete.size() >= 2 && tests.cols() >= 2) {
    std::vector<Eigen::Index> all(static_cast<std::size_t>(tests.cols()));
    std::iota(all.begin(), all.end(), Eigen::Index{0});
    const Eigen::MatrixXd map = whitening(covariance, all);
    const Eigen::MatrixXd directions =
        random_directions(k_directions, tests.cols(), {.seed = seed, .purpose = StreamPurpose::abc_directions});
    for (Eigen::Index d = 0; d < k_directions; ++d) parts_.push_back({map * directions.row(d).transpose(), complete});
  }
  for (Part& part : parts_) part.weight = 1.0 / static_cast<double>(parts_.size());
}

double SampleComparison::distance(const Eigen::Ref<const Eigen::MatrixXd>& cloud,
                                  const Eigen::Ref<const Eigen::MatrixXd>& tests) const {
  double sum = 0.0;
  for (const Part& part : parts_) {
    const Eigen::MatrixXd own = cloud * part.map;
    const Eigen::MatrixXd theirs = mapped(tests, part.specimens, part.map);
    if (kind_ == SampleDistance::energy) {
      sum += part.weight * energy_distance(own, theirs);
    } else {
      const double distance = wasserstein_distance(own.col(0), theirs.col(0), 2);
      sum += part.weight * distance * distance;
    }
  }
  return sum;
}

DistanceGradient::DistanceGradient(const SampleComparison& comparison, const Eigen::Ref<const Eigen::MatrixXd>& cloud,
                                   const std::vector<Eigen::MatrixXd>& slopes)
    : comparison_(comparison), of_cloud_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(slopes.size()))) {
  const Eigen::Index samples = cloud.rows();
  const double share = 2.0 / static_cast<double>(samples);
  for (const SampleComparison::Part& from : comparison.parts_) {
    Part part{cloud * from.map, Eigen::MatrixXd(samples * from.map.cols(), of_cloud_.size())};
    std::vector<Eigen::Index> order(static_cast<std::size_t>(samples));
    std::iota(order.begin(), order.end(), Eigen::Index{0});
    const bool is_energy = comparison.kind_ == SampleDistance::energy;
    if (!is_energy) {
      std::stable_sort(order.begin(), order.end(),
                       [&](Eigen::Index a, Eigen::Index b) { return part.cloud(a, 0) < part.cloud(b, 0); });
      part.cloud = part.cloud(order, Eigen::all).eval();
    }
    for (std::size_t k = 0; k < slopes.size(); ++k) {
      const Eigen::MatrixXd moved = (slopes[k] * from.map)(order, Eigen::all);
      part.slopes.col(static_cast<Eigen::Index>(k)) = share * from.weight * moved.reshaped();
    }
    const Eigen::MatrixXd pull = is_energy ? Eigen::MatrixXd(-mean_unit_vectors(part.cloud, part.cloud)) : part.cloud;
    of_cloud_ += part.slopes.transpose() * pull.reshaped();
    parts_.push_back(std::move(part));
  }
}

Eigen::VectorXd DistanceGradient::of_tests(const Eigen::Ref<const Eigen::MatrixXd>& tests) const {
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(of_cloud_.size());
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    const SampleComparison::Part& from = comparison_.parts_[k];
    const Eigen::MatrixXd theirs = mapped(tests, from.specimens, from.map);
    if (comparison_.kind_ == SampleDistance::energy) {
      gradient += parts_[k].slopes.transpose() * mean_unit_vectors(parts_[k].cloud, theirs).reshaped();
    } else {
      gradient -= parts_[k].slopes.transpose() * quantile_means(theirs.col(0), parts_[k].cloud.rows());
    }
  }
  return gradient;
}

}  // namespace mottle::updating
