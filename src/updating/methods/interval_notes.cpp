#include "updating/methods/interval_notes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/text.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/methods/interval_targets.hpp"
#include "updating/population/model_error.hpp"

namespace mottle::updating {
namespace {

std::string output_name(const UpdatingProblem& problem, Eigen::Index k) {
  return problem.model.outputs()[static_cast<std::size_t>(k)].name();
}

void note_bounds(const IntervalResult& found, UpdatingResult& result) {
  const SpecimenBounds& tests = found.tests;
  const int fewest = tests.count.minCoeff();
  if (std::isnan(tests.confidence(0))) {
    result.warnings.push_back(fmt::format(
        "The box covers the observed bounds alone. The smallest and the largest of {} specimens have {:.3g} % of a "
        "population between them on average: the population's bounds are wider. Set interval.bounds = "
        "\"normal-tolerance\".",
        fewest, 100.0 * tests.expected_inside.minCoeff()));
  } else if (std::isnan(tests.factor(0))) {
    result.notes.push_back(fmt::format(
        "The box covers the observed bounds: those of each output contain at least {:.4g} % of its population with a "
        "confidence of {:.4g} %, whatever its distribution. The confidence is that of each output by itself.",
        100.0 * tests.content.minCoeff(), 100.0 * tests.confidence(0)));
  } else {
    result.notes.push_back(fmt::format(
        "The box covers normal tolerance limits: those of each output contain {:.4g} % of its population with a "
        "confidence of {:.4g} %, if the output is normal; with {} specimens they reach {:.4g} standard deviations from "
        "the mean. The confidence is that of each output by itself.",
        100.0 * tests.content(0), 100.0 * tests.confidence(0), fewest, tests.factor.maxCoeff()));
  }
}

void note_noise(const UpdatingProblem& problem, UpdatingResult& result) {
  const Eigen::MatrixXd covariance = test_moments(problem.tests).covariance;
  std::vector<std::string> parts;
  for (Eigen::Index k = 0; k < covariance.rows(); ++k) {
    const double noise = problem.tests.repeatability_std(k) * problem.tests.repeatability_std(k);
    if (!(noise > 0.01 * covariance(k, k))) continue;
    parts.push_back(
        fmt::format("{:.0f} % of {}", 100.0 * std::min(1.0, noise / covariance(k, k)), output_name(problem, k)));
  }
  if (parts.empty()) return;
  result.notes.push_back(
      "Measurement noise is not removed from the bounds, which makes the box wider; its part of the "
      "tests' variances: " +
      join(parts) + ".");
}

void note_scatterless(const UpdatingProblem& problem, const IntervalResult& found, UpdatingResult& result) {
  std::vector<std::string> names;
  for (Eigen::Index k = 0; k < found.tests.observed.rows(); ++k) {
    if (found.tests.observed(k, 0) == found.tests.observed(k, 1)) names.push_back(output_name(problem, k));
  }
  if (names.empty()) return;
  result.warnings.push_back(fmt::format(
      "All tests of {} are equal: bounds without width hold no population. Are they rounded, or one test copied?",
      join(names)));
}

/// Bounds that the box does not reach, and outputs that it was not asked to cover.
void note_uncovered(const UpdatingProblem& problem, const IntervalResult& found, UpdatingResult& result) {
  std::vector<std::string> short_of, left_out;
  for (Eigen::Index k = 0; k < found.excess.rows(); ++k) {
    const std::string& unit = problem.model.outputs()[static_cast<std::size_t>(k)].unit;
    if (is_left_out(found, k)) {
      left_out.push_back(fmt::format("{} ({:.3g} of {:.3g} {})", output_name(problem, k),
                                     found.reachable(k, 1) - found.reachable(k, 0),
                                     found.tests.limits(k, 1) - found.tests.limits(k, 0), unit));
      continue;
    }
    for (const Eigen::Index side : {0, 1}) {
      if (found.excess(k, side) >= 0.0) continue;
      short_of.push_back(fmt::format("{} ({:.3g} {} {})", output_name(problem, k), -found.excess(k, side), unit,
                                     side == 0 ? "at the lower end" : "at the upper end"));
    }
  }
  if (short_of.empty() && left_out.empty()) return;
  const std::string limits = limits_of_search(problem, found);
  const std::string advice = advice_on_limits(problem, found);
  if (!short_of.empty() && found.reachable.size() == 0) {
    result.warnings.push_back(
        fmt::format("The box does not cover {}. What could be covered is not known, as the model fails at the limits "
                    "of the search.",
                    join(short_of)));
  } else if (!short_of.empty()) {
    result.warnings.push_back(fmt::format("No box within {} covers {}: the box shown covers as much as can be.{}",
                                          limits, join(short_of), advice));
  }
  if (!left_out.empty()) {
    result.warnings.push_back(
        fmt::format("Within {} the parameters move {} by less than the bounds of the tests are apart: the box was not "
                    "asked to cover it.{}",
                    limits, join(left_out), advice));
  }
}

void note_image(const UpdatingProblem& problem, const IntervalResult& found, const std::vector<std::string>& crossing,
                UpdatingResult& result) {
  constexpr double k_wide = 2.0;
  std::vector<std::string> wide;
  for (Eigen::Index k = 0; k < found.excess.rows(); ++k) {
    const OutputRange& range = found.image[static_cast<std::size_t>(k)];
    const double asked = found.tests.limits(k, 1) - found.tests.limits(k, 0);
    if (asked > 0.0 && range.upper - range.lower > k_wide * asked) {
      wide.push_back(fmt::format("{} ({:.3g} times)", output_name(problem, k), (range.upper - range.lower) / asked));
    }
  }
  if (!wide.empty()) {
    result.warnings.push_back("The image of the box is much wider than the bounds to be covered: " + join(wide) +
                              ". A box lets all parameters be extreme together, and is an over-bound.");
  }
  if (!crossing.empty()) {
    result.warnings.push_back("In the box the modes of " + join(crossing) +
                              " may cross their neighbours, by which modes followed by their shapes change places: "
                              "their ranges were searched for and are not proven.");
  }
  const bool is_proven = std::ranges::all_of(found.image, [](const OutputRange& range) { return range.is_certified; });
  if (is_proven) {
    result.notes.emplace_back(
        "The image of the box is proven: no parameters in it give outputs beyond, by more than "
        "interval.range_tolerance.");
  } else if (!found.obstacle.empty()) {
    result.notes.push_back("The image of the box was searched for and is not proven, as " + found.obstacle + ".");
  } else {
    result.notes.emplace_back("The image of the box is not proven for all outputs: see interval.image in result.json.");
  }
}

void note_specimens(const UpdatingProblem& problem, const IntervalResult& found, UpdatingResult& result) {
  const auto n = static_cast<double>(problem.tests.values.rows());
  const double expected = std::isnan(found.tests.content(0)) ? 0.0 : (1.0 - found.tests.content(0)) * n;
  if (static_cast<double>(found.outside.size()) <= expected) return;
  result.warnings.push_back(fmt::format(
      "The own parameters of {} of {} specimens lie outside the box: to cover every output's bounds by itself is less "
      "than to hold every specimen. Their hull is interval.hull in result.json.",
      found.outside.size(), problem.tests.values.rows()));
}

}  // namespace

void describe_ending(const CoveringBox& covering, const CoverTask& task, UpdatingResult& result) {
  if (task.targets.col(0).minCoeff() == std::numeric_limits<double>::infinity()) {
    result.status = UpdatingStatus::stalled;
    result.message = "the parameters move none of the outputs: no box was looked for";
  } else if (covering.has_converged) {
    result.status = UpdatingStatus::converged;
    result.message = fmt::format(
        "the box is at rest: no smaller one near it covers {}; its widths are {:.4g} prior standard deviations "
        "together",
        covering.uncovered > 0.0 ? "as much" : "what is asked for", covering.measure);
  } else if (covering.uncovered > 0.0) {
    result.status = UpdatingStatus::stalled;
    result.message = "no step brings the image of the box nearer to the bounds of the tests";
  } else {
    result.status = UpdatingStatus::max_iterations;
    result.message = "the box covers, but a smaller one may: the iterations were used up";
  }
}

std::vector<std::string> undetermined_ends(const UpdatingProblem& problem, const ParameterBox& allowed,
                                           const CoveringBox& covering) {
  constexpr double k_no_width = 1e-6;  // prior standard deviations
  const Eigen::VectorXd prior_std = problem.space.prior().covariance().diagonal().cwiseSqrt();
  std::vector<std::string> sentences;
  std::vector<std::string> ends;
  for (Eigen::Index i = 0; i < prior_std.size(); ++i) {
    const std::string& name = problem.space.parameters()[static_cast<std::size_t>(i)].name;
    if (allowed.upper(i) - allowed.lower(i) <= k_no_width * prior_std(i)) continue;  // its bounds leave it none
    if (covering.box.upper(i) - covering.box.lower(i) <= k_no_width * prior_std(i)) {
      sentences.push_back(
          fmt::format("{} has no width: the smallest box covers what it was asked to without it, which does not show "
                      "that it does not vary.",
                      name));
      continue;
    }
    if (covering.is_undetermined(i, 0)) ends.push_back("the lower end of " + name);
    if (covering.is_undetermined(i, 1)) ends.push_back("the upper end of " + name);
  }
  if (!ends.empty()) {
    sentences.push_back("The bounds of the tests do not determine " + join(ends) +
                        ": to first order, other boxes of the same measure cover as well.");
  }
  return sentences;
}

void add_interval_notes(const UpdatingProblem& problem, const IntervalResult& found,
                        const std::vector<std::string>& crossing, UpdatingResult& result) {
  result.notes.emplace_back(
      "A box has no distribution: the mean is its middle, the standard deviations are those of parameters spread "
      "evenly "
      "and independently in it, width / sqrt(12), a convention by which clouds fill it.");
  note_bounds(found, result);
  note_noise(problem, result);
  note_scatterless(problem, found, result);
  note_uncovered(problem, found, result);
  note_image(problem, found, crossing, result);
  note_specimens(problem, found, result);
  result.warnings.insert(result.warnings.end(), found.undetermined.begin(), found.undetermined.end());
  note_model_error(problem, "interval", "is not taken into account: the box must explain it as well.", result);
}

}  // namespace mottle::updating
