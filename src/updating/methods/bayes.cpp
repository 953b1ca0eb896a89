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
#include "updating/fits/regional_problem.hpp"
#include "updating/methods/bayes_tests.hpp"
#include "updating/methods/common_likelihood.hpp"
#include "updating/methods/evidence_about_best.hpp"
#include "updating/methods/least_squares.hpp"
#include "updating/methods/posterior_outputs.hpp"
#include "updating/methods/posterior_target.hpp"
#include "updating/methods/sampled_result.hpp"
#include "updating/population/model_error.hpp"

namespace mottle::updating {
namespace {

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
  if (static_cast<Eigen::Index>(posterior.names.size()) > k_dimensions_of_evidence) {
    result.warnings.push_back(fmt::format(
        "The evidence of {} parameters is not to be relied on to its standard error: of a linear model with 60 it was "
        "0.19 too low, eight stated errors. Moments were right.",
        posterior.names.size()));
  }
  note_model_error(problem, "bayes",
                   "is integrated out of the likelihood: it is shared by all specimens, and what is known of the "
                   "parameters does not fall below it with their number.",
                   result);
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

/// Whether the importance sample is sound and much the more precise, and sees more than the islands do: what lies far
/// from the best parameters it may miss without a sign, a mode that the draws have not or the end of a ridge, and is
/// too low then.
bool is_better(const EvidenceAboutBest& about_best, const SampledPosterior& posterior) {
  constexpr double k_finite_variance = 0.5;
  constexpr double k_much_smaller = 0.5;
  return about_best.pareto_k < k_finite_variance &&
         about_best.standard_error < k_much_smaller * posterior.evidence.standard_error &&
         about_best.log_evidence > posterior.evidence.log_evidence;
}

/// Small levels of the noise of which a part of the posterior was not sampled: then no sampling is whole.
void judge_reach(const EvidenceAboutBest& about_best, const Evidence& islands, UpdatingResult& result) {
  constexpr double k_much = 0.06;
  constexpr double k_errors = 2.3;  // the stated interval of eight islands
  const double gap = about_best.log_evidence - islands.log_evidence;
  const double lacking = -std::expm1(-gap);
  if (!(lacking > k_much && gap > k_errors * std::hypot(about_best.standard_error, islands.standard_error))) return;
  std::string text = fmt::format(
      "The draws lack {:.0f} % of the posterior: importance sampling about the parameters that meet the tests best "
      "finds ln evidence {:.3f} +- {:.3f}, the islands {:.3f} +- {:.3f}. Noise far below its prior's scale is "
      "probable, which the sampler does not reach. Give [test] repeatability, more particles with a higher "
      "bayes.effective_fraction, or set bayes.noise_prior = \"inverse-gamma\".",
      100.0 * lacking, about_best.log_evidence, about_best.standard_error, islands.log_evidence,
      islands.standard_error);
  if (result.status == UpdatingStatus::converged) {
    result.status = UpdatingStatus::stalled;
    result.message = text;
  }
  result.warnings.push_back(std::move(text));
}

/// Of a part of the likelihood: it says nothing about the model.
void withhold_evidence(Evidence& evidence) {
  constexpr double k_unknown = std::numeric_limits<double>::quiet_NaN();
  evidence.log_evidence = evidence.standard_error = evidence.lower = evidence.upper = evidence.spread = k_unknown;
}

void require_evaluations(const BayesOptions& options) {
  const int least = 2 * options.islands * options.particles;
  require_of(options.max_evaluations == 0 || options.max_evaluations >= least,
             {Subject::Kind::option, "bayes.max_evaluations"},
             "{} model runs are too few: {} islands of {} particles need {} for the start and one move; allow more, or "
             "take fewer particles (bayes.particles)",
             options.max_evaluations, options.islands, options.particles, least);
}

std::optional<double> known_evidence(const SampledPosterior& posterior) {
  const double value = posterior.evidence.log_evidence;
  return std::isfinite(value) ? std::optional<double>(value) : std::nullopt;
}

/// The better evidence, and what it says of the draws.
void conclude(const std::optional<EvidenceAboutBest>& about_best, const BayesOptions& options,
              const std::vector<SampledIsland>& islands, SampledPosterior& posterior, UpdatingResult& result) {
  const bool is_finished = std::ranges::all_of(islands, &SampledIsland::is_finished);
  const bool is_reached = smallest_exponent(posterior) >= 1.0;
  if (!is_reached) withhold_evidence(posterior.evidence);
  const Evidence of_islands = posterior.evidence;
  if (is_reached && about_best && is_better(*about_best, posterior))
    take_importance_evidence(*about_best, posterior.evidence);
  conclude_sampling(posterior, "bayes", options, is_finished, result);
  if (is_reached && about_best) judge_reach(*about_best, of_islands, result);
}

PosteriorPeak peak_at(const UpdatingProblem& problem, const std::vector<SampledIsland>& islands, Eigen::Index draw,
                      const PosteriorTarget& target, const RunContext& context, std::int64_t& evaluations) {
  const Eigen::Index particles = islands.front().points.rows();
  const Eigen::MatrixXd at = islands[static_cast<std::size_t>(draw / particles)].points.row(draw % particles);
  PosteriorPeak peak{.scores = at.row(0).transpose(), .parameters = target.parameters(at).row(0).transpose()};
  const auto outputs = evaluate_one(problem, peak.parameters, context, evaluations);
  if (!outputs) throw ModelFailure("the model fails at the most probable parameters when it is run there again");
  peak.outputs = *outputs;
  const Eigen::VectorXd prior_std = problem.space.prior().covariance().diagonal().cwiseSqrt();
  peak.sensitivity = model_jacobian(problem, peak.parameters, prior_std, context, evaluations);
  return peak;
}

/// The highest of all, and where levels of the noise are sampled those of the other modes.
std::vector<PosteriorPeak> peaks_of(const UpdatingProblem& problem, const NoiseLevels& noise,
                                    const std::vector<SampledIsland>& islands, const SampledPosterior& posterior,
                                    const PosteriorTarget& target, const RunContext& context,
                                    std::int64_t& evaluations) {
  std::vector<PosteriorPeak> peaks = {peak_at(problem, islands, posterior.highest, target, context, evaluations)};
  if (noise.is_known()) return peaks;
  for (const PosteriorMode& mode : posterior.modes) {
    if (mode.highest == posterior.highest) continue;
    peaks.push_back(peak_at(problem, islands, mode.highest, target, context, evaluations));
  }
  return peaks;
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

}  // namespace

const OptionTable<BayesOptions>& bayes_option_table() {
  static const OptionTable<BayesOptions> table = [] {
    OptionTable<BayesOptions> made;
    add_sampling_options(made).integer_or(
        "max_evaluations", &BayesOptions::max_evaluations, {.lower = 1600.0, .upper = 2e9}, "unlimited", 0,
        "Largest number of model runs of the sampler. A run that reaches it ends there and says how much of the "
        "likelihood it had taken in; the outputs of the draws take `islands` times `particles` runs more.");
    return made.choice<GradientMoves>(
        "gradients", &BayesOptions::gradients,
        {{"automatic", GradientMoves::automatic}, {"always", GradientMoves::always}, {"never", GradientMoves::never}},
        "Moves along gradients of the likelihood, where the model has derivatives that are no dearer than "
        "differences. Automatic: where more than 15 parameters and levels of the noise are sampled.");
  }();
  return table;
}

UpdatingResult BayesUpdater::update(const UpdatingProblem& problem, const RunContext& context) const {
  constexpr double k_fine_fraction = 0.8;  // ln Z was 0.03 too low with 0.5, beside a second mode
  require_draws("bayes", options_);
  require_evaluations(options_);
  const TestMoments tests = test_moments(problem.tests);
  const NoiseLevels noise(problem, options_);
  const CommonLikelihood likelihood(problem.tests);
  UpdatingResult result;
  append_state(result, record_state(problem, tests, problem.space.prior(), 0, context));
  if (context.stop_requested()) return stopped_result(std::move(result), problem, "before the first stage");
  context.phase({.name = "sampling of the posterior"});
  PosteriorTarget target(problem, noise, likelihood, context);
  std::vector<SampledIsland> islands;
  try {
    islands = sample_posterior(
        target.target(), noise.is_known() ? settings_of(options_) : settings_of(options_, k_fine_fraction), context);
  } catch (const Stopped&) {
    return stopped_result(std::move(result), problem, "while the posterior was sampled");
  }
  const std::shared_ptr<SampledPosterior> posterior = put_together(problem, noise, target, islands);
  const RegionalProblem near(problem, target.region());
  context.phase({.name = "outputs of the posterior"});
  result.model_evaluations += add_outputs(near.problem(), noise, likelihood, context, *posterior);
  context.phase({.name = "tests of the posterior"});
  const std::vector<PosteriorPeak> peaks =
      peaks_of(near.problem(), noise, islands, *posterior, target, context, result.model_evaluations);
  const PosteriorPeak& peak = peaks.front();
  result.sensitivity = peak.sensitivity;
  const std::optional<EvidenceAboutBest> about_best =
      evidence_about_best(near.problem(), noise, likelihood, peaks, posterior->values.rightCols(noise.count()),
                          target.target(), context, result.model_evaluations);
  result.model_evaluations += target.evaluations();
  conclude(about_best, options_, islands, *posterior, result);
  result.set_estimate(
      std::make_shared<SampleEstimate>(problem.space.transforms(), posterior->values.leftCols(problem.space.count()),
                                       Eigen::VectorXd(), known_evidence(*posterior), least_effective(*posterior)));
  append_state(result, record_state(near.problem(), tests, *result.estimate, context));
  result.noise_covariance = mean_noise(noise, posterior->values.rightCols(noise.count())).asDiagonal();
  result.posterior = posterior;
  add_notes(problem, *posterior, result);
  note_specimens(problem.tests, *posterior, result);
  note_gradients(*posterior, target, options_, result);
  test_posterior(problem, likelihood, noise, peak, result);
  return result;
}

}  // namespace mottle::updating
