#include "updating/methods/sampled_result.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"
#include "mottle/updating/estimate/posterior.hpp"

namespace mottle::updating {
namespace {

constexpr double k_max_r_hat = 1.01;  // [Vehtari2021]
constexpr double k_max_spread = 1.0;  // of the islands' ln evidences: beyond, the mean of the evidences is that of one

/// What keeps the islands from being one sample, in words.
std::vector<std::string> doubts_of(const SampledPosterior& posterior, const std::string& method,
                                   const BayesOptions& options) {
  std::vector<std::string> doubts;
  for (std::size_t k = 0; k <= posterior.names.size(); ++k) {
    const double r_hat = posterior.r_hat(static_cast<Eigen::Index>(k));
    if (!(r_hat > k_max_r_hat)) continue;
    doubts.push_back(fmt::format(
        "The islands disagree: R-hat of {} is {:.4f}, at most {} is allowed; give more "
        "particles ({}.particles).",
        k < posterior.names.size() ? posterior.names[k] : "the log-likelihood", r_hat, k_max_r_hat, method));
  }
  if (posterior.evidence.spread > k_max_spread) {
    doubts.push_back(fmt::format(
        "The islands disagree on the evidence: the standard deviation of its logarithm is {:.2g}, at most {} is "
        "allowed; give more particles ({}.particles).",
        posterior.evidence.spread, k_max_spread, method));
  }
  double worst = 0.0;
  std::size_t short_stages = 0;
  for (const std::vector<SamplingStage>& stages : posterior.stages) {
    for (const SamplingStage& stage : stages) {
      if (stage.is_decorrelated) continue;
      ++short_stages;
      worst = std::max(worst, stage.correlation);
    }
  }
  if (short_stages > 0) {
    doubts.push_back(fmt::format(
        "In {} the moves allowed did not decorrelate the particles from their start (a correlation of {:.2f} "
        "was left, {} is asked for); give more moves ({}.max_moves).",
        short_stages == 1 ? "one stage" : fmt::format("{} stages", short_stages), worst, options.decorrelation,
        method));
  }
  return doubts;
}

/// What a run that ended at max_evaluations has, in words.
std::string reached_within(const SampledPosterior& posterior, const std::string& method, const BayesOptions& options) {
  const std::string end = fmt::format("ended at {}.max_evaluations = {} after {} model runs", method,
                                      options.max_evaluations, posterior.evaluations);
  const double exponent = smallest_exponent(posterior);
  if (exponent >= 1.0) {
    return end +
           ": the whole likelihood counts and the evidence is complete, but the last stage's moves are not, so that "
           "the "
           "draws may still resemble each other";
  }
  return fmt::format(
      "{}, before the posterior was reached: the draws are of prior times likelihood to the power {:.2g}, which is "
      "wider than the posterior, and there is no evidence",
      end, exponent);
}

}  // namespace

double smallest_exponent(const SampledPosterior& posterior) {
  double smallest = 1.0;
  for (const std::vector<SamplingStage>& stages : posterior.stages) {
    smallest = std::min(smallest, stages.empty() ? 0.0 : stages.back().exponent);
  }
  return smallest;
}

void require_draws(const std::string& method, const BayesOptions& options) {
  constexpr int k_max_draws = 2000000;
  require_of(options.islands <= k_max_draws / options.particles, {Subject::Kind::option, method + ".particles"},
             "{} islands of {} particles are more than {} draws; take fewer", options.islands, options.particles,
             k_max_draws);
}

SamplingSettings settings_of(const BayesOptions& options, double effective_fraction) {
  return {.islands = options.islands,
          .particles = options.particles,
          .effective_fraction = options.effective_fraction > 0.0 ? options.effective_fraction : effective_fraction,
          .decorrelation = options.decorrelation,
          .max_moves = options.max_moves,
          .max_evaluations = options.max_evaluations,
          .gradients = options.gradients};
}

void conclude_sampling(const SampledPosterior& posterior, const std::string& method, const BayesOptions& options,
                       bool is_finished, UpdatingResult& result) {
  const std::vector<std::string> doubts = doubts_of(posterior, method, options);
  const Evidence& evidence = posterior.evidence;
  const char* const source = evidence.source == EvidenceSource::islands ? "" : " by importance sampling";
  if (!is_finished) {
    result.status = UpdatingStatus::max_iterations;
    result.message = options.max_evaluations > 0 ? reached_within(posterior, method, options)
                                                 : "the stages ran out before the whole likelihood counted";
    result.warnings.push_back(result.message);
    return;
  }
  result.warnings.insert(result.warnings.end(), doubts.begin(), doubts.end());
  result.status = doubts.empty() ? UpdatingStatus::converged : UpdatingStatus::stalled;
  result.message = doubts.empty() ? fmt::format(
                                        "{} islands of {} particles agree: R-hat at most {:.4f}; ln evidence {:.4f}{}, "
                                        "standard error {:.2g}",
                                        posterior.chains, posterior.draws, posterior.r_hat.maxCoeff(),
                                        evidence.log_evidence, source, evidence.standard_error)
                                  : doubts.front();
}

void note_failed_runs(const SampledPosterior& posterior, const std::string& whose, UpdatingResult& result) {
  if (posterior.failed_runs == 0) return;
  result.notes.push_back(fmt::format("{} of {} model runs of the sampler failed; {} likelihood zero.",
                                     posterior.failed_runs, posterior.evaluations, whose));
}

UpdatingResult stopped_result(UpdatingResult result, const UpdatingProblem& problem, const std::string& when) {
  result.status = UpdatingStatus::stopped;
  result.message = "stopped on request " + when;
  result.mean = problem.space.prior().mean();
  result.covariance = problem.space.prior().covariance();
  return result;
}

std::optional<double> least_effective(const SampledPosterior& posterior) {
  double least = std::numeric_limits<double>::infinity();
  for (const double size : posterior.ess_bulk) least = size < least ? size : least;
  return std::isfinite(least) ? std::optional<double>(least) : std::nullopt;
}

Eigen::VectorXd mean_noise(const NoiseLevels& noise, const Eigen::Ref<const Eigen::MatrixXd>& levels) {
  if (noise.is_known()) return noise.variances(Eigen::VectorXd());
  Eigen::VectorXd sum = noise.variances(levels.row(0).transpose());
  for (Eigen::Index s = 1; s < levels.rows(); ++s) sum += noise.variances(levels.row(s).transpose());
  return sum / static_cast<double>(levels.rows());
}

}  // namespace mottle::updating
