#include "mottle/drivers/command/number_pattern.hpp"

#include <re2/re2.h>

#include <array>

#include "mottle/core/error.hpp"

namespace mottle::drivers {
namespace {

re2::RE2::Options options() {
  re2::RE2::Options options(re2::RE2::Latin1);  // bytes: what a solver prints need not be UTF-8
  options.set_log_errors(false);                // else it prints
  options.set_max_mem(std::int64_t{8} << 20);
  return options;
}

}  // namespace

NumberPattern::NumberPattern(const std::string& text) {
  constexpr std::size_t k_longest = 100'000;
  require(text.size() <= k_longest, "has {} characters, at most {} are allowed", text.size(), k_longest);
  expression_ = std::make_unique<re2::RE2>(text, options());
  constexpr std::size_t k_longest_shown = 200;  // an error quotes the expression, which may be of any length
  require(expression_->ok(), "is no regular expression that is known here: {}",
          expression_->error().substr(0, k_longest_shown));
  require(expression_->NumberOfCapturingGroups() >= 1, "has no group; put parentheses around the number");
}

NumberPattern::~NumberPattern() = default;
NumberPattern::NumberPattern(NumberPattern&&) noexcept = default;
NumberPattern& NumberPattern::operator=(NumberPattern&&) noexcept = default;

std::vector<std::string_view> NumberPattern::first_groups(std::string_view line) const {
  std::vector<std::string_view> groups;
  std::array<re2::StringPiece, 2> match;
  const re2::StringPiece text(line.data(), line.size());
  for (std::size_t begin = 0; begin <= line.size();) {
    if (!expression_->Match(text, begin, line.size(), re2::RE2::UNANCHORED, match.data(), match.size())) break;
    groups.emplace_back(match[1].data(), match[1].size());
    const auto end = static_cast<std::size_t>(match[0].data() - text.data()) + match[0].size();
    begin = match[0].empty() ? end + 1 : end;
  }
  return groups;
}

}  // namespace mottle::drivers
