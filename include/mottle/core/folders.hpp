// Whether a folder could be made and written, beside make_writable_folder() of files.hpp, which makes it.
#pragma once

#include <filesystem>
#include <vector>

namespace mottle {

/// What of a folder and its parents is not there, the innermost first. A link to nothing is there.
std::vector<std::filesystem::path> missing_folders(const std::filesystem::path& folder);

/// Throws what make_writable_folder() would throw, and leaves nothing: what may be written is asked of the file system,
/// since access rights alone do not say it (/proc, /sys, what a superuser may).
void require_writable_folder(const std::filesystem::path& folder);

}  // namespace mottle
