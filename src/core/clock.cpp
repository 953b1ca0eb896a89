#include "mottle/core/clock.hpp"

#include <fmt/format.h>

#include <chrono>

namespace mottle {

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string duration_text(double seconds) {
  constexpr double k_minute = 60.0;
  constexpr double k_hour = 3600.0;
  if (seconds < 1.0) return fmt::format("{:.2g} s", seconds);
  if (seconds < 2.0 * k_minute) return fmt::format("{:.0f} s", seconds);
  if (seconds < 2.0 * k_hour) return fmt::format("{:.0f} min", seconds / k_minute);
  return fmt::format("{:.1f} h", seconds / k_hour);
}

}  // namespace mottle
