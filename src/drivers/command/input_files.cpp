#include "mottle/drivers/command/input_files.hpp"

#include <fcntl.h>
#include <linux/fs.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/drivers/command/run_folders.hpp"

namespace mottle::drivers {
namespace {

namespace fs = std::filesystem;

bool is_same(const timespec& a, const timespec& b) {
  return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec;
}

/// Whether nothing was written to a file: what was written and put back in between, other runs may have read.
bool is_unwritten(const struct stat& a, const struct stat& b) {
  return a.st_ino == b.st_ino && a.st_dev == b.st_dev && a.st_size == b.st_size && is_same(a.st_mtim, b.st_mtim);
}

/// Lets the file system share the blocks of a new file with an old one; false where it cannot.
bool clone(const fs::path& source, const fs::path& destination) {
  const int from = ::open(source.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (from < 0) return false;
  const int to = ::open(destination.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  const bool is_done = to >= 0 && ::ioctl(to, FICLONE, from) == 0;
  ::close(from);
  if (to >= 0) ::close(to);
  if (to >= 0 && !is_done) ::unlink(destination.c_str());
  return is_done;
}

[[noreturn]] void refuse_changed(const RunFile& file) {
  throw SystemFailure(
      fmt::format("a run has changed the copy of '{}' that all runs start from; let the solver change only "
                  "what lies in its own folder and is no link",
                  file.name));
}

}  // namespace

InputFiles::InputFiles(const std::vector<RunFile>& files, const fs::path& folder, std::uintmax_t largest_private) {
  for (const RunFile& file : files) {
    const std::string bytes = read_file(file.source);
    Original original{.file = file, .copy = folder / file.name, .is_large = bytes.size() > largest_private};
    std::error_code ignored;
    fs::create_directories(original.copy.parent_path(), ignored);
    write_run_file(original.copy, bytes);
    fs::perms allowed = fs::status(file.source, ignored).permissions();
    if (original.is_large) allowed &= ~(fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write);
    fs::permissions(original.copy, allowed, ignored);
    ::lstat(original.copy.c_str(), &original.seen);
    originals_.push_back(std::move(original));
    digests_.push_back(digest_of(bytes));
  }
}

void InputFiles::put(const Original& original, const Digest& digest, const fs::path& destination) const {
  std::error_code error;
  if (original.is_large) {
    if (clone(original.copy, destination)) {
      fs::permissions(destination, fs::status(original.file.source, error).permissions(), error);
      return;
    }
    fs::create_symlink(original.copy, destination, error);
    if (error) throw SystemFailure(fmt::format("{}: cannot be made: {}", destination.string(), error.message()));
    return;
  }
  const std::string bytes = read_file(original.copy);
  if (digest_of(bytes) != digest) refuse_changed(original.file);
  write_run_file(destination, bytes);
  fs::permissions(destination, fs::status(original.copy, error).permissions(), error);
}

void InputFiles::put_into(const fs::path& folder) const {
  for (std::size_t i = 0; i < originals_.size(); ++i) {
    const fs::path destination = folder / originals_[i].file.name;
    std::error_code ignored;
    fs::create_directories(destination.parent_path(), ignored);
    put(originals_[i], digests_[i], destination);
  }
}

void InputFiles::require_unchanged() {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (std::size_t i = 0; i < originals_.size(); ++i) {
    Original& original = originals_[i];
    struct stat now {};
    if (!original.is_large) continue;
    if (::lstat(original.copy.c_str(), &now) != 0 || !is_unwritten(now, original.seen)) refuse_changed(original.file);
    if (is_same(now.st_ctim, original.seen.st_ctim)) continue;
    // Rights or names have changed, or times were set back.
    if (digest_of(read_file(original.copy)) != digests_[i]) refuse_changed(original.file);
    original.seen = now;
  }
}

void InputFiles::relink(const fs::path& folder) const {
  for (const Original& original : originals_) {
    const fs::path destination = folder / original.file.name;
    std::error_code error;
    if (fs::read_symlink(destination, error) != original.copy || error) continue;
    fs::remove(destination, error);
    fs::create_symlink(fs::absolute(original.file.source), destination, error);
  }
}

}  // namespace mottle::drivers
