#include "updating/methods/mixture_intervals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/stats/moments/quantiles.hpp"
#include "updating/population/population_report.hpp"

namespace mottle::updating {
namespace {

/// A batch's parameters on the scales: mean, scatter with the noise's share, scatter alone, number of specimens.
struct BatchPivot {
  Eigen::VectorXd mean;
  Eigen::VectorXd total;
  Eigen::VectorXd own;
  double size = 0.0;
  double weight = 0.0;
};

BatchPivot pivot_of(const MixtureFrame& frame, const MixtureFit& fit, std::size_t k) {
  const BatchOnScales batch = frame.on_scales(fit.components[k]);
  const double size = fit.size_of(static_cast<Eigen::Index>(k));
  const Eigen::VectorXd total = size * (frame.map * fit.mean_covariances[k] * frame.map.transpose()).diagonal();
  const Eigen::VectorXd own = batch.covariance.diagonal();
  return {batch.mean, total.cwiseMax(own), own, size, batch.weight};
}

Eigen::RowVector2d ends_of(std::vector<double> values) {
  if (values.empty()) return Eigen::RowVector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  return equal_tails(std::move(values), k_confidence, QuantileRule::expectation);
}

}  // namespace

ParameterIntervals mixture_intervals(const UpdatingProblem& problem, const MixturePopulationFit& fit,
                                     const std::vector<MixtureFit>& redrawn, std::vector<Batch>& batches) {
  const std::vector<ParameterTransform> scales = problem.space.transforms();
  const auto q = static_cast<Eigen::Index>(scales.size());
  const Eigen::MatrixXd unknown = Eigen::MatrixXd::Constant(q, q, std::numeric_limits<double>::quiet_NaN());
  ParameterIntervals whole{Eigen::MatrixXd(q, 2), Eigen::MatrixXd(q, 2), unknown, unknown, "bootstrap"};
  std::vector<BatchPivot> seen;
  for (std::size_t k = 0; k < batches.size(); ++k) {
    seen.push_back(pivot_of(fit.frame, fit.mixture, k));
    batches[k].mean_interval.resize(q, 2);
    batches[k].std_interval.resize(q, 2);
  }
  std::vector<std::vector<BatchPivot>> drawn;
  for (const MixtureFit& again : redrawn) {
    drawn.emplace_back();
    for (std::size_t k = 0; k < batches.size(); ++k) drawn.back().push_back(pivot_of(fit.frame, again, k));
  }
  for (Eigen::Index i = 0; i < q; ++i) {
    std::vector<std::vector<double>> means(batches.size() + 1);
    std::vector<std::vector<double>> deviations(batches.size() + 1);
    for (const std::vector<BatchPivot>& sample : drawn) {
      double first = 0.0;
      double second = 0.0;
      for (std::size_t k = 0; k < batches.size(); ++k) {
        const BatchPivot& own = seen[k];
        const double ratio = sample[k].total(i) > 0.0 ? own.total(i) / sample[k].total(i) : 1.0;
        const double mean =
            own.mean(i) - (sample[k].mean(i) - own.mean(i)) * std::sqrt(ratio * sample[k].size / own.size);
        const double variance = std::max(own.total(i) * ratio - (own.total(i) - own.own(i)), 0.0);
        const VariableMoments moments =
            moments_of_variables({scales[static_cast<std::size_t>(i)]}, Eigen::VectorXd::Constant(1, mean),
                                 Eigen::MatrixXd::Constant(1, 1, variance));
        means[k].push_back(moments.mean(0));
        deviations[k].push_back(std::sqrt(moments.covariance(0, 0)));
        first += sample[k].weight * moments.mean(0);
        second += sample[k].weight * (moments.covariance(0, 0) + moments.mean(0) * moments.mean(0));
      }
      means.back().push_back(first);
      deviations.back().push_back(std::sqrt(std::max(second - first * first, 0.0)));
    }
    for (std::size_t k = 0; k < batches.size(); ++k) {
      batches[k].mean_interval.row(i) = ends_of(std::move(means[k]));
      batches[k].std_interval.row(i) = ends_of(std::move(deviations[k]));
    }
    whole.mean.row(i) = ends_of(std::move(means.back()));
    whole.std.row(i) = ends_of(std::move(deviations.back()));
  }
  return whole;
}

}  // namespace mottle::updating
