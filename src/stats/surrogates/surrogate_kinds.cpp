#include "mottle/stats/surrogates/surrogate.hpp"

namespace mottle::stats {

const std::vector<std::string>& surrogate_kinds() {
  static const std::vector<std::string> k_kinds = {"quadratic", "kriging", "chaos"};
  return k_kinds;
}

}  // namespace mottle::stats
