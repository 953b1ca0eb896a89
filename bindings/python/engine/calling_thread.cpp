#include "calling_thread.hpp"

#include <cxxabi.h>

#include <chrono>
#include <thread>
#include <utility>

#include "interpreter_end.hpp"
#include "mottle/core/error.hpp"

namespace mottle::python {
namespace {

namespace py = pybind11;

constexpr std::chrono::milliseconds k_listening{50};  // between two looks for Ctrl-C
constexpr double k_between_progress = 0.1;            // seconds

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

void CallingThread::run_job(std::function<void()> job, bool may_be_left) {
  auto awaited = std::make_shared<AwaitedJob>();
  std::thread worker([this, awaited, job = std::move(job)]() mutable {
    try {
      job();
    } catch (...) {
      failure_ = std::current_exception();
    }
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      is_over_ = true;
      changed_.notify_all();
    }
    job = nullptr;  // the last that holds a job that was left, which the interpreter's end waits for
    awaited.reset();
  });
  while (true) {
    const bool is_asked_to_stop = raised_ != nullptr;
    PyThreadState* const interpreter = PyEval_SaveThread();
    const bool is_over = wait();
    if (is_over) {
      worker.join();
      awaited->return_to_python();
    }
    PyEval_RestoreThread(interpreter);
    if (is_over) break;
    if (may_be_left && is_asked_to_stop) {
      worker.detach();
      progress_ = py::object();  // let go with the interpreter's lock
      std::rethrow_exception(std::exchange(raised_, nullptr));
    }
    serve();
    if (PyErr_CheckSignals() != 0) keep_raised();
    show_progress();
  }
  if (is_interpreter_ending()) {  // ends a thread without a word
    PyErr_SetNone(PyExc_SystemExit);
    throw py::error_already_set();
  }
  if (raised_) std::rethrow_exception(raised_);
  if (failure_) std::rethrow_exception(failure_);
}

bool CallingThread::wait() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    changed_.wait_for(lock, k_listening, [this] { return is_over_ || !requests_.empty(); });
    if (is_over_) return true;
    if (!is_interpreter_ending()) return false;
    stop_ = true;
    for (Request* request : requests_) request->has_failed = request->is_done = true;
    requests_.clear();
    changed_.notify_all();
  }
}

void CallingThread::serve() {
  while (true) {
    Request* request = nullptr;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (requests_.empty()) return;
      request = requests_.front();
      requests_.pop_front();
    }
    bool has_failed =
        raised_ != nullptr || is_interpreter_ending();  // the job is at its end: Python is not asked again
    if (!has_failed) {
      try {
        (*request->work)();
      } catch (const abi::__forced_unwind&) {
        sleep_for_ever();  // Python has ended, and ends this thread, which the job still needs
      } catch (...) {
        has_failed = true;
        if (!raised_) raised_ = std::current_exception();
        stop_ = true;
      }
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    request->has_failed = has_failed;
    request->is_done = true;
    changed_.notify_all();
  }
}

void CallingThread::keep_raised() {
  py::error_already_set error;  // takes it from the interpreter
  if (!raised_) raised_ = std::make_exception_ptr(std::move(error));
  stop_ = true;
}

void CallingThread::ask(const std::function<void()>& work) {
  Request request{&work};
  std::unique_lock<std::mutex> lock(mutex_);
  requests_.push_back(&request);
  changed_.notify_all();
  changed_.wait(lock, [&] { return request.is_done; });
  if (request.has_failed) throw Stopped("stopped: Python raised an exception");
}

void CallingThread::show_progress() {
  if (progress_.is_none() || raised_ || now() < last_shown_ + k_between_progress) return;
  Progress progress;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!shown_.is_new) return;
    shown_.is_new = false;
    progress = shown_;
  }
  last_shown_ = now();
  try {
    progress_(progress.phase, progress.work, progress.done, progress.total);
  } catch (const abi::__forced_unwind&) {
    sleep_for_ever();  // as in serve()
  } catch (...) {
    raised_ = std::current_exception();
    stop_ = true;
  }
}

void CallingThread::phase(const Phase& next) {
  const std::lock_guard<std::mutex> lock(mutex_);
  shown_ = {};
  shown_.phase = next.text();
  shown_.is_new = true;
}

void CallingThread::progress(const std::string& work, std::int64_t done, std::int64_t total) {
  const std::lock_guard<std::mutex> lock(mutex_);
  shown_.work = work;
  shown_.done = done;
  shown_.total = total;
  shown_.is_new = true;
}

void CallingThread::warning(const std::string& text) {
  const std::lock_guard<std::mutex> lock(mutex_);
  warnings_.push_back(text);
}

}  // namespace mottle::python
