// Puts "dotted.key=value" of the command line into a study's TOML.
#pragma once

#include <toml++/toml.h>

#include <string>

#include "mottle/layers.hpp"

namespace mottle::study {

/// Sets one value. A step of the key names a key, or an entry of a list by its number from 1 or by its `name`
/// ("parameter.k1.distribution.mean"). Tables that are missing on the way are made.
///
/// @throws InvalidInput  no "=", an entry that the list does not have, a step into something that is not a table
void apply_override(toml::table& root, const std::string& assignment);

}  // namespace mottle::study
