// What `mottle init` leaves open.
#pragma once

#include <toml++/toml.h>

#include <filesystem>

#include "mottle/layers.hpp"

namespace mottle::study {

/// Throws FormatError where values of a study still are "UNKNOWN", as `mottle init` writes what only the user knows:
/// with the lines and keys of all of them.
void refuse_unknown_values(const toml::table& root, const std::filesystem::path& file);

}  // namespace mottle::study
