#include "drivers/command/run_output.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>

#include "mottle/drivers/command/solver_process.hpp"
#include "mottle/formats/text_lines.hpp"

namespace mottle::drivers {
namespace {

/// The last `max_bytes` bytes of what is open.
std::string end_of(int descriptor, off_t max_bytes) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) return {};
  std::string bytes(static_cast<std::size_t>(std::min(status.st_size, max_bytes)), '\0');
  const ssize_t size =
      ::pread(descriptor, bytes.data(), bytes.size(), status.st_size - static_cast<off_t>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
  return bytes;
}

}  // namespace

std::string last_part(const std::filesystem::path& file) {
  constexpr off_t k_max = 64 << 10;
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0) return {};
  std::string bytes = end_of(descriptor, k_max);
  ::close(descriptor);
  return bytes;
}

void shorten_output(const std::filesystem::path& folder) {
  constexpr off_t k_kept = 1 << 20;
  for (const char* name : {k_standard_output, k_standard_error}) {
    const int descriptor = ::open((folder / name).c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (descriptor < 0) continue;
    struct stat status {};
    // A second name: the file may be one of the user's.
    const bool is_long = ::fstat(descriptor, &status) == 0 && status.st_size > k_kept && status.st_nlink == 1;
    const std::string bytes = is_long ? end_of(descriptor, k_kept) : std::string();
    if (is_long && ::pwrite(descriptor, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size())) {
      (void)!::ftruncate(descriptor, static_cast<off_t>(bytes.size()));
    }
    ::close(descriptor);
  }
}

bool tells_of_full_disk(const std::filesystem::path& folder, const std::set<std::string>& given) {
  constexpr int k_most_files = 500;
  int files = 0;
  std::error_code ignored;
  std::filesystem::recursive_directory_iterator entry(folder, ignored);
  for (; entry != std::filesystem::recursive_directory_iterator() && files < k_most_files; entry.increment(ignored)) {
    if (entry->symlink_status(ignored).type() != std::filesystem::file_type::regular) continue;
    if (given.contains(entry->path().lexically_relative(folder).string())) continue;
    ++files;
    const std::string bytes = last_part(entry->path());
    for (const char* words : {"No space left on device", "Disk quota exceeded", "ENOSPC", "EDQUOT"}) {
      if (bytes.find(words) != std::string::npos) return true;
    }
  }
  return false;
}

std::string last_words(const std::filesystem::path& folder) {
  constexpr std::size_t k_longest = 200;
  for (const char* file : {k_standard_error, k_standard_output}) {
    const std::string bytes = last_part(folder / file);
    std::string last;
    for (LineWalker walker(bytes); walker.next();) {
      if (!words_of(walker.line()).empty()) last = walker.line().substr(0, k_longest);
    }
    if (!last.empty()) return last;
  }
  return {};
}

}  // namespace mottle::drivers
