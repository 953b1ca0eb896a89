#include "mottle/drivers/run_folders.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"

namespace mottle {
namespace {

constexpr const char* k_work = "runs";
constexpr const char* k_failed = "failed-runs";
constexpr const char* k_kept = "kept-runs";
constexpr int k_most_failed_kept = 20;

std::string own_prefix() {
  return fmt::format("mottle-{}-", ::getpid());
}

/// A new folder with a name nobody else has, for nobody else's eyes.
std::filesystem::path make_private(const std::filesystem::path& parent) {
  std::string pattern = (parent / (own_prefix() + "XXXXXX")).string();
  if (::mkdtemp(pattern.data()) == nullptr) {
    throw SystemFailure(fmt::format("{}: no folder can be made there: {}", parent.string(), std::strerror(errno)));
  }
  return pattern;
}

/// 0, or errno.
int write_plainly(const std::filesystem::path& file, std::string_view bytes) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor < 0) return errno;
  int error = 0;
  while (!bytes.empty() && error == 0) {
    const ssize_t size = ::write(descriptor, bytes.data(), bytes.size());
    if (size < 0 && errno != EINTR) error = errno;
    bytes.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
  }
  ::close(descriptor);
  return error;
}

}  // namespace

RunFolders::RunFolders(const std::filesystem::path& results, bool forgets)
    : results_(results), is_temporary_(results.empty()) {
  std::error_code ignored;
  if (is_temporary_) {
    results_ = make_private(std::filesystem::temp_directory_path());
  } else {
    make_writable_folder(results_);
    results_ = std::filesystem::absolute(results_);
    std::filesystem::directory_iterator left(results_ / k_work, ignored);
    for (; left != std::filesystem::directory_iterator(); left.increment(ignored)) {
      if (!left->path().filename().string().starts_with(own_prefix())) {
        std::filesystem::remove_all(left->path(), ignored);
      }
    }
    if (forgets) std::filesystem::remove_all(results_ / k_failed, ignored);
  }
  std::filesystem::create_directory(results_ / k_work, ignored);
  work_ = make_private(results_ / k_work);
  shared_ = work_ / "shared";
  if (!std::filesystem::create_directory(shared_, ignored)) {
    throw SystemFailure(fmt::format("{}: cannot be made: {}", shared_.string(), ignored.message()));
  }
}

RunFolders::~RunFolders() {
  std::error_code ignored;
  std::filesystem::remove_all(work_, ignored);
  std::filesystem::remove(results_ / k_work, ignored);  // where it is empty
  if (is_temporary_ && !has_kept_) std::filesystem::remove_all(results_, ignored);
}

std::filesystem::path RunFolders::make() {
  std::filesystem::path folder;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    folder = work_ / fmt::format("run-{}", ++next_);
  }
  if (::mkdir(folder.c_str(), 0700) != 0) {
    throw SystemFailure(fmt::format("{}: cannot be made: {}", folder.string(), std::strerror(errno)));
  }
  return folder;
}

void RunFolders::remove(const std::filesystem::path& folder) {
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
}

std::filesystem::path RunFolders::keep(const std::filesystem::path& folder, bool has_failed, const std::string& name) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::error_code error;
  if (has_failed && ++failed_ > k_most_failed_kept) {
    std::filesystem::remove_all(folder, error);
    return {};
  }
  const std::filesystem::path group = results_ / (has_failed ? k_failed : k_kept);
  std::filesystem::create_directory(group, error);
  std::filesystem::remove_all(group / name, error);
  std::filesystem::rename(folder, group / name, error);
  if (error) throw SystemFailure(fmt::format("{}: cannot be made: {}", (group / name).string(), error.message()));
  has_kept_ = true;
  return group / name;
}

void RunFolders::require_room(const std::filesystem::path& folder) const {
  const std::filesystem::path probe = folder / ".mottle-probe";
  const int error = write_plainly(probe, std::string(1 << 16, 'x'));
  ::unlink(probe.c_str());
  if (error == 0) return;
  throw SystemFailure(
      fmt::format("{}: cannot be written: {}; what the solver left there is not used, finished runs are "
                  "kept: make room and go on with --resume",
                  folder.string(), std::strerror(error)));
}

void write_run_file(const std::filesystem::path& file, const std::string& bytes) {
  const int error = write_plainly(file, bytes);
  if (error == 0) return;
  throw SystemFailure(fmt::format("{}: cannot be written: {}; finished runs are kept, go on with --resume",
                                  file.string(), std::strerror(error)));
}

}  // namespace mottle
