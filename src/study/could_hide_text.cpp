#include "could_hide_text.hpp"

#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"

namespace mottle {
namespace {

std::string percent(double part) {
  return fmt::format("{:.2g} %", 100.0 * part);
}

}  // namespace

std::string harm_text(const HiddenError& error, const std::vector<std::string>& parameters) {
  Eigen::Index worst = 0;
  for (Eigen::Index i = 0; i < error.would_move.size(); ++i) {
    if (std::abs(error.would_move(i)) >= error.harm()) worst = i;
  }
  return fmt::format("{} by {:.2g} half-widths of its 95 % interval", parameters[static_cast<std::size_t>(worst)],
                     error.harm());
}

std::string hidden_error_sentence(const NamedError& error, const std::vector<std::string>& parameters) {
  const std::string harm = harm_text(error.error, parameters);
  const std::string size = percent(error.error.relative_change);
  if (error.error.is_detected) {
    return fmt::format("{} off by up to {} can pass, and moves {}; at {} it is refused in 80 % of cases.", error.name,
                       size, harm, size);
  }
  return fmt::format("{} off by {} would have passed, and moves {}{}.", error.name, size, harm,
                     error.error.is_cut ? "; a larger error drives a mean out of its bounds" : "");
}

std::string sizes_text(const std::vector<NamedError>& errors) {
  std::vector<std::string> parts;
  for (const NamedError& error : errors) {
    parts.push_back(fmt::format("{} off by {}", error.name, percent(error.error.relative_change)));
  }
  return join(parts);
}

std::string summary_text(const std::vector<NamedError>& worst, const std::vector<std::string>& parameters) {
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
  if (!seen.empty()) text += fmt::format(" {}: each is refused in 80 % of cases.", sizes_text(seen));
  if (!unseen.empty()) text += fmt::format(" Of {} no size is seen by the means.", join(unseen));
  return fmt::format("{} The first moves {}.", text, harm_text(worst.front().error, parameters));
}

}  // namespace mottle
