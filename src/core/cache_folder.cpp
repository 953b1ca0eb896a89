#include "mottle/core/cache_folder.hpp"

#include <algorithm>
#include <chrono>
#include <string_view>
#include <vector>

#include "mottle/core/error.hpp"

namespace mottle {
namespace {

namespace fs = std::filesystem;

constexpr auto k_abandoned = std::chrono::hours(1);  // a file under a name of its own that nobody writes any more

}  // namespace

fs::path CacheFolder::file(const Digest& digest) const {
  return folder_ / (hexadecimal(digest) + extension_);
}

void CacheFolder::prepare(std::uintmax_t bytes) const {
  std::error_code error;
  if (fs::create_directories(folder_, error)) fs::permissions(folder_, fs::perms::owner_all, error);
  const std::uintmax_t room = fs::space(folder_, error).available;
  require(error || room > bytes, "too little room there");
}

void CacheFolder::touch(const fs::path& file) {
  std::error_code error;
  fs::last_write_time(file, fs::file_time_type::clock::now(), error);
}

/// A digest, the extension, and where it is not finished ".", the process and ".partial".
bool CacheFolder::is_own(const std::string& name) const {
  constexpr std::size_t k_digits = 32;
  const std::string_view view = name;
  return view.find_first_not_of("0123456789abcdef") == k_digits && view.substr(k_digits).starts_with(extension_);
}

void CacheFolder::trim(const fs::path& newest) const {
  struct Kept {
    fs::path path;
    fs::file_time_type time;
    std::uintmax_t size = 0;
  };
  std::vector<Kept> files;
  std::uintmax_t total = 0;
  std::error_code error;
  const fs::file_time_type now = fs::file_time_type::clock::now();
  for (fs::directory_iterator entry(folder_, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code gone;  // another command may make room at the same time
    const Kept file{entry->path(), entry->last_write_time(gone), entry->file_size(gone)};
    if (gone || !is_own(file.path.filename().string())) continue;
    if (file.path.extension() != extension_) {
      if (now - file.time > k_abandoned) fs::remove(file.path, gone);
      continue;
    }
    total += file.size;
    if (file.path != newest) files.push_back(file);
  }
  std::sort(files.begin(), files.end(), [](const Kept& a, const Kept& b) { return a.time < b.time; });
  for (const Kept& file : files) {
    if (total <= max_bytes_) break;
    if (fs::remove(file.path, error)) total -= file.size;
  }
}

}  // namespace mottle
