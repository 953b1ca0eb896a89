/* A network file system that shows what was written late. Loaded before all other libraries (LD_PRELOAD):
     SHIM_DELAY_MS=n  each open, rename, link and fsync takes that long */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

static void wait_a_little(void) {
  const char* text = getenv("SHIM_DELAY_MS");
  if (text != NULL) usleep(1000 * (useconds_t)atoi(text));
}

static int open_late(const char* real, const char* path, int flags, mode_t mode) {
  wait_a_little();
  int (*next)(const char*, int, ...) = (int (*)(const char*, int, ...))dlsym(RTLD_NEXT, real);
  return next(path, flags, mode);
}

static mode_t mode_of(int flags, va_list rest) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
}

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  return open_late("open", path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  return open_late("open64", path, flags, mode);
}

int rename(const char* from, const char* to) {
  wait_a_little();
  int (*next)(const char*, const char*) = (int (*)(const char*, const char*))dlsym(RTLD_NEXT, "rename");
  const int result = next(from, to);
  wait_a_little();
  return result;
}

int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) {
  wait_a_little();
  int (*next)(int, const char*, int, const char*, int) =
      (int (*)(int, const char*, int, const char*, int))dlsym(RTLD_NEXT, "linkat");
  const int result = next(from_folder, from, to_folder, to, flags);
  wait_a_little();
  return result;
}

int fsync(int descriptor) {
  wait_a_little();
  int (*next)(int) = (int (*)(int))dlsym(RTLD_NEXT, "fsync");
  return next(descriptor);
}
