// The processes of one job, and what they tell each other. How they do that is a module's business (modules/mpi); the
// library knows this interface only.
#pragma once

#include <atomic>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "mottle/core/checksum.hpp"

namespace mottle {

/// How a rank ends: its exit code, and what it has to say to the user.
struct RankEnd {
  int code = 0;
  std::string message = {};
};

/// Whose business it is to make something once for all ranks.
enum class Claim : std::uint8_t {
  own,      ///< the asker's
  awaited,  ///< another rank's, which has not made it yet
  made      ///< it is there
};

/// What ranks have made once for all, as the one of them keeps it that the others ask. (Inline: the module for MPI
/// links nothing of the library.)
class OnceBook {
 public:
  Claim claim(const Digest& key, bool may_make, std::string& made) {
    const auto found = entries_.find(key);
    if (found == entries_.end()) {
      if (!may_make) return Claim::awaited;
      entries_.emplace(key, std::nullopt);
      return Claim::own;
    }
    if (!found->second) return Claim::awaited;
    made = *found->second;
    return Claim::made;
  }
  void publish(const Digest& key, std::string_view made) { entries_[key] = made; }

 private:
  std::map<Digest, std::optional<std::string>> entries_;  // nothing: somebody is making it
};

/// Processes that all run the same job on the same input: every decision is taken by each of them and is the same, only
/// the evaluation of batches is shared out.
class Ranks {
 public:
  virtual ~Ranks() = default;

  virtual int rank() const = 0;   ///< of this process, from 0 on; rank 0 alone writes files and speaks to the user
  virtual int count() const = 0;  ///< of all processes, >= 1
  bool is_first() const { return rank() == 0; }

  /// What each rank gives, by rank. All ranks call it, in the same order, from one thread. Throws Stopped: then this
  /// rank can only leave.
  virtual std::vector<std::string> gather(std::string_view bytes) = 0;

  /// Adds to a counter that all ranks share and returns what it held before, 0 at first. Any thread, at any time.
  virtual std::int64_t add(std::uint64_t counter, std::int64_t amount) = 0;
  /// A counter that nobody has used. All ranks call it, in the same order, from one thread.
  std::uint64_t new_counter() { return ++counters_; }

  /// What one rank makes for all, by its key: the first that asks makes it, the others wait. Any thread, in any order.
  /// It is kept to the end of the job.
  ///
  /// @param may_make  false: this rank only waits; rank 0 makes at least
  /// @param make      an exception of it is to end the job, since the others wait
  /// @throws Stopped
  std::string once(const Digest& key, bool may_make, const std::function<std::string()>& make);

  /// What ends the waiting for other ranks; lives as long as this object.
  void stop_by(const std::atomic<bool>* stop) { stop_ = stop; }

  /// The end of this rank's part. Rank 0 gets how the job ends once all ranks have come; another rank what rank 0 told
  /// it. Where some rank fails while others do not come to an end, the job is aborted: then it does not return.
  virtual RankEnd leave(const RankEnd& own) = 0;
  /// Tells the user, on rank 0, why a job is aborted; called at most once, by any thread.
  using OnAbort = std::function<void(const RankEnd& why)>;
  virtual void on_abort(OnAbort tell) = 0;

  /// Whether the others still take part: rank 0 writes the results alone.
  bool is_together() const { return is_together_; }
  void go_alone() { is_together_ = false; }

 protected:
  const std::atomic<bool>* stop() const { return stop_; }

  /// Of once(), see OnceBook.
  virtual Claim claim(const Digest& key, bool may_make, std::string& made) = 0;
  virtual void publish(const Digest& key, std::string_view made) = 0;

 private:
  const std::atomic<bool>* stop_ = nullptr;
  std::uint64_t counters_ = 0;
  bool is_together_ = true;
};

/// One value of each rank, by rank. All ranks call it.
template <typename Value>
std::vector<Value> gather_values(Ranks& ranks, const Value& own) {
  static_assert(std::is_trivially_copyable_v<Value>);
  std::vector<Value> values;
  for (const std::string& bytes : ranks.gather({reinterpret_cast<const char*>(&own), sizeof(own)})) {
    assert(bytes.size() == sizeof(own));  // ranks of one version, which give the same in the same order
    std::memcpy(&values.emplace_back(), bytes.data(), sizeof(own));
  }
  return values;
}

/// Throws SystemFailure where the ranks do not all give the same digest.
///
/// @param digests  by rank
/// @param what     "the samples of a batch"
void require_same_digests(const std::vector<Digest>& digests, const char* what);

/// Threads for each rank, where those of one node share its processors evenly. All ranks call it.
int threads_of_rank(Ranks& ranks);

/// The host that this process runs on; empty where that is not known.
std::string node_name();

/// Number of nodes that the ranks run on. All ranks call it.
int count_nodes(Ranks& ranks);

}  // namespace mottle
