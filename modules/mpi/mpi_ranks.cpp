// The ranks of a job by MPI. Rank 0 serves the others with a thread of its own: it keeps the shared counters and hears
// how they end, while its other threads compute.
#include <algorithm>
#include <chrono>
#include <cstring>
#include <map>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <unordered_map>

#include "message_calls.hpp"
#include "mottle/core/launcher.hpp"
#include "mottle/core/ranks.hpp"

namespace mottle::mpi {
namespace {

enum Tag : int { counter_asked = 1, end_told = 2, job_ends = 3, claim_asked = 4, made_told = 5, first_answer = 16 };

constexpr std::chrono::milliseconds k_grace{700};  // for ranks that meet the same error a little later

/// A question for a counter; the answer comes with the asker's tag, for several of its threads may ask at once.
struct CounterRequest {
  std::uint64_t counter = 0;
  std::int64_t amount = 0;
  int answer_tag = 0;
};

/// A question for what is made once for all; the answer is a Claim and what was made.
struct ClaimRequest {
  Digest key = {};
  int may_make = 0;
  int answer_tag = 0;
};

template <typename Value>
std::string_view bytes_of(const Value& value) {
  return {reinterpret_cast<const char*>(&value), sizeof(value)};
}

template <typename Value>
Value value_of(const std::string& bytes) {
  Value value{};
  std::memcpy(&value, bytes.data(), std::min(sizeof(value), bytes.size()));
  return value;
}

/// How a rank ends, and whether it has left a collective call, so that MPI cannot be finalized.
struct ToldEnd {
  int code = 0;
  int is_torn = 0;
};

std::string encode(const RankEnd& end, bool is_torn) {
  return std::string(bytes_of(ToldEnd{end.code, is_torn ? 1 : 0})) + end.message;
}

RankEnd decode(const std::string& bytes) {
  return {.code = value_of<ToldEnd>(bytes).code, .message = bytes.substr(std::min(bytes.size(), sizeof(ToldEnd)))};
}

class MpiRanks final : public Ranks {
 public:
  MpiRanks() {
    if (!is_first() || count() == 1) return;
    server_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
  }
  /// A job that ends by leave() has ended MPI too. One that does not is ended by its launcher.
  ~MpiRanks() override = default;
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;

  int rank() const override { return calls_.rank(); }
  int count() const override { return calls_.count(); }
  std::vector<std::string> gather(std::string_view bytes) override { return calls_.gather(bytes, stop()); }
  std::int64_t add(std::uint64_t counter, std::int64_t amount) override;
  RankEnd leave(const RankEnd& own) override;
  void on_abort(OnAbort tell) override {
    const std::lock_guard lock(mutex_);
    on_abort_ = std::move(tell);
  }

 protected:
  Claim claim(const Digest& key, bool may_make, std::string& made) override;
  void publish(const Digest& key, std::string_view made) override;

 private:
  using Clock = std::chrono::steady_clock;

  std::int64_t add_here(std::uint64_t counter, std::int64_t amount);
  Claim claim_here(const Digest& key, bool may_make, std::string& made);
  int new_answer_tag();
  bool serve_claims();
  void serve(const std::stop_token& stop);
  bool serve_once();
  void abort_if_overdue();
  bool have_all_left();
  RankEnd leave_first(const RankEnd& own);

  MessageCalls calls_;
  std::mutex mutex_;  // of all below but the thread
  std::unordered_map<std::uint64_t, std::int64_t> counters_;
  int next_tag_ = 0;
  std::map<int, RankEnd> ends_;  // of other ranks
  std::optional<Clock::time_point> first_failure_;
  bool is_torn_ = false;  ///< a rank has left a collective call
  OnceBook book_;
  OnAbort on_abort_;
  bool is_leaving_ = false;
  std::jthread server_;
};

std::int64_t MpiRanks::add_here(std::uint64_t counter, std::int64_t amount) {
  const std::lock_guard lock(mutex_);
  std::int64_t& value = counters_[counter];
  const std::int64_t before = value;
  value += amount;
  return before;
}

std::int64_t MpiRanks::add(std::uint64_t counter, std::int64_t amount) {
  if (is_first()) return add_here(counter, amount);
  const CounterRequest request{.counter = counter, .amount = amount, .answer_tag = new_answer_tag()};
  calls_.send(0, counter_asked, bytes_of(request));
  return value_of<std::int64_t>(calls_.receive(0, request.answer_tag));
}

int MpiRanks::new_answer_tag() {
  constexpr int k_tags = 4096;  // threads of one rank that ask at once
  const std::lock_guard lock(mutex_);
  next_tag_ = (next_tag_ + 1) % k_tags;
  return first_answer + next_tag_;
}

Claim MpiRanks::claim_here(const Digest& key, bool may_make, std::string& made) {
  const std::lock_guard lock(mutex_);
  return book_.claim(key, may_make, made);
}

Claim MpiRanks::claim(const Digest& key, bool may_make, std::string& made) {
  if (is_first()) return claim_here(key, may_make, made);
  const ClaimRequest request{.key = key, .may_make = may_make ? 1 : 0, .answer_tag = new_answer_tag()};
  calls_.send(0, claim_asked, bytes_of(request));
  const std::string answer = calls_.receive(0, request.answer_tag);
  made = answer.substr(std::min(answer.size(), sizeof(Claim)));
  return value_of<Claim>(answer);
}

void MpiRanks::publish(const Digest& key, std::string_view made) {
  if (!is_first()) return calls_.send(0, made_told, std::string(bytes_of(key)) + std::string(made));
  const std::lock_guard lock(mutex_);
  book_.publish(key, made);
}

bool MpiRanks::serve_claims() {
  Message message;
  if (calls_.poll(claim_asked, message)) {
    const auto request = value_of<ClaimRequest>(message.bytes);
    std::string made;
    const Claim claimed = claim_here(request.key, request.may_make != 0, made);
    calls_.send(message.source, request.answer_tag, std::string(bytes_of(claimed)) + made);
    return true;
  }
  if (!calls_.poll(made_told, message)) return false;
  const std::lock_guard lock(mutex_);
  book_.publish(value_of<Digest>(message.bytes), std::string_view(message.bytes).substr(sizeof(Digest)));
  return true;
}

bool MpiRanks::serve_once() {
  Message message;
  if (calls_.poll(counter_asked, message)) {
    const auto request = value_of<CounterRequest>(message.bytes);
    calls_.send(message.source, request.answer_tag, bytes_of(add_here(request.counter, request.amount)));
    return true;
  }
  if (calls_.poll(end_told, message)) {
    const std::lock_guard lock(mutex_);
    const RankEnd& end = ends_[message.source] = decode(message.bytes);
    if (value_of<ToldEnd>(message.bytes).is_torn != 0) is_torn_ = true;
    if (end.code != 0 && !first_failure_) first_failure_ = Clock::now();
    return true;
  }
  return serve_claims();
}

/// A rank has failed, and rank 0, which did not, is in the midst of its work.
void MpiRanks::abort_if_overdue() {
  RankEnd failed;
  OnAbort tell;
  {
    const std::lock_guard lock(mutex_);
    if (is_leaving_ || !first_failure_ || Clock::now() < *first_failure_ + k_grace) return;
    for (const auto& [rank, end] : ends_) {
      if (end.code == 0) continue;
      failed = end;
      break;
    }
    tell = on_abort_;
  }
  if (tell) tell(failed);
  calls_.abort(failed.code);
}

void MpiRanks::serve(const std::stop_token& stop) {
  // Between questions of a loop that is under way, it looks the more seldom the longer its pieces take.
  constexpr Clock::duration k_busy = std::chrono::microseconds(50);
  constexpr Clock::duration k_idle = std::chrono::milliseconds(1);
  constexpr int k_looks = 32;  // the wait for an answer is a small part of a piece
  Clock::time_point last = Clock::now() - k_looks * k_idle;
  while (!stop.stop_requested()) {
    if (serve_once()) {
      last = Clock::now();
      continue;
    }
    abort_if_overdue();
    std::this_thread::sleep_for(std::clamp((Clock::now() - last) / k_looks, k_busy, k_idle));
  }
}

bool MpiRanks::have_all_left() {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(ends_.size()) == count() - 1;
}

RankEnd MpiRanks::leave_first(const RankEnd& own) {
  {
    const std::lock_guard lock(mutex_);
    is_leaving_ = true;
  }
  const Clock::time_point begin = Clock::now();
  const auto is_overdue = [&] {
    const std::lock_guard lock(mutex_);
    const bool has_failed = own.code != 0 || first_failure_;
    return has_failed && Clock::now() > std::max(begin, first_failure_.value_or(begin)) + k_grace;
  };
  while (count() > 1 && !have_all_left() && !is_overdue()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  RankEnd result = own;
  bool can_finalize = (count() == 1 || have_all_left()) && !calls_.is_torn();
  {
    const std::lock_guard lock(mutex_);
    can_finalize = can_finalize && !is_torn_;
    for (const auto& [rank, end] : ends_) {
      if (result.code == 0) result = end;
    }
  }
  if (!can_finalize) {
    if (on_abort_) on_abort_(result);
    calls_.abort(result.code);
  }
  server_ = {};
  for (int other = 1; other < count(); ++other) calls_.send(other, job_ends, encode({.code = result.code}, false));
  return result;
}

RankEnd MpiRanks::leave(const RankEnd& own) {
  RankEnd result;
  if (is_first()) {
    result = leave_first(own);
  } else {
    calls_.send(0, end_told, encode(own, calls_.is_torn()));
    result = decode(calls_.receive(0, job_ends));
  }
  calls_.finalize();
  return result;
}

}  // namespace
}  // namespace mottle::mpi

extern "C" {
// The names that mottle/core/launcher.hpp looks for.
// NOLINTNEXTLINE(readability-identifier-naming): a name of C
extern const int mottle_ranks_version;
const int mottle_ranks_version = mottle::k_ranks_version;
mottle::Ranks* mottle_join_ranks();
mottle::Ranks* mottle_join_ranks() {
  return new mottle::mpi::MpiRanks();
}
}
