#include "drivers/umbridge/request_queue.hpp"

#include "mottle/core/error.hpp"

namespace mottle::drivers {

void RequestQueue::add(WaitingRequest waiting) {
  const std::lock_guard<std::mutex> lock(mutex_);
  queue_.push_back(std::move(waiting));
  changed_.notify_one();
}

void RequestQueue::end() {
  std::deque<WaitingRequest> rest;  // declared first, so that sessions end after the lock is given back
  const std::lock_guard<std::mutex> lock(mutex_);
  is_over_ = true;
  rest.swap(queue_);
  changed_.notify_one();
}

bool RequestQueue::has_failed() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return error_ != nullptr;
}

void RequestQueue::rethrow() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (error_) std::rethrow_exception(error_);
}

/// Waits for requests; none: it is over.
std::vector<WaitingRequest> RequestQueue::take_batch() {
  const auto is_evaluation = [](const WaitingRequest& waiting) {
    return waiting.computation.kind == Computation::Kind::evaluate;
  };
  std::vector<WaitingRequest> batch;
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return is_over_ || !queue_.empty(); });
  if (is_over_) return batch;
  do {
    batch.push_back(std::move(queue_.front()));
    queue_.pop_front();
  } while (!queue_.empty() && is_evaluation(batch.back()) && is_evaluation(queue_.front()) &&
           static_cast<Eigen::Index>(batch.size()) < model_.batch);
  return batch;
}

std::vector<ServerAnswer> RequestQueue::computed(const std::vector<WaitingRequest>& batch) const {
  const Computation& first = batch.front().computation;
  if (first.kind != Computation::Kind::evaluate) return {derivative_answer(first, model_.jacobian(first.x))};
  Eigen::MatrixXd samples(static_cast<Eigen::Index>(batch.size()), model_.inputs);
  for (std::size_t i = 0; i < batch.size(); ++i) samples.row(static_cast<Eigen::Index>(i)) = batch[i].computation.x;
  const Evaluation found = model_.evaluate(samples);
  std::vector<std::string> failures(batch.size());
  for (const FailedRun& run : found.failures) failures[static_cast<std::size_t>(run.sample)] = run.reason;
  std::vector<ServerAnswer> answers;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    answers.push_back(outputs_answer(found.outputs.row(static_cast<Eigen::Index>(i)), failures[i]));
  }
  return answers;
}

/// A model that fails is told to the clients whose requests these are; others may have more luck.
void RequestQueue::compute_next(const std::vector<WaitingRequest>& batch) const {
  std::vector<ServerAnswer> answers;
  try {
    answers = computed(batch);
  } catch (const Stopped&) {
    throw;
  } catch (const Error& error) {
    answers.assign(batch.size(), error_answer(500, "InvalidOutput", error.what()));
  }
  for (std::size_t i = 0; i < batch.size(); ++i) batch[i].reply(std::move(answers[i]));
}

void RequestQueue::compute_all() {
  std::vector<WaitingRequest> batch;
  try {
    for (;;) {
      batch = take_batch();
      if (batch.empty()) return;
      compute_next(batch);
    }
  } catch (...) {
    const std::lock_guard<std::mutex> lock(mutex_);
    error_ = std::current_exception();
    unanswered_ = std::move(batch);
  }
}

}  // namespace mottle::drivers
