// A job beside the interpreter: the engine works in a thread of its own without the interpreter's lock, while the
// thread that called serves what the engine asks of Python (a model's values, progress) and listens for Ctrl-C.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "mottle/core/run_context.hpp"

namespace mottle::python {

/// Made and used on the calling thread; lives as long as the job.
class CallingThread final : public ProgressObserver {
 public:
  /// @param progress  None, or called as progress(phase, work, done, total) from the calling thread, ten times a second
  ///                  at most
  explicit CallingThread(pybind11::object progress) : progress_(std::move(progress)) {}

  /// What `work` returns. The interpreter's lock is held when it begins and ends, and free in between.
  ///
  /// @throws what `work` throws; what Python raised in a request or in `progress`; KeyboardInterrupt after Ctrl-C: the
  ///         job is asked to stop, and has come to rest; SystemExit likewise where the interpreter ends meanwhile, in a
  ///         daemon thread
  template <typename Work>
  std::invoke_result_t<Work> run(const Work& work) {
    std::optional<std::invoke_result_t<Work>> result;
    run_job([&] { result.emplace(work()); });
    return *std::move(result);
  }

  /// What `work(stop)` returns, where the work owns all that it uses and asks nothing of Python: after Ctrl-C it is
  /// asked to stop by `stop`, and where it does not at once it is left to itself, until the next place where it can.
  ///
  /// @throws what `work` throws; KeyboardInterrupt, SystemExit as run()
  template <typename Work>
  static std::invoke_result_t<Work, const std::atomic<bool>*> run_by_itself(Work work) {
    struct Job {
      explicit Job(Work given) : work(std::move(given)) {}
      Work work;
      std::optional<std::invoke_result_t<Work, const std::atomic<bool>*>> result;
      CallingThread caller{pybind11::none()};
    };
    const auto job = std::make_shared<Job>(std::move(work));
    job->caller.run_job([job] { job->result.emplace(job->work(job->caller.stop())); }, true);
    return *std::move(job->result);
  }

  /// From a thread of the job: runs `request` on the calling thread, with the interpreter's lock, and waits for it.
  ///
  /// @throws Stopped  Python raised: run() raises it again
  void ask(const std::function<void()>& request);

  const std::atomic<bool>* stop() const { return &stop_; }
  /// Remarks and warnings of the job, in order.
  const std::vector<std::string>& warnings() const { return warnings_; }

  void phase(const Phase& next) override;
  void progress(const std::string& work, std::int64_t done, std::int64_t total) override;
  void warning(const std::string& text) override;
  void note(const std::string& /*text*/) override {}

 private:
  struct Request {
    const std::function<void()>* work;
    bool is_done = false;
    bool has_failed = false;
  };
  struct Progress {
    std::string phase, work;
    std::int64_t done = 0, total = 0;
    bool is_new = false;
  };

  /// @param may_be_left  `job` holds this object, and all that it uses
  void run_job(std::function<void()> job, bool may_be_left = false);
  /// Without the interpreter's lock: until the job is over (true), or asks something, or it is time to look for Ctrl-C.
  /// While the interpreter ends, what is asked is refused, and the job alone is waited for.
  bool wait();
  void serve();
  void show_progress();
  /// Keeps what Python raised, the first alone, and stops the job.
  void keep_raised();

  pybind11::object progress_;
  std::atomic<bool> stop_{false};
  std::mutex mutex_;  // of all below
  std::condition_variable changed_;
  std::deque<Request*> requests_;
  Progress shown_;
  std::vector<std::string> warnings_;
  bool is_over_ = false;
  std::exception_ptr failure_;  // of the job
  std::exception_ptr raised_;   // by Python; the calling thread's
  double last_shown_ = 0.0;
};

}  // namespace mottle::python
