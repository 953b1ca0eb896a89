#include "message_calls.hpp"

#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <thread>

namespace mottle::mpi {
namespace {

/// Gives way at first, then sleeps longer and longer.
class Patience {
 public:
  void wait() {
    constexpr int k_yields = 200;
    constexpr std::chrono::microseconds k_longest{500};
    if (++rounds_ < k_yields) {
      ::sched_yield();
      return;
    }
    std::this_thread::sleep_for(pause_);
    pause_ = std::min(k_longest, pause_ + pause_ / 8 + std::chrono::microseconds(1));
  }

 private:
  int rounds_ = 0;
  std::chrono::microseconds pause_{20};
};

}  // namespace

MessageCalls::MessageCalls() {
  int provided = MPI_THREAD_SINGLE;
  PMPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided);
  PMPI_Comm_dup(MPI_COMM_WORLD, &world_);
  PMPI_Comm_rank(world_, &rank_);
  PMPI_Comm_size(world_, &count_);
}

void MessageCalls::wait(MPI_Request& request) {
  Patience patience;
  for (;;) {
    int is_done = 0;
    {
      const std::lock_guard lock(mutex_);
      PMPI_Test(&request, &is_done, MPI_STATUS_IGNORE);
    }
    if (is_done != 0) return;
    patience.wait();
  }
}

void MessageCalls::gather_piece(std::string_view piece, const std::vector<int>& sizes, std::vector<std::string>& all) {
  std::vector<int> begins(sizes.size());
  std::exclusive_scan(sizes.begin(), sizes.end(), begins.begin(), 0);
  std::string together(static_cast<std::size_t>(begins.back() + sizes.back()), '\0');
  MPI_Request request = MPI_REQUEST_NULL;
  {
    const std::lock_guard lock(mutex_);
    PMPI_Iallgatherv(piece.data(), static_cast<int>(piece.size()), MPI_BYTE, together.data(), sizes.data(),
                     begins.data(), MPI_BYTE, world_, &request);
  }
  wait(request);
  for (std::size_t rank = 0; rank < sizes.size(); ++rank) {
    all[rank].append(together, static_cast<std::size_t>(begins[rank]), static_cast<std::size_t>(sizes[rank]));
  }
}

std::vector<std::string> MessageCalls::gather(std::string_view bytes) {
  const auto ranks = static_cast<std::size_t>(count_);
  const auto own = static_cast<std::int64_t>(bytes.size());
  std::vector<std::int64_t> sizes(ranks);
  MPI_Request request = MPI_REQUEST_NULL;
  {
    const std::lock_guard lock(mutex_);
    PMPI_Iallgather(&own, 1, MPI_INT64_T, sizes.data(), 1, MPI_INT64_T, world_, &request);
  }
  wait(request);
  // MPI counts bytes in int: what is longer goes in pieces.
  const std::int64_t longest = std::numeric_limits<int>::max() / 2 / count_;
  std::vector<std::string> all(ranks);
  for (std::int64_t begin = 0; begin < *std::max_element(sizes.begin(), sizes.end()); begin += longest) {
    std::vector<int> here;
    for (const std::int64_t size : sizes) {
      here.push_back(static_cast<int>(std::clamp(size - begin, std::int64_t{0}, longest)));
    }
    const auto first = static_cast<std::size_t>(std::min(begin, own));
    gather_piece(bytes.substr(first, static_cast<std::size_t>(here[static_cast<std::size_t>(rank_)])), here, all);
  }
  return all;
}

void MessageCalls::send(int rank, int tag, std::string_view bytes) {
  MPI_Request request = MPI_REQUEST_NULL;
  {
    const std::lock_guard lock(mutex_);
    PMPI_Isend(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, rank, tag, world_, &request);
  }
  wait(request);
}

std::string MessageCalls::receive(int rank, int tag) {
  Patience patience;
  for (;;) {
    {
      const std::lock_guard lock(mutex_);
      int is_there = 0;
      MPI_Status status;
      PMPI_Iprobe(rank, tag, world_, &is_there, &status);
      if (is_there != 0) {
        int size = 0;
        PMPI_Get_count(&status, MPI_BYTE, &size);
        std::string bytes(static_cast<std::size_t>(size), '\0');
        PMPI_Recv(bytes.data(), size, MPI_BYTE, rank, tag, world_, MPI_STATUS_IGNORE);
        return bytes;
      }
    }
    patience.wait();
  }
}

bool MessageCalls::poll(int tag, Message& message) {
  const std::lock_guard lock(mutex_);
  int is_there = 0;
  MPI_Status status;
  PMPI_Iprobe(MPI_ANY_SOURCE, tag, world_, &is_there, &status);
  if (is_there == 0) return false;
  int size = 0;
  PMPI_Get_count(&status, MPI_BYTE, &size);
  message.source = status.MPI_SOURCE;
  message.bytes.assign(static_cast<std::size_t>(size), '\0');
  PMPI_Recv(message.bytes.data(), size, MPI_BYTE, message.source, tag, world_, MPI_STATUS_IGNORE);
  return true;
}

void MessageCalls::abort(int code) {
  const std::lock_guard lock(mutex_);
  PMPI_Abort(MPI_COMM_WORLD, code);
  std::_Exit(code);
}

void MessageCalls::finalize() {
  const std::lock_guard lock(mutex_);
  PMPI_Comm_free(&world_);
  PMPI_Finalize();
}

}  // namespace mottle::mpi
