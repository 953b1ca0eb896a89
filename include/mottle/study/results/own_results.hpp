// Which files in a folder are what Mottle left there, and so may be written over.
#pragma once

#include <filesystem>
#include <string_view>

#include "mottle/layers.hpp"

namespace mottle::study {

/// Beside results: the checksums of all files that Mottle wrote there, "HEXADECIMAL NAME" a line.
inline constexpr const char* k_register = ".mottle-files";

/// Whether a job may write over the file: it is not there; it is empty; it holds what the register beside it says that
/// Mottle wrote; or it is a log or a journal, which grow, and is known by its beginning. Whatever else lies beside it
/// is no proof, and a file that was changed since is its owner's.
bool may_be_own_result(const std::filesystem::path& file);

/// Whether the file, wherever it lies now, holds what Mottle wrote into `folder` under its name.
bool is_own_result_of(const std::filesystem::path& folder, const std::filesystem::path& file);

/// Throws InvalidInput unless may_be_own_result().
void require_own_result(const std::filesystem::path& file);

/// Notes in the register that the file is going to hold these bytes. A register that is lost or cut short costs no
/// file: results are then refused as somebody's own.
void note_own_result(const std::filesystem::path& file, std::string_view bytes);

}  // namespace mottle::study
