// Requests that wait for the model, and the thread's work that computes them.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <vector>

#include "drivers/umbridge/model_requests.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

/// A request that waits for its computation.
struct WaitingRequest {
  Computation computation;
  std::function<void(ServerAnswer)> reply;  ///< called once; keeps its client's session until then
};

class RequestQueue {
 public:
  /// @param model  outlives this object
  explicit RequestQueue(const ServedModel& model) : model_(model) {}

  void add(WaitingRequest waiting);
  /// Computes what is added and replies, in the order of requests, until end() or an exception that no answer tells.
  void compute_all();
  /// Ends compute_all() after the present computation; what still waits goes unanswered.
  void end();

  bool has_failed();
  /// The exception that ended compute_all(), if any.
  void rethrow();

 private:
  std::vector<WaitingRequest> take_batch();
  std::vector<ServerAnswer> computed(const std::vector<WaitingRequest>& batch) const;
  void compute_next(const std::vector<WaitingRequest>& batch) const;

  const ServedModel& model_;
  std::mutex mutex_;  // of all below
  std::condition_variable changed_;
  std::deque<WaitingRequest> queue_;
  bool is_over_ = false;
  std::exception_ptr error_;
  std::vector<WaitingRequest> unanswered_;  // because of it; their sessions end with this object, in its owner's thread
};

}  // namespace mottle::drivers
