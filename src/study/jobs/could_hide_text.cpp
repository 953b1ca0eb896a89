#include "study/jobs/could_hide_text.hpp"

#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"

namespace mottle::study {
namespace {

std::string percent(double part) {
  return fmt::format("{:.2g} %", 100.0 * part);
}

}  // namespace

std::string change_text(const NamedError& error) {
  if (error.nominal == 0.0) return fmt::format("{:.2g} (it is 0 in the model)", error.change());
  return percent(error.error.relative_change);
}

std::string harm_text(const HiddenError& error, const std::vector<std::string>& parameters) {
  Eigen::Index worst = 0;
  for (Eigen::Index i = 1; i < error.would_move.size(); ++i) {
    if (error.harm_to(i) > error.harm_to(worst)) worst = i;
  }
  const std::string& name = parameters[static_cast<std::size_t>(worst)];
  if (error.is_beyond_first_order()) {
    error.prior_deviations.cwiseAbs().maxCoeff(&worst);
    return fmt::format("{} by more than its prior standard deviation, further than the model may be taken as linear",
                       parameters[static_cast<std::size_t>(worst)]);
  }
  if (!std::isfinite(error.would_move(worst))) {
    return fmt::format("{} by {:.2g} prior standard deviations (it has no 95 % interval)", name, error.harm());
  }
  return fmt::format("{} by {:.2g} half-widths of its 95 % interval", name, error.harm());
}

std::string hidden_error_sentence(const NamedError& error, const std::vector<std::string>& parameters,
                                  bool is_level_known) {
  const std::string harm = harm_text(error.error, parameters);
  const std::string size = change_text(error);
  if (error.error.is_detected) {
    return fmt::format("{} off by up to {} can pass, and moves {}; at {} {}.", error.name, size, harm, size,
                       is_level_known
                           ? "the test of the means refuses it in 80 % of cases"
                           : "the test of the means would refuse it in 80 % of cases if the noise were known "
                             "to be as estimated; it is not, and fewer are refused");
  }
  return fmt::format("{} off by {} would not show in these tests, and moves {}{}.", error.name, size, harm,
                     error.error.is_cut ? "; a larger error drives a mean out of its bounds" : "");
}

std::string sizes_text(const std::vector<NamedError>& errors) {
  std::vector<std::string> parts;
  for (const NamedError& error : errors) parts.push_back(fmt::format("{} off by {}", error.name, change_text(error)));
  return join(parts);
}

std::string summary_text(const std::vector<NamedError>& worst, const std::vector<std::string>& parameters,
                         bool is_level_known) {
  std::vector<NamedError> seen;
  std::vector<std::string> unseen;
  for (const NamedError& error : worst) {
    if (error.error.is_detected) {
      seen.push_back(error);
    } else {
      unseen.push_back(error.name);
    }
  }
  std::string text = "The most harmful errors of fixed numbers:";
  if (!seen.empty()) {
    text += fmt::format(" {}: the test of the means {}.", sizes_text(seen),
                        is_level_known ? "refuses each in 80 % of cases"
                                       : "would refuse each in 80 % of cases if the noise were known to be as "
                                         "estimated; it is not, and fewer are refused");
  }
  if (!unseen.empty()) text += fmt::format(" For {} an error of any size passes the test of the means.", join(unseen));
  return fmt::format("{} The first moves {}.", text, harm_text(worst.front().error, parameters));
}

}  // namespace mottle::study
