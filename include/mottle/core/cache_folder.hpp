// Files of one kind in the user's cache, each under the digest of what it was made from.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include "mottle/core/checksum.hpp"

namespace mottle {

/// The files of one extension in a folder that other kinds share. Several commands may use it at the same time.
class CacheFolder {
 public:
  CacheFolder(std::filesystem::path folder, std::string extension, std::uintmax_t max_bytes)
      : folder_(std::move(folder)), extension_(std::move(extension)), max_bytes_(max_bytes) {}

  std::filesystem::path file(const Digest& digest) const;

  /// Makes the folder, for the user alone as the XDG base directory specification wants it.
  /// Throws InvalidInput where the disk has less than `bytes` to spare: the rest of it is for results.
  void prepare(std::uintmax_t bytes) const;

  /// Notes that a file was used: the last to go.
  static void touch(const std::filesystem::path& file);

  /// Removes files that nobody finished, then the oldest until the rest is within the limit; `newest` stays.
  void trim(const std::filesystem::path& newest) const;

 private:
  bool is_own(const std::string& name) const;

  std::filesystem::path folder_;
  std::string extension_;
  std::uintmax_t max_bytes_;
};

}  // namespace mottle
