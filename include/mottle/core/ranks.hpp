// The processes of one job, and what they tell each other. How they do that is a module's business (modules/mpi); the
// library knows this interface only.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/core/checksum.hpp"

namespace mottle {

/// How a rank ends: its exit code, and what it has to say to the user.
struct RankEnd {
  int code = 0;
  std::string message = {};
};

/// Processes that all run the same job on the same input: every decision is taken by each of them and is the same, only
/// the evaluation of batches is shared out.
class Ranks {
 public:
  virtual ~Ranks() = default;

  virtual int rank() const = 0;   ///< of this process, from 0 on; rank 0 alone writes files and speaks to the user
  virtual int count() const = 0;  ///< of all processes, >= 1
  bool is_first() const { return rank() == 0; }

  /// What each rank gives, by rank. All ranks call it, in the same order, from one thread.
  virtual std::vector<std::string> gather(std::string_view bytes) = 0;

  /// Adds to a counter that all ranks share and returns what it held before, 0 at first. Any thread, at any time.
  virtual std::int64_t add(std::uint64_t counter, std::int64_t amount) = 0;
  /// A counter that nobody has used. All ranks call it, in the same order, from one thread.
  std::uint64_t new_counter() { return ++counters_; }

  /// The end of this rank's part. Rank 0 gets how the job ends once all ranks have come; another rank what rank 0 told
  /// it. Where some rank fails while others do not come to an end, the job is aborted: then it does not return.
  virtual RankEnd leave(const RankEnd& own) = 0;
  /// Tells the user, on rank 0, why a job is aborted; called at most once, by any thread.
  using Speaker = std::function<void(const RankEnd& why)>;
  virtual void speak_by(Speaker speaker) = 0;

  /// Whether the others still take part: rank 0 writes the results alone.
  bool is_together() const { return is_together_; }
  void go_alone() { is_together_ = false; }

 private:
  std::uint64_t counters_ = 0;
  bool is_together_ = true;
};

/// Throws SystemFailure where the ranks do not all give the same digest.
///
/// @param digests  by rank
/// @param what     "the samples of a batch"
void require_same_digests(const std::vector<Digest>& digests, const char* what);

/// Threads for each rank, where those of one node share its processors evenly. All ranks call it.
int threads_of_rank(Ranks& ranks);

/// Number of nodes that the ranks run on. All ranks call it.
int count_nodes(Ranks& ranks);

}  // namespace mottle
