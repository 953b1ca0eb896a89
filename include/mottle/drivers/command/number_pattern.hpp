// A regular expression that finds numbers in a solver's output, in the syntax of RE2: matching takes time in
// proportion to the text whatever the expression, so there are neither back references nor lookaround.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/layers.hpp"

namespace re2 {
class RE2;
}

namespace mottle::drivers {

class NumberPattern {
 public:
  /// @throws InvalidInput  `text` is no regular expression, takes more than 8 MiB, or has no group in parentheses
  explicit NumberPattern(const std::string& text);
  ~NumberPattern();
  NumberPattern(NumberPattern&&) noexcept;
  NumberPattern& operator=(NumberPattern&&) noexcept;

  /// First groups of all matches in a line, from left to right; empty where a match leaves the group out.
  std::vector<std::string_view> first_groups(std::string_view line) const;

 private:
  std::unique_ptr<re2::RE2> expression_;
};

}  // namespace mottle::drivers
