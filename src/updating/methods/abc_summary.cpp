#include "updating/methods/abc_summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/parallel.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/moments/descriptive.hpp"

namespace mottle::updating {
namespace {

constexpr Eigen::Index k_pilot_sets = 200;
constexpr std::int64_t k_grain = 64;

}  // namespace

double AbcSampler::log_prior(const Eigen::Ref<const Eigen::VectorXd>& at) const {
  if (!coordinates.is_allowed(at)) return -std::numeric_limits<double>::infinity();
  const Eigen::ArrayXd variance = coordinates.standard_deviations(at).array().square();
  const double of_deviations = (variance / (variance + known.noise_share.array().square())).log().sum();
  return of_deviations - 2.0 * coordinates.fisher_z(at).array().cosh().log().sum();
}

AbcSummary::AbcSummary(const AbcSampler& sampler, const Eigen::VectorXd& reference, std::uint32_t stage)
    : sampler_(sampler),
      gradient_(*sampler.nearest.comparison, sampler.cloud.at(reference), sampler.cloud.slopes(reference)) {
  const Eigen::Index size = reference.size();
  scale_ = Eigen::MatrixXd::Identity(size, size);
  const Eigen::MatrixXd pilot = pilot_at(reference, stage);
  // Summaries in which nothing scatters stay as they are: they tell nothing.
  Eigen::MatrixXd covariance = sample_covariance(pilot);
  covariance.diagonal().array() += 1e-300;
  constexpr double k_least_eigenvalue = 1e-6;
  repair_covariance(covariance, k_least_eigenvalue);
  const CholeskyFactor factor(covariance);
  if (factor.is_positive_definite()) {
    scale_ = factor.solve_lower(scale_).transpose();
  } else {
    scale_ = covariance.diagonal().cwiseSqrt().cwiseInverse().asDiagonal();
  }
  reference_ = reference;
  expected_ = pilot.colwise().mean() * scale_;
  find_slopes(stage);
}

Eigen::VectorXd AbcSummary::nearest(const Eigen::MatrixXd& tests) const {
  constexpr int k_steps = 5;
  constexpr double k_longest = 1.0;
  const PopulationCoordinates& coordinates = sampler_.coordinates;
  const Eigen::MatrixXd newton = slopes_.transpose() * scale_.transpose();
  Eigen::VectorXd at = reference_;
  for (int step = 0; step < k_steps; ++step) {
    Eigen::VectorXd move;
    if (step == 0) {
      move = newton * (gradient_.of_tests(tests) + gradient_.of_cloud());
    } else {
      const DistanceGradient here(*sampler_.nearest.comparison, sampler_.cloud.at(at), sampler_.cloud.slopes(at));
      move = newton * (here.of_tests(tests) + here.of_cloud());
    }
    const double longest = move.cwiseAbs().maxCoeff();
    if (longest > k_longest) move *= k_longest / longest;
    at = (at + move).cwiseMax(coordinates.lower()).cwiseMin(coordinates.upper());
  }
  return at;
}

void AbcSummary::fill(Eigen::MatrixXd& summaries, const Eigen::MatrixXd& points, const StreamKey& key) const {
  const RunContext& context = sampler_.context;
  parallel_for(points.rows(), k_grain, context.threads, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end && !context.stop_requested(); ++k) {
      if (!sampler_.coordinates.is_allowed(points.row(k).transpose())) {
        summaries.row(k).setZero();  // it has no weight
        continue;
      }
      summaries.row(k) =
          of(sampler_.simulator.simulate(points.row(k).transpose(), key, static_cast<std::uint32_t>(k))).transpose();
    }
  });
  context.throw_if_stopped();
}

/// Summaries of sets simulated at one point, with the same random numbers wherever it is.
Eigen::MatrixXd AbcSummary::pilot_at(const Eigen::VectorXd& point, std::uint32_t stage) const {
  Eigen::MatrixXd pilot(k_pilot_sets, point.size());
  fill(pilot, point.transpose().replicate(k_pilot_sets, 1),
       {.seed = sampler_.context.seed, .purpose = StreamPurpose::abc_simulation, .iteration = 100 + stage});
  return pilot;
}

/// A = (C'C + W^-2)^-1 C' of C = d(mean summary) / d(coordinate): the inverse of C, but for coordinates that
/// summaries, whose scatter is one, tell less of than of widths W. Those stay where they are.
void AbcSummary::find_slopes(std::uint32_t stage) {
  constexpr double k_step = 0.05;
  const Eigen::Index size = reference_.size();
  Eigen::MatrixXd changes(size, size);  // [summary x coordinate]
  for (Eigen::Index k = 0; k < size; ++k) {
    Eigen::VectorXd ahead = reference_;
    Eigen::VectorXd behind = reference_;
    ahead(k) = std::min(ahead(k) + k_step, sampler_.coordinates.upper()(k));
    behind(k) = std::max(behind(k) - k_step, sampler_.coordinates.lower()(k));
    const Eigen::MatrixXd difference = pilot_at(ahead, stage) - pilot_at(behind, stage);
    changes.col(k) = difference.colwise().mean().transpose() / (ahead(k) - behind(k));
  }
  Eigen::MatrixXd regular = changes.transpose() * changes;
  regular.diagonal() += sampler_.coordinates.widths().cwiseAbs2().cwiseInverse();
  slopes_ = CholeskyFactor(regular).solve(Eigen::MatrixXd(changes.transpose())).transpose();
}

Eigen::MatrixXd TestSimulator::simulate(const Eigen::Ref<const Eigen::VectorXd>& coordinates, const StreamKey& key,
                                        std::uint32_t set) const {
  RandomStream stream(key, set);
  const Eigen::MatrixXd& values = problem_.tests.values;
  const TransportBase& all = transport_.base();
  std::vector<Eigen::Index> rows;
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    const auto count = static_cast<double>(all.points.rows());
    rows.push_back(std::min(static_cast<Eigen::Index>(stream.uniform() * count), all.points.rows() - 1));
  }
  const SampledPopulation population = coordinates_.at(coordinates);
  Eigen::MatrixXd tests =
      transport_.outputs(population, {all.points(rows, Eigen::all), all.residual(rows, Eigen::all)});
  for (Eigen::Index k = 0; k < tests.cols(); ++k) {
    for (Eigen::Index s = 0; s < tests.rows(); ++s) {
      if (std::isnan(values(s, k))) {
        tests(s, k) = values(s, k);
      } else if (population.noise_std(k) > 0.0) {
        tests(s, k) += population.noise_std(k) * standard_normal_quantile(stream.uniform());
      }
    }
  }
  if (offset_.is_none()) return tests;
  return offset_.displaced(tests, Eigen::VectorXd::NullaryExpr(tests.cols(), [&](Eigen::Index) {
                             return standard_normal_quantile(stream.uniform());
                           }));
}

}  // namespace mottle::updating
