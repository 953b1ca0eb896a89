// Files that a job keeps open in a folder where others may put things.
#pragma once

#include <filesystem>

namespace mottle {

/// What becomes of a file that has the name already.
enum class ExistingFile { keep, replace };

/// Opens a file of Mottle's own to read and to write, and makes it where it is missing. What a link or a second name
/// leads to is not touched: a new file takes its place, and one that is to be kept must be a regular file itself.
///
/// @return  a descriptor, the caller's to close
/// @throws  InvalidInput: a link, a folder or a device has the name; nothing can be written there. SystemFailure: the
///          machine refuses (full disk, no descriptors left)
int open_own_file(const std::filesystem::path& path, ExistingFile existing);

}  // namespace mottle
