#include "mottle/core/run_context.hpp"

#include <fmt/format.h>

namespace mottle {

std::string Phase::text() const {
  if (step == 0) return name;
  return fmt::format("{} {} of {}{}", name, step, may_end_early ? "at most " : "", steps);
}

}  // namespace mottle
