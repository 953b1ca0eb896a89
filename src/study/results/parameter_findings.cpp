#include "study/results/parameter_findings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/text.hpp"
#include "mottle/updating/methods/interval.hpp"

namespace mottle::study {
namespace {

using Mark = ParameterFinding::Mark;

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
constexpr double k_tail = 0.025;
constexpr double k_normal_95 = 1.959963984540054;

/// Where a normal or a posterior estimate has 95 % of its probability; a population's is that of its mean; all of a
/// box.
Eigen::Vector2d interval_of(const UpdatingResult& result, Eigen::Index i) {
  if (result.interval) return {result.interval->box.lower(i), result.interval->box.upper(i)};
  if (result.intervals) return result.intervals->mean.row(i).transpose();
  if (result.is_population || !result.estimate) return Eigen::Vector2d::Constant(k_nan);
  if (!(result.covariance(i, i) > 0.0)) return Eigen::Vector2d::Constant(k_nan);
  return {result.estimate->quantile(i, k_tail), result.estimate->quantile(i, 1.0 - k_tail)};
}

Eigen::Vector2d prior_interval_of(const ParameterSpace& space, Eigen::Index i) {
  const std::vector<Distribution>& marginals = space.prior().marginals();
  if (!marginals.empty()) {
    const Distribution& prior = marginals[static_cast<std::size_t>(i)];
    return {prior.quantile(k_tail), prior.upper_quantile(k_tail)};
  }
  const double half = k_normal_95 * std::sqrt(space.prior().covariance()(i, i));
  return {space.prior().mean()(i) - half, space.prior().mean()(i) + half};
}

/// The combination that keeps a parameter from being seen; empty: there is none.
std::string unseen_reason(const Identifiability* seen, const std::vector<std::string>& names, Eigen::Index i) {
  constexpr double k_seen_wholly = 0.01;  // of the prior variance
  if (seen == nullptr) return {};
  double variance = 0.0;
  const Eigen::VectorXd* most = nullptr;
  for (const Eigen::VectorXd& direction : seen->unseen_directions) {
    variance += direction(i) * direction(i);
    if (most == nullptr || std::abs(direction(i)) > std::abs((*most)(i))) most = &direction;
  }
  if (most == nullptr || variance < k_seen_wholly) return {};
  return unseen_text(*most, names) + '.';
}

std::string bound_reason(const ParameterSpace& space, const UpdatingResult& result, Eigen::Index i, int side) {
  const Parameter& parameter = space.parameters()[static_cast<std::size_t>(i)];
  const bool is_median = result.is_population && parameter.transform.kind != ParameterTransform::Kind::identity;
  return fmt::format(
      "Its {} stopped on the {} bound, {:.6g}{}: the tests ask for more than the bound allows, or do not "
      "determine it.",
      is_median ? "median" : "mean", side < 0 ? "lower" : "upper", result.location()(i),
      is_median ? fmt::format(" (the mean of that population is {:.4g})", result.mean(i)) : "");
}

std::string doubt_of(const UpdatingResult& result, Conclusion conclusion) {
  if (conclusion == Conclusion::inadequate) {
    return "A test refused the model: this value may make up for an error elsewhere and is not a physical value.";
  }
  if (result.status != UpdatingStatus::converged) return "The update did not converge: further iterations may move it.";
  return {};
}

/// Mark and reason of a parameter of a box. How wide an end lies says how far the parameter varies, not how well it is
/// known: a box wider than the prior is no sign that the tests say little.
void judge_box(const UpdatingProblem& problem, const UpdatingResult& result, Conclusion conclusion,
               const std::string& unseen, ParameterFinding& finding, Eigen::Index i) {
  const ParameterBox& box = result.interval->box;
  constexpr double k_at_end = 1e-3;  // of the width: the search stops a little inside of what the bounds allow
  const Parameter& parameter = problem.space.parameters()[static_cast<std::size_t>(i)];
  const double slack = k_at_end * (box.upper(i) - box.lower(i));
  const bool is_at_lower = box.lower(i) <= parameter.lower_bound + slack;
  const bool is_at_upper = box.upper(i) >= parameter.upper_bound - slack;
  const std::string doubt = doubt_of(result, conclusion);
  if (!unseen.empty()) {
    finding.mark = Mark::not_seen;
    finding.reason = unseen;
  } else if (is_at_lower || is_at_upper) {
    finding.mark = Mark::at_bound;
    finding.reason =
        fmt::format("Its box ends on {}: to cover the tests' bounds it may have to be wider than the bounds allow.",
                    is_at_lower && is_at_upper
                        ? fmt::format("both bounds, {:.6g} and {:.6g}", parameter.lower_bound, parameter.upper_bound)
                        : fmt::format("the {} bound, {:.6g}", is_at_lower ? "lower" : "upper",
                                      is_at_lower ? parameter.lower_bound : parameter.upper_bound));
  } else if (!doubt.empty()) {
    finding.mark = Mark::doubtful;
    finding.reason = doubt;
  } else {
    finding.mark = Mark::found;
    finding.reason = "Bounds, if the model is right: the box is the smallest that covers the tests' bounds.";
  }
}

/// Mark and reason of a parameter whose intervals are set.
void judge_parameter(const UpdatingProblem& problem, const UpdatingResult& result, Conclusion conclusion,
                     const std::string& unseen, ParameterFinding& finding, Eigen::Index i) {
  constexpr double k_as_wide_as_prior = 0.9;
  constexpr double k_wider = 1.2;
  if (result.interval) return judge_box(problem, result, conclusion, unseen, finding, i);
  const int side = problem.space.active_bounds(result.location())(i);
  const bool has_others = result.intervals && result.intervals->mean.array().isFinite().any();
  const double width = finding.interval(1) - finding.interval(0);
  const double prior_width = finding.prior_interval(1) - finding.prior_interval(0);
  const std::string doubt = doubt_of(result, conclusion);
  const auto set = [&finding](Mark mark, std::string reason) {
    finding.mark = mark;
    finding.reason = std::move(reason);
  };
  if (side != 0) return set(Mark::at_bound, bound_reason(problem.space, result, i, side));
  if (!unseen.empty()) return set(Mark::not_seen, unseen);
  if (has_others && std::isnan(width)) return set(Mark::not_seen, "The tests do not determine its mean.");
  if (width >= k_as_wide_as_prior * prior_width) {
    return set(Mark::not_seen,
               fmt::format("Its interval is {}: the tests say little of it.",
                           width < k_wider * prior_width
                               ? "about as wide as the prior's"
                               : fmt::format("{:.2g} times as wide as the prior's", width / prior_width)));
  }
  if (!doubt.empty()) return set(Mark::doubtful, doubt);
  if (!result.is_population) {
    return set(Mark::mean_only, "The mean alone, if the model is right: this method does not estimate the scatter.");
  }
  set(Mark::found, "The tests determine it, if the model is right.");
}

}  // namespace

std::string mark_text(ParameterFinding::Mark mark) {
  switch (mark) {
    case Mark::found:
      return "found";
    case Mark::mean_only:
      return "mean-only";
    case Mark::at_bound:
      return "at-bound";
    case Mark::not_seen:
      return "not-seen";
    default:
      return "doubtful";
  }
}

std::vector<ParameterFinding> find_parameters(const UpdatingProblem& problem, const UpdatingResult& result,
                                              Conclusion conclusion, const Identifiability* seen) {
  std::vector<ParameterFinding> findings;
  for (Eigen::Index i = 0; i < result.mean.size(); ++i) {
    ParameterFinding finding;
    finding.interval = interval_of(result, i);
    finding.prior_interval = prior_interval_of(problem.space, i);
    judge_parameter(problem, result, conclusion, unseen_reason(seen, problem.space.names(), i), finding, i);
    findings.push_back(std::move(finding));
  }
  return findings;
}

Json findings_json(const std::vector<ParameterFinding>& findings) {
  Json list = Json::array();
  for (const ParameterFinding& finding : findings) {
    list.push_back({{"mark", mark_text(finding.mark)},
                    {"interval95", to_json(finding.interval)},
                    {"prior95", to_json(finding.prior_interval)},
                    {"reason", finding.reason}});
  }
  return list;
}

}  // namespace mottle::study
