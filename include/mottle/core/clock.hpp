// Time that passes, and in words.
#pragma once

#include <string>

namespace mottle {

/// Seconds on a steady clock.
double steady_seconds();

/// "0.18 s", "40 s", "9 min", "2.5 h".
std::string duration_text(double seconds);

}  // namespace mottle
