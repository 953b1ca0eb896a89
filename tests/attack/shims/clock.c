/* A clock that is set while the command runs. Loaded before all other libraries (LD_PRELOAD):
     SHIM_JUMP=s      every call moves the time of day by that many seconds more, forth and back in turn (0: not)
     SHIM_SHIFT=s     the time of day is that many seconds off */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdlib.h>
#include <sys/time.h>
#include <time.h>

static long long setting(const char* name) {
  const char* text = getenv(name);
  return text == NULL ? 0 : atoll(text);
}

static long long offset(void) {
  static long long calls;
  const long long jump = setting("SHIM_JUMP");
  return setting("SHIM_SHIFT") + (++calls % 2 == 0 ? jump : -jump);
}

int clock_gettime(clockid_t clock, struct timespec* now) {
  int (*next)(clockid_t, struct timespec*) = (int (*)(clockid_t, struct timespec*))dlsym(RTLD_NEXT, "clock_gettime");
  const int result = next(clock, now);
  if (result == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)) now->tv_sec += offset();
  return result;
}

int gettimeofday(struct timeval* restrict now, void* restrict zone) {
  int (*next)(struct timeval*, void*) = (int (*)(struct timeval*, void*))dlsym(RTLD_NEXT, "gettimeofday");
  const int result = next(now, zone);
  if (result == 0) now->tv_sec += offset();
  return result;
}

time_t time(time_t* result) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  if (result != NULL) *result = now.tv_sec;
  return now.tv_sec;
}
