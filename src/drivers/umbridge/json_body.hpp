// JSON that a stranger sent.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "mottle/layers.hpp"

namespace mottle::drivers {

/// The value, or nothing where the text is not JSON or is nested too deeply (64 levels: each costs memory many times
/// its bracket).
std::optional<nlohmann::json> parse_body(std::string_view body);

}  // namespace mottle::drivers
