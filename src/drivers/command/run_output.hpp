// The last lines that a run of a program printed, for messages.
#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "mottle/layers.hpp"

namespace mottle::drivers {

/// The last bytes of a regular file, at most 64 kB; empty where it is none. Never follows a link.
std::string last_part(const std::filesystem::path& file);

/// Shortens what a run printed to its last part where it is longer than 1 MB.
void shorten_output(const std::filesystem::path& folder);

/// Whether a file of a failed run says in its last part that the disk, or a quota, was full: in the words of the C
/// library, which those of Fortran, Python and shells repeat.
///
/// @param given  names of files that the run was given, which may hold these words
bool tells_of_full_disk(const std::filesystem::path& folder, const std::set<std::string>& given);

/// The last line with anything on it that a run has printed, the error's before the output's.
std::string last_words(const std::filesystem::path& folder);

}  // namespace mottle::drivers
