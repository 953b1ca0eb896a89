// Text files that the user names, converted to valid UTF-8.
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
