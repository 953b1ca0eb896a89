// Files that appear complete or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace mottle {

/// Largest file that is read as a whole: 8 GiB, a matrix of 200 million entries as text.
inline constexpr std::uint64_t k_largest_file = std::uint64_t{8} << 30;

/// A regular file that is read from its beginning, a block at a time. Named pipes, devices and sockets, which may never
/// end, are not waited for.
class BlockReader {
 public:
  /// @param max_bytes  limit, checked against the size now and against the bytes read later
  /// @throws InvalidInput   missing, unreadable, larger than the limit, or not a regular file (path and reason)
  /// @throws SystemFailure  the disk or the system failed
  explicit BlockReader(std::filesystem::path path, std::uint64_t max_bytes = k_largest_file);
  BlockReader(BlockReader&& other) noexcept;
  BlockReader& operator=(BlockReader&&) = delete;
  BlockReader(const BlockReader&) = delete;
  BlockReader& operator=(const BlockReader&) = delete;
  ~BlockReader();

  std::uint64_t size() const { return size_; }  ///< when the file was opened
  /// Whether its last byte ends a line; true of an empty file too. Throws as the constructor does.
  bool ends_with_line() const;
  /// Puts the next bytes into `block`, which is not empty; how many they are, 0 at the end. Throws as the constructor.
  std::size_t read(std::span<char> block);

 private:
  void check_size(std::uint64_t size) const;

  std::filesystem::path path_;
  std::uint64_t max_bytes_ = 0, size_ = 0, read_ = 0;
  int descriptor_ = -1;
};

/// The whole file as bytes, as long as it was when its end was read. Limits and errors are those of BlockReader; the
/// limit is checked against the size before memory is allocated.
std::string read_file(const std::filesystem::path& path, std::uint64_t max_bytes = k_largest_file);

/// Writes `bytes` beside `path`, flushes them to the disk and renames: a reader sees the old file or the new one.
/// Throws SystemFailure (full disk, no descriptors or inodes left), InvalidInput (folder not writable).
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);
/// The same for several pieces of bytes, written one after another.
void write_file_atomically(const std::filesystem::path& path, std::span<const std::string_view> pieces);

/// The system's folder for temporary files ($TMPDIR or /tmp). Throws SystemFailure where it is none.
std::filesystem::path temporary_folder();

/// A new folder within it that nobody else can read, and that goes with this object.
class TemporaryFolder {
 public:
  /// Throws SystemFailure where none can be made.
  TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Makes the folder and its parents, and proves by a probe file that it can be written.
/// Throws InvalidInput where it cannot, SystemFailure where the machine refuses (full disk, no descriptors left).
void make_writable_folder(const std::filesystem::path& folder);

}  // namespace mottle
