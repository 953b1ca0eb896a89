#include "mottle/core/process_mutex.hpp"

#include <pthread.h>

#include <algorithm>
#include <vector>

namespace mottle {
namespace {

struct Known {
  std::mutex mutex;
  std::vector<ProcessMutex*> all;
};

/// Never destroyed: threads may fork while static objects are destroyed.
Known& known() {
  static Known& the_known = *new Known;
  return the_known;
}

/// While it waits for one it holds none, whatever the order in which others take them.
void lock_all() {
  known().mutex.lock();
  const std::vector<ProcessMutex*>& all = known().all;
  for (auto next = all.begin(); next != all.end();) {
    if ((*next)->try_lock()) {
      ++next;
      continue;
    }
    std::for_each(all.begin(), next, [](ProcessMutex* held) { held->unlock(); });
    const std::lock_guard until_free(**next);
    next = all.begin();
  }
}

void unlock_all() {
  for (ProcessMutex* held : known().all) held->unlock();
  known().mutex.unlock();
}

}  // namespace

ProcessMutex::ProcessMutex() {
  static const int k_is_registered = ::pthread_atfork(lock_all, unlock_all, unlock_all);
  static_cast<void>(k_is_registered);
  const std::lock_guard lock(known().mutex);
  known().all.push_back(this);
}

ProcessMutex::~ProcessMutex() {
  const std::lock_guard lock(known().mutex);
  std::erase(known().all, this);
}

}  // namespace mottle
