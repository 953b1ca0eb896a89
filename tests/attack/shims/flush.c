/* A disk that loses what was not flushed. Loaded before all other libraries (LD_PRELOAD), by environment:
     SHIM_FSYNC=n     the n-th fsync or fdatasync, and all that follow, fail with EIO
     SHIM_RENAME=n    the power goes at the n-th rename or link, just after it
     SHIM_LOSE=1      with SHIM_RENAME: every file that got a name without being flushed first loses its bytes */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { k_files = 4096 };
static ino_t flushed[k_files];
static int n_flushed, n_syncs, n_names;

static int setting(const char* name) {
  const char* text = getenv(name);
  return text == NULL ? 0 : atoi(text);
}

static int flush(int descriptor, const char* real) {
  struct stat state;
  if (fstat(descriptor, &state) == 0 && S_ISREG(state.st_mode)) {
    const int fails = setting("SHIM_FSYNC");
    if (fails > 0 && ++n_syncs >= fails) {
      errno = EIO;
      return -1;
    }
    if (n_flushed < k_files) flushed[n_flushed++] = state.st_ino;
  }
  int (*next)(int) = (int (*)(int))dlsym(RTLD_NEXT, real);
  return next(descriptor);
}

int fsync(int descriptor) { return flush(descriptor, "fsync"); }
int fdatasync(int descriptor) { return flush(descriptor, "fdatasync"); }

static int was_flushed(const char* path) {
  struct stat state;
  if (stat(path, &state) != 0 || !S_ISREG(state.st_mode)) return 1;
  for (int i = 0; i < n_flushed; ++i) {
    if (flushed[i] == state.st_ino) return 1;
  }
  return 0;
}

static void lose_unflushed(const char* path) {
  if (setting("SHIM_LOSE") && !was_flushed(path) && truncate(path, 0) != 0) _exit(99);
}

static int named(int result) {
  const int dies = setting("SHIM_RENAME");
  if (result == 0 && dies > 0 && ++n_names == dies) _exit(98);
  return result;
}

int rename(const char* from, const char* to) {
  lose_unflushed(from);
  int (*next)(const char*, const char*) = (int (*)(const char*, const char*))dlsym(RTLD_NEXT, "rename");
  return named(next(from, to));
}

int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) {
  lose_unflushed(from);
  int (*next)(int, const char*, int, const char*, int) =
      (int (*)(int, const char*, int, const char*, int))dlsym(RTLD_NEXT, "linkat");
  return named(next(from_folder, from, to_folder, to, flags));
}
