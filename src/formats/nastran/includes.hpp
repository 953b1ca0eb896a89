// INCLUDE statements: the file name as written and where it is found.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "mottle/formats/nastran/deck.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats::nastran {

/// A deck with its included files may hold this many bytes.
inline constexpr std::uintmax_t k_max_bytes = 2'000'000'000;

/// Looks beside the including file, then beside `main_file`; forgives backslashes and letter case.
IncludeResolver resolver_of_files(const std::filesystem::path& main_file);

/// Where that resolver looks for the file that `written` names in the file `from`: "parts/a.dat and a.dat".
std::string places_of_include(const std::string& written, const std::string& from, const std::string& main_file);

/// The file's bytes; refuses what is larger than `limit`.
std::string read_limited_file(const std::filesystem::path& path, std::uintmax_t limit);

}  // namespace mottle::formats::nastran
