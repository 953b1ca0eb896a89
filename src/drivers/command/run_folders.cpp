#include "mottle/drivers/command/run_folders.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <set>

#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/ranks.hpp"
#include "mottle/core/text.hpp"

namespace mottle::drivers {
namespace {

constexpr const char* k_work = "runs";
constexpr const char* k_failed = "failed-runs";
constexpr const char* k_kept = "kept-runs";
constexpr const char* k_tasks = "tasks";  // of a scheduler
constexpr int k_max_failed_kept = 20;
// In every folder that is made here: only what holds it is ever removed.
constexpr const char* k_mark = ".mottle-run";
constexpr std::string_view k_mark_text = "Made by Mottle for runs of a solver, and removed by it.\n";

/// A new folder with a name nobody else has, for nobody else's eyes.
std::filesystem::path make_private(const std::filesystem::path& parent) {
  std::string pattern = (parent / fmt::format("mottle-{}-{}-XXXXXX", node_name(), ::getpid())).string();
  if (::mkdtemp(pattern.data()) == nullptr) {
    throw SystemFailure(fmt::format("{}: no folder can be made there: {}", parent.string(), std::strerror(errno)));
  }
  return pattern;
}

/// Writes a new file. 0, or errno.
int write_plainly(const std::filesystem::path& file, std::string_view bytes) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644);
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

/// Marks a folder as made here; says so to other processes as long as the returned file is open. Negative: errno.
int mark(const std::filesystem::path& folder) {
  const int descriptor = ::open((folder / k_mark).c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644);
  if (descriptor < 0) return -errno;
  ::flock(descriptor, LOCK_EX | LOCK_NB);
  if (::write(descriptor, k_mark_text.data(), k_mark_text.size()) == static_cast<ssize_t>(k_mark_text.size())) {
    return descriptor;
  }
  const int error = errno;
  ::close(descriptor);
  return -error;
}

/// Removes a folder, its mark last: where something stays, since a solver whose Mottle was killed still writes there,
/// the next Mottle finds it marked.
void remove_with_mark(const std::filesystem::path& folder) {
  std::error_code ignored;
  std::filesystem::directory_iterator entry(folder, ignored);
  for (; entry != std::filesystem::directory_iterator(); entry.increment(ignored)) {
    if (entry->path().filename() != k_mark) std::filesystem::remove_all(entry->path(), ignored);
  }
  ::unlink((folder / k_mark).c_str());
  if (::rmdir(folder.c_str()) == 0) return;
  const int descriptor = mark(folder);
  if (descriptor >= 0) ::close(descriptor);
}

/// Removes a folder that was made here and that no process is using; never what a link points to.
void remove_marked(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (std::filesystem::symlink_status(folder, ignored).type() != std::filesystem::file_type::directory) return;
  const int descriptor = ::open((folder / k_mark).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0) return;
  std::string text(k_mark_text.size(), ' ');
  const bool is_ours =
      ::read(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size()) && text == k_mark_text;
  if (is_ours && ::flock(descriptor, LOCK_EX | LOCK_NB) == 0) remove_with_mark(folder);
  ::close(descriptor);
}

/// Whether make_private() made it on another host: whether a process there holds it cannot be told, since locks on a
/// shared file system need not be seen by other hosts.
bool is_of_another_host(const std::string& name) {
  const std::size_t random = name.rfind('-');
  const std::size_t process =
      random == std::string::npos || random == 0 ? std::string::npos : name.rfind('-', random - 1);
  if (process == std::string::npos || !name.starts_with("mottle-")) return false;
  const std::string maker = name.substr(0, process);
  return maker != "mottle" && maker != "mottle-" + node_name();  // earlier versions named no host
}

/// Removes a folder whose maker was killed before it had marked it: there is nothing in it but half a mark.
void remove_unmarked(const std::filesystem::path& folder) {
  if (!is_of_dead_process(folder.filename().string(), fmt::format("mottle-{}-", node_name()))) return;
  const std::filesystem::path mark = folder / k_mark;
  struct stat status {};
  const bool is_torn = ::lstat(mark.c_str(), &status) == 0 && S_ISREG(status.st_mode) &&
                       status.st_size < static_cast<off_t>(k_mark_text.size());
  if (is_torn) ::unlink(mark.c_str());
  ::rmdir(folder.c_str());  // where it is empty now
}

void remove_marked_within(const std::filesystem::path& group) {
  std::error_code ignored;
  std::filesystem::directory_iterator entry(group, ignored);
  for (; entry != std::filesystem::directory_iterator(); entry.increment(ignored)) {
    if (is_of_another_host(entry->path().filename().string())) continue;
    remove_marked(entry->path());
    remove_unmarked(entry->path());
  }
}

}  // namespace

bool is_of_dead_process(const std::string& name, const std::string& prefix) {
  if (!name.starts_with(prefix)) return false;
  const std::string rest = name.substr(prefix.size());
  double process = 0.0;
  return parse_number(rest.substr(0, rest.find('-')), process) && process >= 1.0 &&
         ::kill(static_cast<pid_t>(process), 0) != 0 && errno == ESRCH;
}

void require_no_linked_runs(const std::filesystem::path& results) {
  if (results.empty()) return;  // runs are kept nowhere
  for (const char* name : {k_work, k_failed, k_kept, k_run_store, k_answer_store, k_tasks}) {
    const std::filesystem::path path = std::filesystem::absolute(results) / name;
    std::error_code ignored;
    require(
        !std::filesystem::is_symlink(path, ignored),
        "{}: is a link, and what solver runs leave is written and removed there; take it away or choose another folder "
        "with --out",
        path.string());
  }
}

RunStoreFiles run_store_files(const std::filesystem::path& results, int rank, int ranks, const std::string& name) {
  const std::string stem = std::filesystem::path(name).stem().string();
  const auto file_of = [&](int number) {
    return results / (number == 0 ? name : fmt::format("{}-{}.store", stem, number));
  };
  std::set<std::filesystem::path> others;
  for (int other = 0; other < ranks; ++other) others.insert(file_of(other));
  others.insert(file_of(0));
  std::error_code ignored;
  std::filesystem::directory_iterator entry(results, ignored);
  for (; entry != std::filesystem::directory_iterator(); entry.increment(ignored)) {
    const std::string other = entry->path().filename().string();
    if (other.starts_with(stem + "-") && other.ends_with(".store")) others.insert(results / other);
  }
  others.erase(file_of(rank));
  return {.own = file_of(rank), .others = {others.begin(), others.end()}};
}

RunFolders::RunFolders(const std::filesystem::path& results, bool forgets)
    : results_(results), is_temporary_(results.empty()) {
  std::error_code ignored;
  if (is_temporary_) {
    results_ = make_private(temporary_folder());
  } else {
    make_writable_folder(results_);
    results_ = std::filesystem::absolute(results_);
    require_no_linked_runs(results_);
    remove_marked_within(results_ / k_work);
    if (forgets) {
      remove_marked_within(results_ / k_failed);
      std::filesystem::remove(results_ / k_failed, ignored);  // where it is empty
    }
  }
  std::filesystem::create_directory(results_ / k_work, ignored);
  work_ = make_private(results_ / k_work);
  mark_ = mark(work_);
  if (mark_ < 0) throw SystemFailure(fmt::format("{}: cannot be written: {}", work_.string(), std::strerror(-mark_)));
  shared_ = work_ / "shared";
  if (!std::filesystem::create_directory(shared_, ignored)) {
    throw SystemFailure(fmt::format("{}: cannot be made: {}", shared_.string(), ignored.message()));
  }
}

RunFolders::~RunFolders() {
  std::error_code ignored;
  remove_with_mark(work_);
  ::close(mark_);
  if (!is_temporary_) remove_marked_within(results_ / k_work);  // of which solvers were just being ended before
  std::filesystem::remove(results_ / k_work, ignored);          // where it is empty
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

bool RunFolders::recover(const std::filesystem::path& folder) const {
  struct stat there {};
  return ::lstat(folder.c_str(), &there) == 0 && S_ISDIR(there.st_mode) && ::chmod(folder.c_str(), 0700) == 0;
}

std::filesystem::path RunFolders::keep(const std::filesystem::path& folder, bool has_failed, const std::string& name) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::error_code error;
  if (has_failed && ++failed_ > k_max_failed_kept) {
    std::filesystem::remove_all(folder, error);
    return {};
  }
  const std::filesystem::path group = results_ / (has_failed ? k_failed : k_kept);
  std::filesystem::create_directory(group, error);
  std::filesystem::path kept = group / name;
  remove_marked(kept);
  for (int next = 2; std::filesystem::exists(std::filesystem::symlink_status(kept, error)); ++next) {
    kept = group / fmt::format("{}-{}", name, next);  // what has that name is not ours
  }
  const int descriptor = mark(folder);
  if (descriptor >= 0) ::close(descriptor);  // else the folder stays for good
  std::filesystem::rename(folder, kept, error);
  if (error) throw SystemFailure(fmt::format("{}: cannot be made: {}", kept.string(), error.message()));
  has_kept_ = true;
  return kept;
}

void RunFolders::require_room(const std::filesystem::path& folder) const {
  const std::filesystem::path probe = folder / ".mottle-probe";
  std::error_code ignored;
  std::filesystem::remove_all(probe, ignored);  // a link or pipe that the run has left
  const int error = write_plainly(probe, std::string(1 << 16, 'x'));
  ::unlink(probe.c_str());
  if (error == 0) return;
  refuse_write(error,
               fmt::format("{}: cannot be written: {}; what the solver left there is not used, finished runs are "
                           "kept: make room and go on with --resume",
                           folder.string(), std::strerror(error)));
}

void refuse_write(int error, const std::string& text) {
  if (error == ENOSPC || error == EDQUOT) throw NoRoom(text);
  throw SystemFailure(text);
}

void write_run_file(const std::filesystem::path& file, const std::string& bytes) {
  const int error = write_plainly(file, bytes);
  if (error == 0) return;
  refuse_write(error, fmt::format("{}: cannot be written: {}; finished runs are kept, go on with --resume",
                                  file.string(), std::strerror(error)));
}

}  // namespace mottle::drivers
