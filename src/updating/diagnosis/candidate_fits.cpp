#include "updating/diagnosis/candidate_fits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"
#include "updating/fits/scaled_parameters.hpp"
#include "updating/population/model_error.hpp"
#include "updating/population/population_report.hpp"

namespace mottle::updating {
namespace {

// Of specimens' fits, in prior standard deviations: what it leaves changes a log-likelihood by the square.
constexpr double k_specimen_tolerance = 1e-4;

// A fit whose log-likelihood still changes by more than k_settled an iteration after so many does not converge.
constexpr int k_settling_iterations = 6;
constexpr double k_settled = 1.0;

/// Plain maximum likelihood wants few rows of its own: the noise that the given parameters and one more leave over.
NoiseModel common_noise(const UpdatingProblem& problem, const TestData& tests, Eigen::Index given) {
  std::vector<Eigen::Index> members;
  const Eigen::Index judged = std::min(given + 1, problem.space.count());
  for (Eigen::Index i = 0; i < judged; ++i) members.push_back(i);
  const Eigen::Index p = tests.values.cols();
  const bool is_known = (tests.repeatability_std.array() > 0.0).all();
  require(is_known || p != judged,
          "diagnose: with {} outputs the noise cannot be distinguished from a candidate in addition to {} "
          "parameters; give [test] repeatability",
          p, given);
  const ParameterSpace space = part_of(problem.space, members);
  const UpdatingProblem part{.model = problem.model, .space = space, .tests = tests};
  return noise_model(part, {});
}

double likelihood_ratio_p(double log_likelihood_increase, bool is_random) {
  const double ratio = std::max(2.0 * log_likelihood_increase, 0.0);
  const double one = chi_squared_upper_tail(ratio, 1.0);
  return is_random ? 0.5 * (one + chi_squared_upper_tail(ratio, 2.0)) : one;
}

}  // namespace

void note_increase(double log_likelihood_increase, Eigen::Index specimens, CandidateFit& fit) {
  const double added = fit.is_random ? 2.0 : 1.0;
  fit.log_likelihood_increase = log_likelihood_increase;
  fit.bic = added * std::log(static_cast<double>(specimens)) - 2.0 * log_likelihood_increase;
  fit.p_value = likelihood_ratio_p(log_likelihood_increase, fit.is_random);
  fit.adjusted_p = fit.p_value;
}

ParameterSet ParameterSet::with(Eigen::Index member, bool is_random) const {
  ParameterSet more = *this;
  more.members.push_back(member);
  more.has_scatter.push_back(is_random);
  return more;
}

CandidateFits::CandidateFits(const UpdatingProblem& problem, const DiagnosisSettings& settings,
                             const RunContext& context)
    : problem_(problem),
      settings_(settings),
      context_(context),
      signs_(shape_signs(problem.model.outputs(), problem.tests.values)),
      tests_(problem.tests) {
  turn_shapes(signs_, tests_.values);
  noise_ = common_noise(problem, tests_, settings.given);
  // An estimated level would take up whatever a candidate explains of the means: only a given error is used here.
  if (!tests_.is_model_error_estimated) model_error_ = model_error_model(problem);
}

bool CandidateFits::has_room_for(Eigen::Index count) const {
  return noise_.factors == 0 || tests_.values.cols() > count;
}

std::vector<int> CandidateFits::groups_of(const ParameterSet& set) const {
  std::vector<int> groups;
  int next = 0;
  for (const int group : problem_.covariance_groups) next = std::max(next, group + 1);
  next = std::max(next, 1);
  for (const Eigen::Index member : set.members) {
    const bool is_given = member < settings_.given;
    const bool is_free = problem_.covariance_groups.empty();
    groups.push_back(!is_given ? next++ : is_free ? 0 : problem_.covariance_groups[static_cast<std::size_t>(member)]);
  }
  return groups;
}

PopulationFit CandidateFits::fit_from(const UpdatingProblem& part, const ParameterSet& set,
                                      const Eigen::VectorXd& start) {
  const PopulationFitSettings rules{.noise = noise_,
                                    .has_noise_of_residuals = false,
                                    .model_error = model_error_,
                                    .is_restricted = false,
                                    .rank_tolerance = settings_.rank_tolerance,
                                    .iterations = problem_.iterations,
                                    .tolerance = problem_.tolerance,
                                    .specimen_tolerance = k_specimen_tolerance,
                                    .has_scatter = set.has_scatter,
                                    .start = start};
  // A candidate whose linear models change from iteration to iteration, a spring that is nearly rigid say, never
  // settles.
  const bool has_candidate = static_cast<Eigen::Index>(set.members.size()) > settings_.given;
  double last = -std::numeric_limits<double>::infinity();
  bool settles = true;
  PopulationFit fit = fit_population(part, tests_.values, rules, context_, [&](const PopulationFit& now) {
    context_.throw_if_stopped();
    const double change = std::abs(now.effects.log_likelihood - std::exchange(last, now.effects.log_likelihood));
    settles = !has_candidate || now.iterations < k_settling_iterations || change <= k_settled;
    return settles;
  });
  evaluations_ += fit.evaluations;
  if (!settles) throw ModelFailure("its fit does not converge");
  return fit;
}

SetFit CandidateFits::fit(const ParameterSet& set, const Eigen::VectorXd& start) {
  const ParameterSpace space = part_of(problem_.space, set.members);
  const FixedParameterModel model(problem_, problem_.space.prior().mean(), set.members, signs_);
  const UpdatingProblem part{.model = model,
                             .derivatives = model.derivatives(),
                             .space = space,
                             .tests = tests_,
                             .iterations = problem_.iterations,
                             .level = problem_.level,
                             .tolerance = problem_.tolerance,
                             .covariance_groups = groups_of(set)};
  SetFit result;
  try {
    result.fit = fit_from(part, set, start);
    const auto population =
        JointDistribution::transformed_normal(space.transforms(), result.fit.mean, result.fit.covariance);
    result.mean = population.mean();
    result.covariance = population.covariance();
    result.standard_deviation = result.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    result.location = to_variables(space.transforms(), result.fit.mean.transpose()).row(0);
    result.unbounded = to_variables(space.transforms(), result.fit.unbounded_mean.transpose()).row(0);
    result.bound_cost = result.fit.unbounded_log_likelihood - result.fit.effects.log_likelihood;
    result.residuals = residuals_of(result.fit.units, result.fit.effects);
    const Eigen::VectorXi active = space.active_bounds(result.location);
    for (std::size_t i = 0; i < set.members.size(); ++i) {
      if (set.members[i] < settings_.given && active(static_cast<Eigen::Index>(i)) != 0) result.is_within = false;
    }
    if (!std::isfinite(result.fit.effects.log_likelihood)) result.failure = "the likelihood is not finite";
  } catch (const ModelFailure& error) {
    result.failure = error.what();
  }
  return result;
}

double CandidateFits::distance_beside(const ParameterSet& set, const Eigen::VectorXd& nominal, const TestMoments& tests,
                                      const Eigen::VectorXd& origin, Eigen::VectorXd& t) {
  const ParameterSpace space = part_of(problem_.space, set.members);
  const FixedParameterModel model(problem_, nominal, set.members, signs_);
  const UpdatingProblem part{.model = model, .derivatives = model.derivatives(), .space = space, .tests = tests_};
  PriorOnScales prior = prior_on_scales(space);
  if (origin.size() > 0) prior.mean = origin;
  try {
    const SpecimenFits centre =
        fit_specimens(part, tests.mean.transpose(), {prior.mean, prior.covariance, noise_.base},
                      {prior.mean.transpose(), {}, k_specimen_tolerance}, context_, evaluations_);
    t = ScaledParameters(space).clamp(centre.points.row(0).transpose());
    const Eigen::VectorXd y = outputs_on_scales(part, t.transpose(), context_, evaluations_).row(0);
    const Eigen::ArrayXd variance = (tests.covariance.diagonal() + noise_.base).array().max(1e-300);
    const double distance = ((tests.mean - y).array().square() / variance).sum();
    return std::isfinite(distance) ? distance : std::numeric_limits<double>::infinity();
  } catch (const ModelFailure&) {
    return std::numeric_limits<double>::infinity();
  }
}

std::vector<Eigen::VectorXd> CandidateFits::starts_beside(const ParameterSet& set, const SetFit& base,
                                                          Eigen::Index candidate) {
  // The given parameters alone may be misled: their prior is then the better place to start from.
  const bool is_extended = static_cast<Eigen::Index>(set.members.size()) > settings_.given;
  const Eigen::VectorXd origin = is_extended ? base.fit.mean : Eigen::VectorXd();
  constexpr double k_steps[] = {0.0, -2.0, 2.0, 5.0, 10.0, 15.0};  // of the candidate's prior deviation
  constexpr double k_alike = 0.01;                                 // squared deviations of the tests, all outputs
  constexpr std::size_t k_max = 4;
  const TestMoments tests = test_moments(tests_);
  const double scale = std::sqrt(problem_.space.prior().covariance()(candidate, candidate));
  const Parameter& parameter = problem_.space.parameters()[static_cast<std::size_t>(candidate)];
  std::vector<std::pair<double, Eigen::VectorXd>> found;
  double best = std::numeric_limits<double>::infinity();
  for (const double step : k_steps) {
    Eigen::VectorXd nominal = problem_.space.prior().mean();
    nominal(candidate) += step * scale;
    if (!problem_.space.is_possible(nominal) || nominal(candidate) < parameter.lower_bound ||
        nominal(candidate) > parameter.upper_bound) {
      continue;
    }
    Eigen::VectorXd t;
    const double distance = distance_beside(set, nominal, tests, origin, t);
    if (!std::isfinite(distance)) continue;
    best = std::min(best, distance);
    Eigen::VectorXd start(t.size() + 1);
    start << t, parameter.transform.from_variable(nominal(candidate));
    found.emplace_back(distance, std::move(start));
  }
  std::vector<Eigen::VectorXd> starts;
  for (auto& [distance, start] : found) {
    if (distance <= best + k_alike && starts.size() < k_max) starts.push_back(std::move(start));
  }
  return starts;
}

CandidateFit CandidateFits::compare(const ParameterSet& set, const SetFit& base, Eigen::Index candidate, bool is_random,
                                    const Eigen::VectorXd& start) {
  const SetFit more = fit(set.with(candidate, is_random), start);
  CandidateFit result;
  result.is_random = is_random;
  result.failure = more.failure;
  if (!more.failure.empty()) return result;
  note_increase(more.fit.effects.log_likelihood - base.fit.effects.log_likelihood, specimens(), result);
  const Eigen::Index last = more.mean.size() - 1;
  result.mean = more.mean(last);
  if (is_at_limit(candidate, more.unbounded(last), more.location(last)))
    note_limit(more.unbounded(last), more.bound_cost, result);
  result.residuals = more.residuals;
  result.standard_deviation = more.standard_deviation(last);
  result.is_within = more.is_within;
  result.converged = more.fit.converged;
  return result;
}

std::pair<CandidateFit, CandidateFit> CandidateFits::compare_both(const ParameterSet& set, const SetFit& base,
                                                                  Eigen::Index candidate) {
  constexpr double k_worse = -0.05;  // a nested model's likelihood is no lower, but for the tolerance of the fits
  CandidateFit fixed;
  fixed.failure = "the model fails for every value of the candidate that was tried";
  Eigen::VectorXd from;
  const auto fit_from_start = [&](const Eigen::VectorXd& start) {
    context_.throw_if_stopped();
    const CandidateFit next = compare(set, base, candidate, false, start);
    const bool is_better = fixed.failure.empty() ? next.log_likelihood_increase > fixed.log_likelihood_increase : true;
    if (!next.failure.empty() || !is_better) {
      if (!fixed.failure.empty()) fixed.failure = next.failure;
      return;
    }
    fixed = next;
    from = start;
  };
  for (const Eigen::VectorXd& start : starts_beside(set, base, candidate)) fit_from_start(start);
  if (!fixed.failure.empty() || fixed.log_likelihood_increase < k_worse) {
    Eigen::VectorXd at_base(base.fit.mean.size() + 1);
    const Parameter& parameter = problem_.space.parameters()[static_cast<std::size_t>(candidate)];
    at_base << base.fit.mean, parameter.transform.from_variable(problem_.space.prior().mean()(candidate));
    fit_from_start(at_base);
  }
  CandidateFit random = fixed;
  random.is_random = true;
  if (from.size() > 0) random = compare(set, base, candidate, true, from);
  return {fixed, random};
}

SetFit CandidateFits::fit_beside(const ParameterSet& set, const SetFit& base, Eigen::Index candidate, bool is_random) {
  SetFit best;
  best.failure = "the model fails for every value of the candidate that was tried";
  for (const Eigen::VectorXd& start : starts_beside(set, base, candidate)) {
    SetFit next = fit(set.with(candidate, is_random), start);
    const bool is_better = !best.failure.empty() || next.fit.effects.log_likelihood > best.fit.effects.log_likelihood;
    if (next.failure.empty() && is_better) best = std::move(next);
  }
  return best;
}

}  // namespace mottle::updating
