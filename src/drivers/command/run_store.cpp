#include "mottle/drivers/command/run_store.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "mottle/core/clock.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/own_file.hpp"
#include "mottle/drivers/command/run_folders.hpp"

namespace mottle::drivers {
namespace {

constexpr std::string_view k_magic = "mottle runs 1\n";
constexpr double k_between_flushes_s = 1.0;

struct RecordHead {
  std::uint64_t size = 0;  ///< of the body
  Digest key = {};
  Digest checksum = {};  ///< of key and body
};

Digest checksum_of(const Digest& key, std::string_view body) {
  Checksum sum;
  sum.add(key.data(), sizeof(key));
  sum.add(body);
  return sum.digest();
}

bool read_at(int descriptor, std::uint64_t offset, void* destination, std::size_t size) {
  auto* bytes = static_cast<char*>(destination);
  while (size > 0) {
    const ssize_t got = ::pread(descriptor, bytes, size, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    bytes += got;
    offset += static_cast<std::uint64_t>(got);
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

bool append(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

std::uint64_t size_of(int descriptor) {
  return static_cast<std::uint64_t>(::lseek(descriptor, 0, SEEK_END));
}

/// Visits the whole records from `end` on, each with the place of its body; the end of the last of them.
template <typename Visit>
std::uint64_t walk_records(int descriptor, std::uint64_t end, const Visit& visit) {
  const std::uint64_t size = size_of(descriptor);
  std::string body;
  for (;;) {
    RecordHead head;
    if (end + sizeof(head) > size || !read_at(descriptor, end, &head, sizeof(head))) return end;
    if (head.size > size - end - sizeof(head)) return end;
    body.resize(head.size);
    if (!read_at(descriptor, end + sizeof(head), body.data(), body.size())) return end;
    if (checksum_of(head.key, body) != head.checksum) return end;
    visit(head, end + sizeof(head), body);
    end += sizeof(head) + head.size;
  }
}

}  // namespace

std::uint64_t read_run_records(const std::filesystem::path& file, std::uint64_t from,
                               const std::function<void(const Digest& key, std::string_view body)>& visit) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0) return from;
  std::string magic(k_magic.size(), ' ');
  const bool has_head = read_at(descriptor, 0, magic.data(), magic.size());
  if (!has_head || magic != k_magic) {
    ::close(descriptor);
    if (!has_head) return from;
    throw SystemFailure(fmt::format("{}: is not a store of solver runs", file.string()));
  }
  try {
    from = walk_records(descriptor, std::max<std::uint64_t>(from, k_magic.size()),
                        [&](const RecordHead& head, std::uint64_t, std::string_view body) { visit(head.key, body); });
  } catch (...) {
    ::close(descriptor);
    throw;
  }
  ::close(descriptor);
  return from;
}

bool is_store_held(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0) return false;
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  const bool is_held = ::fcntl(descriptor, F_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
  ::close(descriptor);
  return is_held;
}

RunStore::RunStore(std::filesystem::path file, const std::vector<std::filesystem::path>& others) {
  own_.path = std::move(file);
  own_.descriptor = open_own_file(own_.path, ExistingFile::keep);
  try {
    if (::fcntl(own_.descriptor, F_SETFL, O_APPEND) != 0) {
      throw SystemFailure(fmt::format("{}: cannot be opened: {}", own_.path.string(), std::strerror(errno)));
    }
    struct flock lock {};
    lock.l_type = F_WRLCK;
    lock.l_whence = SEEK_SET;
    require(::fcntl(own_.descriptor, F_SETLK, &lock) == 0 || (errno != EACCES && errno != EAGAIN),
            "{}: another Mottle is filling this folder; wait for its end, or choose another folder with --out",
            own_.path.string());
    open_own();
  } catch (...) {
    ::close(own_.descriptor);
    throw;
  }
  for (const std::filesystem::path& other : others) others_.push_back({.path = other});
  read_others(false);
}

RunStore::~RunStore() {
  if (is_unflushed_) ::fdatasync(own_.descriptor);
  ::close(own_.descriptor);
  for (const File& other : others_) {
    if (other.descriptor >= 0) ::close(other.descriptor);
  }
}

/// Reads the file, or makes it one, and cuts off what a kill has torn.
void RunStore::open_own() {
  const std::uint64_t size = size_of(own_.descriptor);
  std::string magic(std::min<std::uint64_t>(size, k_magic.size()), ' ');
  const bool is_read = read_at(own_.descriptor, 0, magic.data(), magic.size());
  require(is_read && k_magic.starts_with(magic),
          "{}: is not a store of solver runs; take it away or choose another folder "
          "with --out",
          own_.path.string());
  if (magic.size() < k_magic.size() && !append(own_.descriptor, k_magic.substr(magic.size()))) {
    throw SystemFailure(fmt::format("{}: cannot be written: {}", own_.path.string(), std::strerror(errno)));
  }
  own_.end = k_magic.size();
  read_spans(own_, false);
  if (own_.end < size && ::ftruncate(own_.descriptor, static_cast<off_t>(own_.end)) != 0) {
    throw SystemFailure(fmt::format("{}: cannot be cut to size: {}", own_.path.string(), std::strerror(errno)));
  }
}

/// Goes on behind what is known.
void RunStore::read_spans(File& file, bool is_new) {
  file.end = walk_records(file.descriptor, file.end, [&](const RecordHead& head, std::uint64_t at, std::string_view) {
    file.spans[head.key] = {at, head.size, is_new};
  });
}

void RunStore::read_others(bool is_new) const {
  for (File& other : others_) {
    if (other.descriptor < 0) {
      other.descriptor = ::open(other.path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
      if (other.descriptor < 0) continue;
    }
    if (other.end == 0) {
      std::string magic(k_magic.size(), ' ');
      if (!read_at(other.descriptor, 0, magic.data(), magic.size()) || magic != k_magic) continue;
      other.end = magic.size();
    }
    read_spans(other, is_new);
  }
}

std::optional<RunRecord> RunStore::find_in(const File& file, const Digest& key) {
  const auto found = file.spans.find(key);
  if (found == file.spans.end()) return std::nullopt;
  std::string body(found->second.size, ' ');
  if (!read_at(file.descriptor, found->second.offset, body.data(), body.size())) {
    throw SystemFailure(fmt::format("{}: cannot be read: {}", file.path.string(), std::strerror(errno)));
  }
  return decode_run(body);
}

void RunStore::look_at_others() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  read_others(true);
}

std::optional<RunRecord> RunStore::find(const Digest& key) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::optional<RunRecord> record = find_in(own_, key);
  if (record && record->failure.empty()) return record;
  for (const File& other : others_) {
    std::optional<RunRecord> another = find_in(other, key);
    if (another && (!record || another->failure.empty())) record = std::move(another);
  }
  return record;
}

bool RunStore::is_new(const Digest& key) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto knows = [&](const File& file) {
    const auto found = file.spans.find(key);
    return found != file.spans.end() && found->second.is_new;
  };
  return knows(own_) || std::ranges::any_of(others_, knows);
}

void RunStore::keep(const Digest& key, const RunRecord& record) {
  const std::string body = encode(record);
  const RecordHead head{body.size(), key, checksum_of(key, body)};
  std::string bytes(reinterpret_cast<const char*>(&head), sizeof(head));
  bytes += body;
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::uint64_t end = size_of(own_.descriptor);  // a second store of this process may have written
  const double now = steady_seconds();
  is_unflushed_ = true;
  const bool is_due = now >= flushed_at_ + k_between_flushes_s;
  if (!append(own_.descriptor, bytes) || (is_due && ::fdatasync(own_.descriptor) != 0)) {
    const int error = errno;
    [[maybe_unused]] const int ignored = ::ftruncate(own_.descriptor, static_cast<off_t>(end));  // else cut when opened
    refuse(error);
  }
  own_.spans[key] = {end + sizeof(head), body.size(), true};
  if (!is_due) return;
  flushed_at_ = now;
  is_unflushed_ = false;
}

void RunStore::flush() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!is_unflushed_) return;
  if (::fdatasync(own_.descriptor) != 0) refuse(errno);
  flushed_at_ = steady_seconds();
  is_unflushed_ = false;
}

void RunStore::refuse(int error) const {
  refuse_write(error, fmt::format("{}: cannot be written: {}; finished runs are kept, go on with --resume",
                                  own_.path.string(), std::strerror(error)));
}

}  // namespace mottle::drivers
