// The calls to MPI that the module needs, each under one lock and none of them blocking: threads that wait sleep, so
// that ranks that share processors do not take them from those that compute, and MPI_THREAD_SERIALIZED serves.
#pragma once

#include <mpi.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace mottle::mpi {

// PMPI_ names throughout: a sequential MUMPS brings an MPI_Init, MPI_Comm_rank and MPI_Finalize that do nothing, and
// the program that it is linked to comes first where names are looked up.

/// A message that has come.
struct Message {
  int source = 0;
  std::string bytes = {};
};

class MessageCalls {
 public:
  /// Throws SystemFailure where the MPI library bears no calls by several threads, one at a time.
  MessageCalls();

  int rank() const { return rank_; }
  int count() const { return count_; }

  /// @param stop  ends the waiting for others; nullptr: nothing does
  /// @throws Stopped  then the library still holds buffers of this call: MPI can be aborted and not finalized
  std::vector<std::string> gather(std::string_view bytes, const std::atomic<bool>* stop);
  /// Whether a gather was stopped.
  bool is_torn() const { return !held_.empty(); }
  void send(int rank, int tag, std::string_view bytes);
  /// Waits for it.
  std::string receive(int rank, int tag);
  /// The next message with this tag from anyone; false: there is none now.
  bool poll(int tag, Message& message);
  [[noreturn]] void abort(int code);
  void finalize();

 private:
  /// What a collective call reads and writes until it is done.
  struct Gathering {
    std::string given = {};
    std::vector<int> sizes = {};  ///< by rank
    std::vector<int> begins = {};
    std::string taken = {};
  };
  /// False: it was stopped.
  bool wait(MPI_Request& request, const std::atomic<bool>* stop);
  /// What each rank gives, by rank, of sizes that all know.
  std::vector<std::string> gather_piece(std::string_view piece, const std::vector<int>& sizes,
                                        const std::atomic<bool>* stop);

  MPI_Comm world_ = MPI_COMM_NULL;
  std::mutex mutex_;  // of all calls
  int rank_ = 0;
  int count_ = 1;
  std::vector<std::unique_ptr<Gathering>> held_;  // of stopped calls
};

}  // namespace mottle::mpi
