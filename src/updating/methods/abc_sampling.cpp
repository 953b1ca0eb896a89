#include "updating/methods/abc_sampling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/parallel.hpp"
#include "mottle/core/subject.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/updating/estimate/sample_estimate.hpp"

namespace mottle::updating {
namespace {

constexpr Eigen::Index k_reference_points = 256;  // of 128 a standard deviation depended on the seed by a factor of 4
constexpr int k_stages = 3;

/// The errors that estimates of simulated sets had, carried to the observed set: of standard deviations as factors, of
/// means in units of standard deviations with noise, of all else as differences.
///
///   mean* = mean^ + (tau^ / tau^_k) (mean_k - mean^_k),   ln sd* = ln sd^ + ln sd_k - ln sd^_k,   tau^2 = sd^2 +
///   noise^2
///
/// ^: estimated; _k: of a simulated set. Of a normal sample these are Student's and chi-squared's distributions
/// exactly.
Eigen::MatrixXd carry_errors(const AbcSampler& sampler, const Eigen::MatrixXd& points, const Eigen::MatrixXd& estimates,
                             const Eigen::RowVectorXd& observed) {
  const PopulationCoordinates& coordinates = sampler.coordinates;
  const Eigen::Index q = coordinates.parameters();
  Eigen::MatrixXd errors = points - estimates;
  for (Eigen::Index i = 0; i < q; ++i) {
    const double unit = sampler.known.noise_share(i) / coordinates.prior_deviations()(i);
    const auto scale = [&](const auto& log_deviation) { return ((2.0 * log_deviation).exp() + unit * unit).sqrt(); };
    const double own = std::sqrt(std::exp(2.0 * observed(q + i)) + unit * unit);
    errors.col(i).array() *= own / scale(estimates.col(q + i).array());
  }
  return errors.rowwise() + observed;
}

SimulationTable simulate_table(const AbcSampler& sampler, const AbcSummary& summary, const Eigen::VectorXd& centre,
                               const Eigen::MatrixXd& covariance, Eigen::Index count, std::uint32_t stage) {
  SimulationTable table{
      propose_uniformly(centre, covariance, count,
                        {.seed = sampler.context.seed, .purpose = StreamPurpose::abc_proposal, .iteration = stage}),
      Eigen::MatrixXd(count, centre.size()), Eigen::VectorXd(count),
      [&sampler, &summary](const Eigen::MatrixXd& points, const Eigen::MatrixXd& summaries,
                           const Eigen::VectorXd& observed) {
        return carry_errors(sampler, points, summary.estimates(summaries),
                            summary.estimates(observed.transpose()).row(0));
      }};
  for (Eigen::Index k = 0; k < count; ++k) table.log_weight(k) = sampler.log_prior(table.points.row(k).transpose());
  summary.fill(table.summaries, table.points,
               {.seed = sampler.context.seed, .purpose = StreamPurpose::abc_simulation, .iteration = stage});
  return table;
}

/// Where noise hides the parameters, populations that the tests allow reach beyond what is possible in any case.
void require_possible(const SimulationTable& table) {
  const Eigen::Index possible = (table.log_weight.array() > -std::numeric_limits<double>::infinity()).count();
  const Eigen::Index fewest = 2 * (table.summaries.cols() + 2);
  require_of(
      possible >= fewest, {Subject::Kind::method, "abc"},
      "{} of {} populations tried are possible, at least {} are needed: the tests say so little of the parameters "
      "that bounds and physical limits exclude nearly all; correct the noise if it is stated larger than the tests "
      "scatter (test.repeatability), measure more, or use method = \"hierarchical\", whose prior counts there",
      possible, table.log_weight.size(), fewest);
}

SimulatedStudies simulate_studies(const AbcSampler& sampler, const AbcSummary& summary, const Eigen::VectorXd& truth,
                                  Eigen::Index sets) {
  const StreamKey key{.seed = sampler.context.seed, .purpose = StreamPurpose::abc_calibration};
  const Eigen::MatrixXd cloud = sampler.cloud.at(truth);
  SimulatedStudies studies{std::vector<Eigen::MatrixXd>(static_cast<std::size_t>(sets)), Eigen::VectorXd(sets),
                           Eigen::MatrixXd(sets, truth.size())};
  parallel_for(sets, 4, sampler.context.threads, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t b = begin; b < end && !sampler.context.stop_requested(); ++b) {
      Eigen::MatrixXd& tests = studies.tests[static_cast<std::size_t>(b)];
      tests = sampler.simulator.simulate(truth, key, static_cast<std::uint32_t>(b));
      studies.distances(b) = sampler.nearest.comparison->distance(cloud, tests);
      studies.estimates.row(b) = summary.nearest(tests).transpose();
    }
  });
  sampler.context.throw_if_stopped();
  return studies;
}

double part_beyond(const Eigen::VectorXd& distances, double limit) {
  return (distances.array() >= limit).cast<double>().mean();
}

/// Half the logarithm of the ratio of simulated studies' variances to the true ones, over that of unbiased variances of
/// a normal sample. Medians: a study far from the reference cloud, where one step of the search goes astray, has a
/// variance without bound.
Eigen::VectorXd bias_of_deviations(const PopulationCoordinates& coordinates, const SimulatedStudies& studies,
                                   const Eigen::VectorXd& truth, Eigen::Index specimens) {
  constexpr double k_most = 0.7;
  const Eigen::Index q = coordinates.parameters();
  const Eigen::Index sets = studies.estimates.rows();
  const Eigen::VectorXd alike = Eigen::VectorXd::Constant(sets, 1.0 / static_cast<double>(sets));
  const auto freedom = static_cast<double>(specimens - 1);
  const double of_normal = 0.5 * std::log(chi_squared_quantile(0.5, freedom) / freedom);
  return Eigen::VectorXd::NullaryExpr(q, [&](Eigen::Index k) {
    const double middle = weighted_quantile(studies.estimates.col(q + k), alike, 0.5);
    return std::clamp(middle - truth(q + k) - of_normal, -k_most, k_most);
  });
}

/// Chooses the tolerance and stretches the intervals by simulated studies; compares the distance of the tests with
/// theirs.
void calibrate(const AbcSampler& sampler, const AbcSummary& summary, const SimulationTable& table,
               const Eigen::VectorXd& truth, const AbcOptions& options, SampledPopulations& found) {
  static const std::vector<double> k_fractions{0.5, 0.3, 0.15};
  const Eigen::MatrixXd& tests = sampler.tests;
  found.studies = simulate_studies(sampler, summary, truth, options.calibration_sets);
  found.estimate = summary.nearest(tests);
  const SimulatedStudies& studies = found.studies;
  std::vector<AcceptedDraws> trials;
  trials.reserve(k_fractions.size());
  for (const double fraction : k_fractions) trials.push_back(accept_nearest(table, summary.of(tests), fraction));
  found.calibration = calibrate_intervals(
      trials, found.estimate, studies.estimates, truth,
      [&](const Eigen::MatrixXd& points, const Eigen::MatrixXd& estimates, const Eigen::RowVectorXd& observed) {
        return carry_errors(sampler, points, estimates, observed);
      });
  found.fraction = k_fractions[found.calibration.chosen];
  found.draws = trials[found.calibration.chosen];
  found.calibration_sets = options.calibration_sets;
  found.log_bias = bias_of_deviations(sampler.coordinates, studies, truth, tests.rows());
  found.log_deviation = found.estimate.segment(found.log_bias.size(), found.log_bias.size()) - found.log_bias;
  const auto distance_from = [&](const Eigen::VectorXd& coordinates) {
    return sampler.nearest.comparison->distance(sampler.cloud.at(coordinates), tests);
  };
  const double distance = distance_from(truth);
  found.exceeded = part_beyond(studies.distances, distance);
  // Where the tests do not determine all coordinates the draws' mean can be far from all populations that are near.
  const double nearest = distance_from(sampler.nearest.coordinates);
  if (found.exceeded < sampler.problem.level && nearest < distance) {
    const Eigen::VectorXd distances =
        simulate_studies(sampler, summary, sampler.nearest.coordinates, options.calibration_sets).distances;
    found.exceeded = std::max(found.exceeded, part_beyond(distances, nearest));
  }
  found.simulated_distance = options.distance == AbcOptions::Distance::energy
                                 ? studies.distances.mean()
                                 : studies.distances.cwiseMax(0.0).cwiseSqrt().mean();
}

/// What the model's error may have moved the mean by, in each draw [draw x parameter].
Eigen::MatrixXd displacements(const SharedOffset& offset, Eigen::Index draws, std::uint64_t seed) {
  if (offset.is_none()) return {};
  Eigen::MatrixXd normal(draws, offset.mean_factor().cols());
  for (Eigen::Index k = 0; k < draws; ++k) {
    RandomStream stream({.seed = seed, .purpose = StreamPurpose::abc_model_error}, static_cast<std::uint32_t>(k));
    for (double& value : normal.row(k)) value = standard_normal_quantile(stream.uniform());
  }
  return normal * offset.mean_factor().transpose();
}

Eigen::VectorXd medians(const AcceptedDraws& draws) {
  return Eigen::VectorXd::NullaryExpr(
      draws.points.cols(), [&](Eigen::Index k) { return weighted_quantile(draws.points.col(k), draws.weights, 0.5); });
}

}  // namespace

Eigen::MatrixXd SampledPopulations::stretched(const PopulationCoordinates& coordinates) const {
  Eigen::MatrixXd points = draws.points;
  for (Eigen::Index k = 0; k < points.cols(); ++k)
    points.col(k) = median(k) + calibration.factor(k) * (points.col(k).array() - median(k));
  if (mean_displacement.size() > 0) points.leftCols(mean_displacement.cols()) += mean_displacement;
  return points.cwiseMax(coordinates.lower().transpose().replicate(points.rows(), 1))
      .cwiseMin(coordinates.upper().transpose().replicate(points.rows(), 1));
}

SampledPopulations sample_populations(const UpdatingProblem& problem, const PopulationCoordinates& coordinates,
                                      const NearestPopulation& nearest, const RoughKnowledge& known,
                                      const AbcOptions& options, const RunContext& context) {
  constexpr double k_early_fraction = 0.2;
  const AbcSampler sampler{problem,
                           coordinates,
                           nearest,
                           known,
                           context,
                           nearest.offset.taken_off(problem.tests.values),
                           TestSimulator(problem, coordinates, nearest),
                           MovingCloud(coordinates, *nearest.transport, k_reference_points, context.seed)};
  SampledPopulations found;
  Eigen::VectorXd centre = known.centre.cwiseMax(coordinates.lower()).cwiseMin(coordinates.upper());
  Eigen::MatrixXd covariance = known.std.cwiseAbs2().asDiagonal();
  for (int stage = 0; stage < k_stages; ++stage) {
    context.phase({.name = "simulated sets of tests", .step = stage + 1, .steps = k_stages});
    const bool is_last = stage + 1 == k_stages;
    const auto number = static_cast<std::uint32_t>(stage);
    const Eigen::Index count = std::max<Eigen::Index>(is_last ? options.simulations : options.simulations / 2, 500);
    const AbcSummary summary(sampler, centre, number);
    const SimulationTable table = simulate_table(sampler, summary, centre, covariance, count, number);
    require_possible(table);
    const Eigen::VectorXd observed = summary.of(sampler.tests);
    found.draws = accept_nearest(table, observed, k_early_fraction);
    if (is_last) {
      const Eigen::VectorXd truth = found.draws.mean.cwiseMax(coordinates.lower()).cwiseMin(coordinates.upper());
      calibrate(sampler, summary, table, truth, options, found);
    }
    found.stages.push_back({count, found.draws.points.rows(), found.draws.tolerance, found.draws.effective});
    centre = found.draws.mean.cwiseMax(coordinates.lower()).cwiseMin(coordinates.upper());
    covariance = found.draws.covariance;
  }
  found.median = medians(found.draws);
  found.mean_displacement = displacements(nearest.offset, found.draws.points.rows(), context.seed);
  return found;
}

}  // namespace mottle::updating
