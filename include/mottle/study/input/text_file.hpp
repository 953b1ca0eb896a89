// Text files that the user names: whatever a file holds, what comes in is UTF-8 text that can be shown and written on.
#pragma once

#include <filesystem>
#include <string>

#include "mottle/layers.hpp"

namespace mottle::study {

/// The bytes of a text file.
///
/// Throws InvalidInput: no such file, or what read_file refuses. FormatError with the line: bytes that are not UTF-8
/// text.
std::string read_text_file(const std::filesystem::path& file);

}  // namespace mottle::study
