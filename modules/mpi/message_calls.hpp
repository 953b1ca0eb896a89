// The calls to MPI that the module needs, each under one lock and none of them blocking: threads that wait sleep, so
// that ranks that share processors do not take them from those that compute, and any level of thread support serves.
#pragma once

#include <mpi.h>

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
  MessageCalls();

  int rank() const { return rank_; }
  int count() const { return count_; }

  std::vector<std::string> gather(std::string_view bytes);
  void send(int rank, int tag, std::string_view bytes);
  /// Waits for it.
  std::string receive(int rank, int tag);
  /// The next message with this tag from anyone; false: there is none now.
  bool poll(int tag, Message& message);
  [[noreturn]] void abort(int code);
  void finalize();

 private:
  void wait(MPI_Request& request);
  void gather_piece(std::string_view piece, const std::vector<int>& sizes, std::vector<std::string>& all);

  MPI_Comm world_ = MPI_COMM_NULL;
  std::mutex mutex_;  // of all calls
  int rank_ = 0;
  int count_ = 1;
};

}  // namespace mottle::mpi
