// Files that appear complete or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace mottle {

/// The whole file as bytes. Throws InvalidInput where it is missing or unreadable (names the path and the reason).
std::string read_file(const std::filesystem::path& path);

/// Writes `bytes` beside `path`, flushes them to the disk and renames: a reader sees the old file or the new one.
/// Throws SystemFailure (full disk, no descriptors or inodes left), InvalidInput (place not writable).
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);
/// The same of bytes that lie in several places.
void write_file_atomically(const std::filesystem::path& path, std::span<const std::string_view> pieces);

/// The system's folder for temporary files ($TMPDIR or /tmp). Throws SystemFailure where it is none.
std::filesystem::path temporary_folder();

/// Makes the folder and its parents, and proves by a probe file that it can be written.
/// Throws InvalidInput where it cannot, SystemFailure where the machine refuses (full disk, no descriptors left).
void make_writable_folder(const std::filesystem::path& folder);

}  // namespace mottle
