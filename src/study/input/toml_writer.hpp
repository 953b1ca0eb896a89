// TOML as text, for messages and for the study as run. Keys stand in the order of the file they were read from: the
// order of masses is the order of degrees of freedom, and a copy of a study must give the same numbers.
#pragma once

#include <toml++/toml.h>

#include <string>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::study {

/// The keys of a table in the order of the file; keys without a position (from --set) come first.
std::vector<std::string> keys_in_file_order(const toml::table& table);

/// A value on one line; numbers in the fewest digits that give them back.
std::string toml_on_one_line(const toml::node& node);

/// A whole file.
std::string toml_document(const toml::table& root);

}  // namespace mottle::study
