#include "mottle/core/own_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "mottle/core/error.hpp"
#include "mottle/core/folders.hpp"

namespace mottle {

int open_own_file(const std::filesystem::path& path, ExistingFile existing) {
  const bool is_new = existing == ExistingFile::replace;
  if (is_new) ::unlink(path.c_str());  // where it fails, so does what follows
  // A named pipe would be waited for.
  const int flags = O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | (is_new ? O_EXCL : 0);
  const int descriptor = ::open(path.c_str(), flags, 0644);
  if (descriptor < 0) {
    require(errno != ELOOP, "{}: is a link, and is not followed; take it away or choose another folder with --out",
            path.string());
    refuse_to_write(path, "cannot be written", k_choose_another_folder);
  }
  struct stat status = {};
  if (::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode)) return descriptor;
  ::close(descriptor);
  throw InvalidInput(
      fmt::format("{}: is no regular file; take it away or choose another folder with --out", path.string()));
}

}  // namespace mottle
