// A list of remarks that a message can hold.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"

namespace mottle::study {

/// "a, b, c and 12 more": the first eight, and how many are left out.
inline std::string first_few(const std::vector<std::string>& remarks) {
  constexpr std::size_t k_listed = 8;
  const auto shown = static_cast<std::ptrdiff_t>(std::min(remarks.size(), k_listed));
  const std::string more = remarks.size() > k_listed ? fmt::format(" and {} more", remarks.size() - k_listed) : "";
  return join({remarks.begin(), remarks.begin() + shown}) + more;
}

}  // namespace mottle::study
