// Whether a folder or a file could be written, and how a refusal is told, beside make_writable_folder() of files.hpp,
// which makes it.
#pragma once

#include <filesystem>
#include <vector>

namespace mottle {

/// What of a folder and its parents is not there, the innermost first. A link to nothing is there.
std::vector<std::filesystem::path> missing_folders(const std::filesystem::path& folder);

/// Throws what make_writable_folder() would throw, and leaves nothing: what may be written is asked of the file system,
/// since access rights alone do not say it (/proc, /sys, what a superuser may).
void require_writable_folder(const std::filesystem::path& folder);

/// Why `path` cannot be opened for writing, by errno.
/// @param advice  behind the reason, where the path is what has to be changed
/// @throws SystemFailure: the machine's limits (full disk, no descriptors). InvalidInput: a path that is not to be
/// written
[[noreturn]] void refuse_to_write(const std::filesystem::path& path, const char* what, const char* advice);

/// The advice where results can go to another folder.
inline constexpr const char* k_choose_another_folder = "; choose another folder with --out";

}  // namespace mottle
