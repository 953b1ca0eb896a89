#include "mottle/updating/methods/bayes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"
#include "mottle/updating/estimate/posterior.hpp"
#include "mottle/updating/estimate/sample_estimate.hpp"
#include "mottle/updating/methods/deterministic.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/methods/bayes_tests.hpp"
#include "updating/methods/common_likelihood.hpp"
#include "updating/methods/least_squares.hpp"
#include "updating/methods/posterior_outputs.hpp"
#include "updating/methods/posterior_target.hpp"
#include "updating/population/model_error.hpp"
#include "updating/population/regional_problem.hpp"

namespace mottle::updating {
namespace {

constexpr double k_max_r_hat = 1.01;  // [Vehtari2021]
constexpr double k_max_spread = 1.0;  // of the islands' ln evidences: beyond, the mean of the evidences is that of one

/// What keeps the islands from being one sample, in words.
std::vector<std::string> doubts_of(const SampledPosterior& posterior, const BayesOptions& options) {
  std::vector<std::string> doubts;
  for (std::size_t k = 0; k <= posterior.names.size(); ++k) {
    const double r_hat = posterior.r_hat(static_cast<Eigen::Index>(k));
    if (!(r_hat > k_max_r_hat)) continue;
    doubts.push_back(
        fmt::format("The islands disagree: R-hat of {} is {:.3f}, at most {} is allowed; give more "
                    "particles (bayes.particles).",
                    k < posterior.names.size() ? posterior.names[k] : "the log-likelihood", r_hat, k_max_r_hat));
  }
  if (posterior.evidence.spread > k_max_spread) {
    doubts.push_back(fmt::format(
        "The islands disagree on the evidence: the standard deviation of its logarithm is {:.2g}, at most {} is "
        "allowed; give more particles (bayes.particles).",
        posterior.evidence.spread, k_max_spread));
  }
  double worst = 0.0;
  std::size_t short_stages = 0;
  for (const std::vector<SamplingStage>& stages : posterior.stages) {
    for (const SamplingStage& stage : stages) {
      short_stages += stage.is_decorrelated ? 0 : 1;
      if (!stage.is_decorrelated) worst = std::max(worst, stage.correlation);
    }
  }
  if (short_stages > 0) {
    doubts.push_back(fmt::format(
        "In {} stages {} moves did not decorrelate the particles from their start (a correlation of {:.2f} was left, "
        "{} is asked for); give more moves (bayes.max_moves).",
        short_stages, options.max_moves, worst, options.decorrelation));
  }
  return doubts;
}

void conclude(const SampledPosterior& posterior, const BayesOptions& options, bool is_finished,
              UpdatingResult& result) {
  const std::vector<std::string> doubts = doubts_of(posterior, options);
  const Evidence& evidence = posterior.evidence;
  if (!is_finished) {
    result.status = UpdatingStatus::max_iterations;
    result.message = "the stages ran out before the whole likelihood counted";
    return;
  }
  result.warnings.insert(result.warnings.end(), doubts.begin(), doubts.end());
  result.status = doubts.empty() ? UpdatingStatus::converged : UpdatingStatus::stalled;
  result.message = doubts.empty() ? fmt::format(
                                        "{} islands of {} particles agree: R-hat at most {:.4f}; ln evidence {:.4f}, "
                                        "standard error {:.2g}",
                                        posterior.chains, posterior.draws, posterior.r_hat.maxCoeff(),
                                        evidence.log_evidence, evidence.standard_error)
                                  : doubts.front();
}

void add_notes(const UpdatingProblem& problem, const SampledPosterior& posterior, UpdatingResult& result) {
  result.notes.push_back(
      "The standard deviations of this method say how well parameters are known that all specimens have in common; "
      "they "
      "do not describe the scatter of specimens, and fall with the number of tests.");
  if (posterior.modes.size() > 1) {
    std::vector<std::string> shares;
    for (const PosteriorMode& mode : posterior.modes) shares.push_back(fmt::format("{:.3f}", mode.probability));
    result.warnings.push_back(fmt::format(
        "The posterior has {} separate modes, of probability {}: mean and standard deviations describe none of them.",
        posterior.modes.size(), join(shares)));
  }
  if (posterior.failed_runs > 0) {
    result.notes.push_back(
        fmt::format("{} of {} model runs of the sampler failed; their parameters have likelihood "
                    "zero.",
                    posterior.failed_runs, posterior.evaluations));
  }
  note_model_error(problem, "bayes",
                   "is integrated out of the likelihood: it is shared by all specimens, and what is known of the "
                   "parameters does not fall below it with their number.",
                   result);
}

/// The smallest effective sample size of a parameter; nothing where none is known, as of a prior without width.
std::optional<double> least_effective(const SampledPosterior& posterior) {
  double least = std::numeric_limits<double>::infinity();
  for (const double size : posterior.ess_bulk) least = size < least ? size : least;
  return std::isfinite(least) ? std::optional<double>(least) : std::nullopt;
}

/// Of each output: as given, or the mean over the draws.
Eigen::VectorXd noise_variances(const NoiseLevels& noise, const SampledPosterior& posterior) {
  if (noise.is_known()) return noise.variances(Eigen::VectorXd());
  Eigen::VectorXd sum = noise.variances(posterior.values.row(0).tail(noise.count()).transpose());
  for (Eigen::Index s = 1; s < posterior.values.rows(); ++s) {
    sum += noise.variances(posterior.values.row(s).tail(noise.count()).transpose());
  }
  return sum / static_cast<double>(posterior.values.rows());
}

/// What became of gradients: why there were none, trajectories that diverged.
void note_gradients(const SampledPosterior& posterior, const PosteriorTarget& target, const BayesOptions& options,
                    UpdatingResult& result) {
  constexpr double k_many_divergences = 0.01;
  const auto dimension = static_cast<Eigen::Index>(posterior.names.size());
  if (!target.has_gradient() && options.gradients != GradientMoves::never && dimension > k_many_dimensions) {
    result.notes.push_back(fmt::format(
        "The model has no derivatives that are cheaper than differences: its {} parameters were moved without "
        "gradients, which takes more model runs.",
        dimension));
  }
  if (posterior.divergences() == 0) return;
  const double fraction = static_cast<double>(posterior.divergences()) / static_cast<double>(posterior.trajectories());
  (fraction > k_many_divergences ? result.warnings : result.notes)
      .push_back(fmt::format("{} of {} trajectories along gradients diverged and were rejected{}",
                             posterior.divergences(), posterior.trajectories(),
                             fraction > k_many_divergences
                                 ? ": the posterior has narrow or kinked places that may be sampled too seldom."
                                 : "."));
}

PosteriorPeak peak_of(const UpdatingProblem& problem, const std::vector<SampledIsland>& islands,
                      const PosteriorTarget& target, const RunContext& context, std::int64_t& evaluations) {
  double highest = -std::numeric_limits<double>::infinity();
  Eigen::MatrixXd at;
  for (const SampledIsland& island : islands) {
    Eigen::Index row = 0;
    const Eigen::VectorXd density = island.log_likelihood - 0.5 * island.points.rowwise().squaredNorm();
    if (density.maxCoeff(&row) <= highest) continue;
    highest = density(row);
    at = island.points.row(row);
  }
  PosteriorPeak peak{.parameters = target.parameters(at).row(0).transpose()};
  const auto outputs = evaluate_one(problem, peak.parameters, context, evaluations);
  if (!outputs) throw ModelFailure("the model fails at the most probable parameters when it is run there again");
  peak.outputs = *outputs;
  const Eigen::VectorXd prior_std = problem.space.prior().covariance().diagonal().cwiseSqrt();
  peak.sensitivity = model_jacobian(problem, peak.parameters, prior_std, context, evaluations);
  return peak;
}

SamplingSettings settings_of(const BayesOptions& options) {
  return {.islands = options.islands,
          .particles = options.particles,
          .effective_fraction = options.effective_fraction,
          .decorrelation = options.decorrelation,
          .max_moves = options.max_moves,
          .gradients = options.gradients};
}

std::shared_ptr<SampledPosterior> put_together(const UpdatingProblem& problem, const NoiseLevels& noise,
                                               const PosteriorTarget& target,
                                               const std::vector<SampledIsland>& islands) {
  std::vector<std::string> names = problem.space.names();
  names.insert(names.end(), noise.names().begin(), noise.names().end());
  const Eigen::Index particles = islands.front().points.rows();
  Eigen::MatrixXd points(static_cast<Eigen::Index>(islands.size()) * particles, islands.front().points.cols());
  for (std::size_t i = 0; i < islands.size(); ++i) {
    points.middleRows(static_cast<Eigen::Index>(i) * particles, particles) = islands[i].points;
  }
  SampledPosterior posterior = make_posterior(islands, std::move(names), target.values(points));
  posterior.failed_runs = target.failed();
  posterior.evaluations = target.evaluations();
  posterior.gradients = target.gradients();
  return std::make_shared<SampledPosterior>(std::move(posterior));
}

UpdatingResult stopped(UpdatingResult result, const UpdatingProblem& problem, const std::string& when) {
  result.status = UpdatingStatus::stopped;
  result.message = "stopped on request " + when;
  result.mean = problem.space.prior().mean();
  result.covariance = problem.space.prior().covariance();
  return result;
}

}  // namespace

const OptionTable<BayesOptions>& bayes_option_table() {
  static const OptionTable<BayesOptions> table =
      OptionTable<BayesOptions>()
          .choice<BayesOptions::Noise>(
              "noise", &BayesOptions::noise,
              {{"automatic", BayesOptions::Noise::automatic},
               {"given", BayesOptions::Noise::given},
               {"estimated", BayesOptions::Noise::estimated}},
              "Measurement noise: as given by [test] repeatability, or of unknown level, one for "
              "each kind of output, which is sampled with the parameters. Automatic: of unknown "
              "level for the outputs without repeatability.")
          .choice<BayesOptions::NoisePrior>(
              "noise_prior", &BayesOptions::noise_prior,
              {{"half-t", BayesOptions::NoisePrior::half_t},
               {"inverse-gamma", BayesOptions::NoisePrior::inverse_gamma}},
              "Prior of a level: its standard deviation half-t, or its variance inverse gamma "
              "(scaled inverse chi-squared).")
          .number("noise_scale", &BayesOptions::noise_scale, {.lower = 0.0, .excludes_lower = true},
                  "fraction of the value",
                  "Scale of that prior, as a fraction of the root mean square of the tested values.")
          .number("noise_degrees_of_freedom", &BayesOptions::noise_degrees_of_freedom, {.lower = 1.0, .upper = 1e6},
                  "-", "Degrees of freedom of that prior: few leave a level of many times its scale possible.")
          .integer("islands", &BayesOptions::islands, {.lower = 8.0, .upper = 256.0}, "-",
                   "Number of independent islands of particles; their spread gives the standard error of the evidence.")
          .integer("particles", &BayesOptions::particles, {.lower = 100.0, .upper = 100000.0}, "-",
                   "Number of particles of each island, which are the draws of its chain; of all islands at most "
                   "2,000,000.")
          .number("effective_fraction", &BayesOptions::effective_fraction, {.lower = 0.1, .upper = 0.99}, "-",
                  "Fraction of the particles that the weights of a stage leave effective; a larger one makes more and "
                  "shorter stages.")
          .number(
              "decorrelation", &BayesOptions::decorrelation, {.lower = 0.02, .upper = 0.9}, "-",
              "Moves of a stage go on until no parameter, no square of one and not the log-likelihood is correlated "
              "more with its value at the stage's start, or no more than chance has it among so many particles.")
          .integer("max_moves", &BayesOptions::max_moves, {.lower = 1.0, .upper = 60000.0}, "-",
                   "Largest number of moves of a particle in a stage.")
          .choice<GradientMoves>("gradients", &BayesOptions::gradients,
                                 {{"automatic", GradientMoves::automatic},
                                  {"always", GradientMoves::always},
                                  {"never", GradientMoves::never}},
                                 "Moves along gradients of the likelihood, where the model has derivatives that are no "
                                 "dearer than differences. Automatic: where more than 15 parameters and levels of the "
                                 "noise are sampled.");
  return table;
}

UpdatingResult BayesUpdater::update(const UpdatingProblem& problem, const RunContext& context) const {
  constexpr int k_max_draws = 2000000;
  require_of(options_.islands <= k_max_draws / options_.particles, {Subject::Kind::option, "bayes.particles"},
             "{} islands of {} particles are more than {} draws; take fewer", options_.islands, options_.particles,
             k_max_draws);
  const TestMoments tests = test_moments(problem.tests);
  const NoiseLevels noise(problem, options_);
  const CommonLikelihood likelihood(problem.tests);
  UpdatingResult result;
  append_state(result, record_state(problem, tests, problem.space.prior(), 0, context));
  if (context.stop_requested()) return stopped(std::move(result), problem, "before the first stage");
  context.phase({.name = "sampling of the posterior"});
  PosteriorTarget target(problem, noise, likelihood, context);
  std::vector<SampledIsland> islands;
  try {
    islands = sample_posterior(target.target(), settings_of(options_), context);
  } catch (const Stopped&) {
    return stopped(std::move(result), problem, "while the posterior was sampled");
  }
  result.model_evaluations += target.evaluations();
  const std::shared_ptr<SampledPosterior> posterior = put_together(problem, noise, target, islands);
  const bool is_finished =
      std::all_of(islands.begin(), islands.end(), [](const SampledIsland& island) { return island.is_finished; });
  conclude(*posterior, options_, is_finished, result);
  result.set_estimate(std::make_shared<SampleEstimate>(
      problem.space.transforms(), posterior->values.leftCols(problem.space.count()), Eigen::VectorXd(),
      posterior->evidence.log_evidence, least_effective(*posterior)));
  const RegionalProblem near(problem, target.region());
  context.phase({.name = "outputs of the posterior"});
  result.model_evaluations += add_outputs(near.problem(), noise, likelihood, context, *posterior);
  append_state(result, record_state(near.problem(), tests, *result.estimate, context));
  context.phase({.name = "tests of the posterior"});
  const PosteriorPeak peak = peak_of(near.problem(), islands, target, context, result.model_evaluations);
  result.sensitivity = peak.sensitivity;
  result.noise_covariance = noise_variances(noise, *posterior).asDiagonal();
  result.posterior = posterior;
  add_notes(problem, *posterior, result);
  note_specimens(problem.tests, *posterior, result);
  note_gradients(*posterior, target, options_, result);
  test_posterior(problem, likelihood, noise, peak, result);
  return result;
}

}  // namespace mottle::updating
