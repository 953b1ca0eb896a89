// Jobs of daemon threads at the interpreter's end. A thread that asks for the interpreter's lock then is ended by
// Python in the middle of the engine, which takes the whole process with it: so jobs are stopped and waited for before,
// and a thread whose job does not stop in time never returns to Python.
#pragma once

namespace mottle::python {

/// Has Python call, before it ends, what stops the jobs and waits for them, a few seconds at most.
void stop_jobs_at_interpreter_end();

/// Whether the interpreter ends: jobs stop, and Python is asked nothing any more.
bool is_interpreter_ending();

/// The calling thread sleeps until the process is gone.
[[noreturn]] void sleep_for_ever();

/// A job that the interpreter's end waits for; made with the interpreter's lock, and destroyed with it, or by the
/// thread of a job that nobody waits for any more.
class AwaitedJob {
 public:
  AwaitedJob();
  ~AwaitedJob();
  AwaitedJob(const AwaitedJob&) = delete;
  AwaitedJob& operator=(const AwaitedJob&) = delete;

  /// Without the interpreter's lock, before it is taken for good: from here on the end waits as long as it must. Does
  /// not return where it waits no longer.
  void return_to_python();

 private:
  bool returns_ = false;
};

}  // namespace mottle::python
