#include "updating/methods/abc_sampling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/parallel.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/updating/estimate/sample_estimate.hpp"

namespace mottle::updating {
namespace {

constexpr Eigen::Index k_reference_points = 128;
constexpr Eigen::Index k_pilot_sets = 200;
constexpr std::int64_t k_grain = 64;
constexpr int k_stages = 3;

/// Everything that the stages share.
struct Sampler {
  const UpdatingProblem& problem;
  const PopulationCoordinates& coordinates;
  const NearestPopulation& nearest;
  const RoughKnowledge& known;
  const RunContext& context;
  TestSimulator simulator;
  MovingCloud cloud;

  double log_prior(const Eigen::Ref<const Eigen::VectorXd>& at) const {
    if (!coordinates.is_allowed(at)) return -std::numeric_limits<double>::infinity();
    const Eigen::ArrayXd variance = coordinates.standard_deviations(at).array().square();
    const double of_deviations = (variance / (variance + known.noise_share.array().square())).log().sum();
    return of_deviations - 2.0 * coordinates.fisher_z(at).array().cosh().log().sum();
  }
};

/// Summaries of sets of tests, by one reference cloud.
class Summary {
 public:
  Summary(const Sampler& sampler, const Eigen::VectorXd& reference, std::uint32_t stage)
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
    find_slopes(reference, stage);
  }

  /// Coordinates that sets with these summaries speak for: one step of the search from the reference cloud
  /// [set x coordinate].
  Eigen::MatrixXd estimates(const Eigen::MatrixXd& summaries) const {
    return ((summaries.rowwise() - expected_) * slopes_).rowwise() + reference_.transpose();
  }

  Eigen::VectorXd of(const Eigen::MatrixXd& tests) const { return scale_.transpose() * gradient_.of_tests(tests); }

  /// Coordinates of the population whose cloud is nearest to these tests: Newton's steps from the reference with the
  /// slopes there.
  Eigen::VectorXd nearest(const Eigen::MatrixXd& tests) const {
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

  /// Of a set simulated at each point [set x coordinate].
  void fill(Eigen::MatrixXd& summaries, const Eigen::MatrixXd& points, const StreamKey& key) const {
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

 private:
  /// Summaries of sets simulated at one point, with the same random numbers wherever it is.
  Eigen::MatrixXd pilot_at(const Eigen::VectorXd& point, std::uint32_t stage) const {
    Eigen::MatrixXd pilot(k_pilot_sets, point.size());
    fill(pilot, point.transpose().replicate(k_pilot_sets, 1),
         {.seed = sampler_.context.seed, .purpose = StreamPurpose::abc_simulation, .iteration = 100 + stage});
    return pilot;
  }

  /// A = (C'C + W^-2)^-1 C' of C = d(mean summary) / d(coordinate): the inverse of C, but for coordinates that
  /// summaries, whose scatter is one, tell less of than of widths W. Those stay where they are.
  void find_slopes(const Eigen::VectorXd& reference, std::uint32_t stage) {
    constexpr double k_step = 0.05;
    const Eigen::Index size = reference.size();
    Eigen::MatrixXd changes(size, size);  // [summary x coordinate]
    for (Eigen::Index k = 0; k < size; ++k) {
      Eigen::VectorXd ahead = reference;
      Eigen::VectorXd behind = reference;
      ahead(k) = std::min(ahead(k) + k_step, sampler_.coordinates.upper()(k));
      behind(k) = std::max(behind(k) - k_step, sampler_.coordinates.lower()(k));
      const Eigen::MatrixXd difference = pilot_at(ahead, stage) - pilot_at(behind, stage);
      changes.col(k) = difference.colwise().mean().transpose() / (ahead(k) - behind(k));
    }
    const Eigen::MatrixXd information = changes.transpose() * changes;
    Eigen::MatrixXd regular = information;
    regular.diagonal() += sampler_.coordinates.widths().cwiseAbs2().cwiseInverse();
    slopes_ = CholeskyFactor(regular).solve(Eigen::MatrixXd(changes.transpose())).transpose();
  }

  const Sampler& sampler_;
  DistanceGradient gradient_;
  Eigen::VectorXd reference_;
  Eigen::MatrixXd scale_;
  Eigen::RowVectorXd expected_;  // mean summary at the reference
  Eigen::MatrixXd slopes_;       // of coordinates on summaries [summary x coordinate]
};

/// The errors that estimates of simulated sets had, carried to the observed set: of standard deviations as factors, of
/// means in units of standard deviations with noise, of all else as differences.
///
///   mean* = mean^ + (tau^ / tau^_k) (mean_k - mean^_k),   ln sd* = ln sd^ + ln sd_k - ln sd^_k,   tau^2 = sd^2 + noise^2
///
/// ^: estimated; _k: of a simulated set. Of a normal sample these are Student's and chi-squared's distributions exactly.
Eigen::MatrixXd carry_errors(const Sampler& sampler, const Eigen::MatrixXd& points, const Eigen::MatrixXd& estimates,
                             const Eigen::RowVectorXd& observed) {
  const PopulationCoordinates& coordinates = sampler.coordinates;
  const Eigen::Index q = coordinates.parameters();
  Eigen::MatrixXd errors = points - estimates;
  for (Eigen::Index i = 0; i < q; ++i) {
    const double unit = sampler.known.noise_share(i) / coordinates.prior_deviations()(i);
    const auto scale = [&](const auto& log_deviation) {
      return ((2.0 * log_deviation).exp() + unit * unit).sqrt();
    };
    const double own = std::sqrt(std::exp(2.0 * observed(q + i)) + unit * unit);
    errors.col(i).array() *= own / scale(estimates.col(q + i).array());
  }
  return errors.rowwise() + observed;
}

SimulationTable simulate_table(const Sampler& sampler, const Summary& summary, const Eigen::VectorXd& centre,
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

/// Tests simulated at a population: their distances from its cloud, and the populations nearest to them.
struct SimulatedStudies {
  Eigen::VectorXd distances;  // [set]
  Eigen::MatrixXd estimates;  // [set x coordinate]
};

SimulatedStudies simulate_studies(const Sampler& sampler, const Summary& summary, const Eigen::VectorXd& truth,
                                  Eigen::Index sets) {
  const StreamKey key{.seed = sampler.context.seed, .purpose = StreamPurpose::abc_calibration};
  const Eigen::MatrixXd cloud = sampler.cloud.at(truth);
  SimulatedStudies studies{Eigen::VectorXd(sets), Eigen::MatrixXd(sets, truth.size())};
  parallel_for(sets, 4, sampler.context.threads, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t b = begin; b < end && !sampler.context.stop_requested(); ++b) {
      const Eigen::MatrixXd tests = sampler.simulator.simulate(truth, key, static_cast<std::uint32_t>(b));
      studies.distances(b) = sampler.nearest.comparison->distance(cloud, tests);
      studies.estimates.row(b) = summary.nearest(tests).transpose();
    }
  });
  sampler.context.throw_if_stopped();
  return studies;
}

/// ln sd of the estimate, less half the logarithm of the mean ratio of simulated studies' variances to the true ones.
Eigen::VectorXd unbiased_deviations(const PopulationCoordinates& coordinates, const SimulatedStudies& studies,
                                    const Eigen::VectorXd& truth, const Eigen::VectorXd& estimate) {
  constexpr double k_most = 0.7;
  const Eigen::Index q = coordinates.parameters();
  Eigen::VectorXd found = estimate.segment(q, q);
  for (Eigen::Index k = q; k < 2 * q; ++k) {
    const double ratio = (2.0 * (studies.estimates.col(k).array() - truth(k))).exp().mean();
    found(k - q) -= std::clamp(0.5 * std::log(ratio), -k_most, k_most);
  }
  return found;
}

/// Chooses the tolerance and stretches the intervals by simulated studies; compares the distance of the tests with theirs.
void calibrate(const Sampler& sampler, const Summary& summary, const SimulationTable& table,
               const Eigen::VectorXd& truth, const AbcOptions& options, SampledPopulations& found) {
  static const std::vector<double> k_fractions{0.5, 0.3, 0.15};
  const Eigen::MatrixXd& tests = sampler.problem.tests.values;
  const SimulatedStudies studies = simulate_studies(sampler, summary, truth, options.calibration_sets);
  const Eigen::VectorXd estimate = summary.nearest(tests);
  std::vector<AcceptedDraws> trials;
  trials.reserve(k_fractions.size());
  for (const double fraction : k_fractions) trials.push_back(accept_nearest(table, summary.of(tests), fraction));
  found.calibration = calibrate_intervals(
      trials, estimate, studies.estimates, truth,
      [&](const Eigen::MatrixXd& points, const Eigen::MatrixXd& estimates, const Eigen::RowVectorXd& observed) {
        return carry_errors(sampler, points, estimates, observed);
      });
  found.fraction = k_fractions[found.calibration.chosen];
  found.draws = trials[found.calibration.chosen];
  found.calibration_sets = options.calibration_sets;
  found.log_deviation = unbiased_deviations(sampler.coordinates, studies, truth, estimate);
  const double distance = sampler.nearest.comparison->distance(sampler.cloud.at(truth), tests);
  found.exceeded = (studies.distances.array() >= distance).cast<double>().mean();
  found.simulated_distance = options.distance == AbcOptions::Distance::energy
                                 ? studies.distances.mean()
                                 : studies.distances.cwiseMax(0.0).cwiseSqrt().mean();
}

Eigen::VectorXd medians(const AcceptedDraws& draws) {
  return Eigen::VectorXd::NullaryExpr(draws.points.cols(), [&](Eigen::Index k) {
    return weighted_quantile(draws.points.col(k), draws.weights, 0.5);
  });
}

}  // namespace

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
    if (problem_.tests.model_error_std.size() > 0 && problem_.tests.model_error_std(k) > 0.0) {
      tests.col(k).array() += problem_.tests.model_error_std(k) * standard_normal_quantile(stream.uniform());
    }
    for (Eigen::Index s = 0; s < tests.rows(); ++s) {
      if (std::isnan(values(s, k))) {
        tests(s, k) = values(s, k);
      } else if (population.noise_std(k) > 0.0) {
        tests(s, k) += population.noise_std(k) * standard_normal_quantile(stream.uniform());
      }
    }
  }
  return tests;
}

Eigen::MatrixXd SampledPopulations::stretched(const PopulationCoordinates& coordinates) const {
  Eigen::MatrixXd points = draws.points;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    points.col(k) = (median(k) + calibration.factor(k) * (points.col(k).array() - median(k)))
                        .max(coordinates.lower()(k))
                        .min(coordinates.upper()(k));
  }
  return points;
}

SampledPopulations sample_populations(const UpdatingProblem& problem, const PopulationCoordinates& coordinates,
                                      const NearestPopulation& nearest, const RoughKnowledge& known,
                                      const AbcOptions& options, const RunContext& context) {
  constexpr double k_early_fraction = 0.2;
  const Sampler sampler{problem,
                        coordinates,
                        nearest,
                        known,
                        context,
                        TestSimulator(problem, coordinates, *nearest.transport),
                        MovingCloud(coordinates, *nearest.transport, k_reference_points, context.seed)};
  SampledPopulations found;
  Eigen::VectorXd centre = known.centre.cwiseMax(coordinates.lower()).cwiseMin(coordinates.upper());
  Eigen::MatrixXd covariance = known.std.cwiseAbs2().asDiagonal();
  for (int stage = 0; stage < k_stages; ++stage) {
    context.phase({.name = "simulated sets of tests", .step = stage + 1, .steps = k_stages});
    const bool is_last = stage + 1 == k_stages;
    const auto number = static_cast<std::uint32_t>(stage);
    const Eigen::Index count = std::max<Eigen::Index>(is_last ? options.simulations : options.simulations / 2, 500);
    const Summary summary(sampler, centre, number);
    const SimulationTable table =
        simulate_table(sampler, summary, centre, covariance, count, number);
    const Eigen::VectorXd observed = summary.of(problem.tests.values);
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
  return found;
}

}  // namespace mottle::updating
