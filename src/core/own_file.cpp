#include "mottle/core/own_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "mottle/core/error.hpp"

namespace mottle {
namespace {

constexpr std::array k_limits_of_the_machine = {ENOSPC, EDQUOT, EMFILE, ENFILE, ENOMEM, EIO};

}  // namespace

int open_own_file(const std::filesystem::path& path, ExistingFile existing) {
  const bool is_new = existing == ExistingFile::replace;
  if (is_new) ::unlink(path.c_str());  // where it fails, so does what follows
  // A named pipe would be waited for.
  const int flags = O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | (is_new ? O_EXCL : 0);
  const int descriptor = ::open(path.c_str(), flags, 0644);
  if (descriptor < 0) {
    const int reason = errno;
    const std::string message = fmt::format("{}: cannot be written: {}", path.string(), std::strerror(reason));
    if (std::ranges::count(k_limits_of_the_machine, reason) > 0) throw SystemFailure(message);
    require(reason != ELOOP, "{}: is a link, and is not followed; take it away or name another place with --out",
            path.string());
    throw InvalidInput(message + "; name another place with --out");
  }
  struct stat status = {};
  if (::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode)) return descriptor;
  ::close(descriptor);
  throw InvalidInput(
      fmt::format("{}: is no regular file; take it away or name another place with --out", path.string()));
}

}  // namespace mottle
