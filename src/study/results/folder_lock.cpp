#include "mottle/study/results/folder_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>

#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/folders.hpp"

namespace mottle::study {
namespace {

/// Whether the file of that name is still the one that is open: who held it before may have taken it away.
bool is_same_file(int descriptor, const std::filesystem::path& file) {
  struct stat open {};
  struct stat there {};
  return ::fstat(descriptor, &open) == 0 && ::lstat(file.c_str(), &there) == 0 && open.st_ino == there.st_ino &&
         open.st_dev == there.st_dev;
}

constexpr const char* k_unknown_holder = "another process";

/// "process 1234", as its holder wrote it; "another process" where it did not.
std::string holder(int descriptor) {
  std::array<char, 32> text{};
  const ssize_t size = ::pread(descriptor, text.data(), text.size(), 0);
  const std::string number(text.data(), static_cast<std::size_t>(size > 0 ? size : 0));
  const bool is_number = !number.empty() && number.find_first_not_of("0123456789") == std::string::npos;
  return is_number ? "process " + number : k_unknown_holder;
}

/// Whether it is a file of one name that holds nothing, or a process's number.
bool is_lock(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode) || status.st_nlink != 1) return false;
  return status.st_size == 0 || holder(descriptor) != k_unknown_holder;
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder)
    : file_(std::filesystem::absolute(folder) / ".mottle.lock"), made_(missing_folders(folder)) {
  make_writable_folder(folder);
  while (descriptor_ < 0) {
    descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
    require(descriptor_ >= 0, "{}: cannot be made: {}; choose another folder with --out", file_.string(),
            std::strerror(errno));
    // A file system without locks (ENOLCK, EOPNOTSUPP) goes without.
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      const std::string who = holder(descriptor_);
      ::close(descriptor_);
      throw InvalidInput(
          fmt::format("{}: another Mottle is filling this folder ({}); wait for its end, or name another "
                      "place with --out",
                      folder.string(), who));
    }
    if (is_same_file(descriptor_, file_)) {
      const bool is_own = is_lock(descriptor_);
      if (!is_own) ::close(descriptor_);
      require(is_own,
              "{}: is not the file by which Mottle holds a folder; move it, or choose another folder with --out",
              file_.string());
      break;
    }
    ::close(descriptor_);
    descriptor_ = -1;
  }
  const std::string number = std::to_string(::getpid());
  // On a full disk the number is missing; the lock holds without it.
  if (::ftruncate(descriptor_, 0) == 0) (void)!::pwrite(descriptor_, number.data(), number.size(), 0);
}

FolderLock::~FolderLock() {
  ::unlink(file_.c_str());
  ::close(descriptor_);
  std::error_code ignored;  // those that hold something stay
  for (const std::filesystem::path& path : made_) std::filesystem::remove(path, ignored);
}

}  // namespace mottle::study
