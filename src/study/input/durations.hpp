// Times in a study.
#pragma once

#include <chrono>
#include <string>

#include "mottle/layers.hpp"
#include "study/input/toml_reader.hpp"

namespace mottle::study {

/// "10 min", "30 s", "2 h", or a number of seconds.
std::chrono::milliseconds read_duration(TomlReader& reader, const std::string& key, std::chrono::milliseconds fallback);

}  // namespace mottle::study
