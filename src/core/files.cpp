#include "mottle/core/files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <utility>

#include "mottle/core/error.hpp"
#include "mottle/core/folders.hpp"

namespace mottle {
namespace {

constexpr const char* k_not_made = "this folder cannot be made";
constexpr const char* k_not_written = "nothing can be written there";
constexpr const char* k_not_regular = "{}: is a {}, a regular file is needed";

/// Closes a file descriptor at the end of its scope.
class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  int get() const { return value_; }
  int release() { return std::exchange(value_, -1); }

 private:
  int value_;
};

std::string error_text() {
  return std::strerror(errno);
}

void write_all(int descriptor, std::string_view bytes, const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw SystemFailure(fmt::format("{}: cannot be written: {}", path.string(), error_text()));
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

/// A name beside `path` that no other writer has, of this process or another.
std::string partial_name(const std::filesystem::path& path) {
  static std::atomic<unsigned> next{0};
  return fmt::format("{}.{}-{}.partial", path.string(), ::getpid(), next++);
}

/// Whether a folder takes a file, which goes again, and has no name where the system has files without one; else errno
/// says why not.
bool take_file(const std::filesystem::path& folder) {
  if (Descriptor(::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0644)).get() >= 0) return true;
  const std::string probe = partial_name(folder / ".mottle-probe");
  const Descriptor descriptor(::open(probe.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644));
  return descriptor.get() >= 0 && ::unlink(probe.c_str()) == 0;
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : ".";
}

/// Opens a new file in the folder of `path`: without a name, so that nothing is left where Mottle is killed, or where
/// the system has none such, under one of its own. Negative: errno says why not.
int open_partial(const std::filesystem::path& path, std::string& name) {
  const bool can_be_named_later = ::access("/proc/self/fd", X_OK) == 0;
  int descriptor = -1;
  if (can_be_named_later) descriptor = ::open(folder_of(path).c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0644);
  for (errno = EEXIST; descriptor < 0 && errno == EEXIST;) {
    name = partial_name(path);
    descriptor = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  }
  return descriptor;
}

/// Gives the open file the name `path`, in place of what has it. A file without a name takes it in one step where it is
/// free; where it is not, the system can only replace by a second name, which a kill between the two steps leaves.
bool rename_into_place(int descriptor, std::string& name, const std::filesystem::path& path) {
  const std::string open = fmt::format("/proc/self/fd/{}", descriptor);
  const auto link = [&](const std::string& to) {
    return ::linkat(AT_FDCWD, open.c_str(), AT_FDCWD, to.c_str(), AT_SYMLINK_FOLLOW) == 0;
  };
  if (name.empty() && link(path.string())) return true;
  for (errno = EEXIST; name.empty() && errno == EEXIST;) {
    const std::string next = partial_name(path);
    if (link(next)) name = next;
  }
  return !name.empty() && ::rename(name.c_str(), path.c_str()) == 0;
}

void flush_folder(const std::filesystem::path& folder) {
  const Descriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // A file system without folder sync (EINVAL) still gave us the rename.
  if (descriptor.get() >= 0) ::fsync(descriptor.get());
}

[[noreturn]] void fail_to_open(const std::filesystem::path& path, int reason) {
  const std::string text = std::strerror(reason);
  require(reason != ENOENT && reason != ENOTDIR, "{}: no such file", path.string());
  require(reason != ENXIO && reason != ENODEV, k_not_regular, path.string(), "socket or device");
  const bool is_machines = reason == EMFILE || reason == ENFILE || reason == ENOMEM || reason == EIO;
  if (is_machines) throw SystemFailure(fmt::format("{}: cannot be opened: {}", path.string(), text));
  throw InvalidInput(fmt::format("{}: cannot be read: {}", path.string(), text));
}

[[noreturn]] void fail_to_read(const std::filesystem::path& path) {
  throw SystemFailure(fmt::format("{}: reading failed: {}", path.string(), error_text()));
}

std::uint64_t size_of_regular_file(int descriptor, const std::filesystem::path& path) {
  struct stat status = {};
  if (::fstat(descriptor, &status) != 0) {
    throw SystemFailure(fmt::format("{}: cannot be read: {}", path.string(), error_text()));
  }
  require(!S_ISDIR(status.st_mode), "{}: is a folder, a file is needed", path.string());
  require(!S_ISFIFO(status.st_mode), k_not_regular, path.string(), "named pipe");
  require(S_ISREG(status.st_mode), k_not_regular, path.string(), "device");
  return static_cast<std::uint64_t>(status.st_size);
}

}  // namespace

BlockReader::BlockReader(std::filesystem::path path, std::uint64_t max_bytes)
    : path_(std::move(path)), max_bytes_(max_bytes) {
  // Without O_NONBLOCK a named pipe waits for its other end; what was opened is then checked, not its name.
  Descriptor opened(::open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (opened.get() < 0) fail_to_open(path_, errno);
  size_ = size_of_regular_file(opened.get(), path_);
  check_size(size_);
  descriptor_ = opened.release();
}

BlockReader::BlockReader(BlockReader&& other) noexcept
    : path_(std::move(other.path_)),
      max_bytes_(other.max_bytes_),
      size_(other.size_),
      read_(other.read_),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

BlockReader::~BlockReader() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void BlockReader::check_size(std::uint64_t size) const {
  require(size <= max_bytes_, "{}: has {} bytes, at most {} are read of such a file", path_.string(), size, max_bytes_);
}

bool BlockReader::ends_with_line() const {
  char last = '\n';
  if (size_ > 0 && ::pread(descriptor_, &last, 1, static_cast<off_t>(size_ - 1)) < 0) fail_to_read(path_);
  return last == '\n';
}

std::size_t BlockReader::read(std::span<char> block) {
  ssize_t count = -1;
  do {
    count = ::read(descriptor_, block.data(), block.size());
  } while (count < 0 && errno == EINTR);
  if (count < 0) fail_to_read(path_);
  read_ += static_cast<std::uint64_t>(count);
  check_size(read_);
  return static_cast<std::size_t>(count);
}

std::string read_file(const std::filesystem::path& path, std::uint64_t max_bytes) {
  BlockReader reader(path, max_bytes);
  std::string bytes(reader.size() + 1, '\0');  // one more shows whether the file has grown
  std::size_t end = 0;
  while (const std::size_t count = reader.read(std::span(bytes).subspan(end))) {
    end += count;
    if (end == bytes.size()) bytes.resize(end + std::max<std::size_t>(end / 2, 65536));
  }
  bytes.resize(end);
  return bytes;
}

void write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
  write_file_atomically(path, std::span(&bytes, 1));
}

void write_file_atomically(const std::filesystem::path& path, std::span<const std::string_view> pieces) {
  std::string partial;
  const Descriptor descriptor(open_partial(path, partial));
  if (descriptor.get() < 0) refuse_to_write(path, "cannot be written", "");
  try {
    for (const std::string_view piece : pieces) write_all(descriptor.get(), piece, path);
    if (::fsync(descriptor.get()) != 0) {
      throw SystemFailure(fmt::format("{}: cannot be flushed to the disk: {}", path.string(), error_text()));
    }
    if (!rename_into_place(descriptor.get(), partial, path)) {
      throw SystemFailure(fmt::format("{}: cannot be put in place: {}", path.string(), error_text()));
    }
  } catch (const Error&) {
    if (!partial.empty()) ::unlink(partial.c_str());
    throw;
  }
  flush_folder(folder_of(path));
}

std::filesystem::path temporary_folder() {
  std::error_code error;
  std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  if (!error) return folder;
  const char* given = std::getenv("TMPDIR");
  throw SystemFailure(fmt::format("{}: the folder for temporary files: {}; set TMPDIR to one that is there",
                                  given != nullptr ? given : "/tmp", error.message()));
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (temporary_folder() / "mottle-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) {
    throw SystemFailure(fmt::format("{}: no folder can be made there: {}", temporary_folder().string(), error_text()));
  }
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

void refuse_to_write(const std::filesystem::path& path, const char* what, const char* advice) {
  const std::string message = fmt::format("{}: {}: {}", path.string(), what, error_text());
  for (const int limit : {ENOSPC, EDQUOT, EMFILE, ENFILE, ENOMEM, EIO}) {
    if (errno == limit) throw SystemFailure(message);
  }
  throw InvalidInput(message + advice);
}

std::vector<std::filesystem::path> missing_folders(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> missing;
  std::error_code ignored;
  for (std::filesystem::path path = std::filesystem::absolute(folder).lexically_normal();
       !std::filesystem::exists(std::filesystem::symlink_status(path, ignored)) && path.has_relative_path();
       path = path.parent_path()) {
    missing.push_back(path);
  }
  return missing;
}

void make_writable_folder(const std::filesystem::path& folder) {
  const std::vector<std::filesystem::path> made = missing_folders(folder);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored)) {
    require(static_cast<bool>(error), "{}: this folder cannot be made: something else has that name", folder.string());
    errno = error.value();
    refuse_to_write(folder, k_not_made, "");
  }
  if (take_file(folder)) return;
  const int reason = errno;
  for (const std::filesystem::path& path : made) std::filesystem::remove(path, ignored);
  errno = reason;
  refuse_to_write(folder, k_not_written, k_choose_another_folder);
}

void require_writable_folder(const std::filesystem::path& folder) {
  const std::vector<std::filesystem::path> missing = missing_folders(folder);
  const std::filesystem::path place = missing.empty() ? folder : missing.back().parent_path();
  std::error_code ignored;
  const bool is_nameable = std::filesystem::status(folder, ignored).type() != std::filesystem::file_type::none;
  if (!is_nameable || !std::filesystem::is_directory(place, ignored)) {
    make_writable_folder(folder);  // says why not
    return;
  }
  // A file without a name changes nothing, not even the folder's time; where the system has none such, one with a name.
  if (Descriptor(::open(place.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0644)).get() >= 0) return;
  if (missing.empty()) {
    make_writable_folder(folder);
    return;
  }
  std::string probe = (place / ".mottle-probe-XXXXXX").string();
  if (::mkdtemp(probe.data()) == nullptr) refuse_to_write(folder, k_not_made, "");
  const bool is_taken = take_file(probe);
  const int reason = errno;
  ::rmdir(probe.c_str());
  errno = reason;
  if (!is_taken) refuse_to_write(folder, k_not_written, k_choose_another_folder);
}

}  // namespace mottle
