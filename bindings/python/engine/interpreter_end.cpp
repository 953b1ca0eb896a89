#include "interpreter_end.hpp"

#include <pybind11/pybind11.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "mottle/core/process_mutex.hpp"

namespace mottle::python {
namespace {

namespace py = pybind11;

constexpr std::chrono::seconds k_patience{5};  // with a job that does not stop

struct State {
  ProcessMutex mutex;
  std::condition_variable_any changed;
  pid_t process = 0;  // whose jobs are counted: a fork has none of its parent's
  int jobs = 0;
  int returning = 0;  // of the jobs
  bool is_ending = false;
  bool waits_no_longer = false;
};

/// Never destroyed: threads that sleep for ever outlive static objects.
State& state() {
  static State& the_state = *new State;
  return the_state;
}

/// With the mutex held.
void count_own_jobs(State& s) {
  if (s.process == getpid()) return;
  s.process = getpid();
  s.jobs = s.returning = 0;
  s.is_ending = s.waits_no_longer = false;
}

/// A job that did not stop still uses static objects of the libraries: none is destroyed under it.
void end_process(int status, void* /*unused*/) {
  std::fflush(nullptr);
  _exit(status);
}

void stop_jobs() {
  const py::gil_scoped_release free;
  State& s = state();
  std::unique_lock lock(s.mutex);
  count_own_jobs(s);
  s.is_ending = true;
  s.changed.wait_for(lock, k_patience, [&] { return s.jobs == 0; });
  s.waits_no_longer = true;
  s.changed.wait(lock, [&] { return s.returning == 0; });
  if (s.jobs > 0) on_exit(end_process, nullptr);
}

}  // namespace

void stop_jobs_at_interpreter_end() {
  py::module_::import("atexit").attr("register")(py::cpp_function(stop_jobs));
}

bool is_interpreter_ending() {
  State& s = state();
  const std::lock_guard lock(s.mutex);
  count_own_jobs(s);
  return s.is_ending;
}

void sleep_for_ever() {
  while (true) std::this_thread::sleep_for(std::chrono::hours(1));
}

AwaitedJob::AwaitedJob() {
  State& s = state();
  const std::lock_guard lock(s.mutex);
  count_own_jobs(s);
  if (s.waits_no_longer) throw std::runtime_error("Python is ending, and Mottle has ended: nothing more is computed");
  ++s.jobs;
}

AwaitedJob::~AwaitedJob() {
  State& s = state();
  const std::lock_guard lock(s.mutex);
  count_own_jobs(s);
  if (s.jobs > 0) --s.jobs;
  if (returns_ && s.returning > 0) --s.returning;
  s.changed.notify_all();
}

void AwaitedJob::return_to_python() {
  State& s = state();
  {
    const std::lock_guard lock(s.mutex);
    if (!s.waits_no_longer) {
      returns_ = true;
      ++s.returning;
      return;
    }
  }
  sleep_for_ever();
}

}  // namespace mottle::python
