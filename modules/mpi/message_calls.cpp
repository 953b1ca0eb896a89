#include "message_calls.hpp"

#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <numeric>
#include <thread>

#include "mottle/core/error.hpp"

namespace mottle::mpi {
namespace {

/// Gives way at first, then sleeps longer and longer.
class Backoff {
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
  if (provided < MPI_THREAD_SERIALIZED) {
    throw SystemFailure(
        "this MPI library bears no calls by several threads (it gives less than MPI_THREAD_SERIALIZED); use one that "
        "does, or start Mottle once, or with MOTTLE_RANKS=off");
  }
  PMPI_Comm_dup(MPI_COMM_WORLD, &world_);
  PMPI_Comm_rank(world_, &rank_);
  PMPI_Comm_size(world_, &count_);
}

bool MessageCalls::wait(MPI_Request& request, const std::atomic<bool>* stop) {
  Backoff backoff;
  for (;;) {
    int is_done = 0;
    {
      const std::lock_guard lock(mutex_);
      PMPI_Test(&request, &is_done, MPI_STATUS_IGNORE);
    }
    if (is_done != 0) return true;
    if (stop != nullptr && stop->load(std::memory_order_relaxed)) return false;
    backoff.wait();
  }
}

std::vector<std::string> MessageCalls::gather_piece(std::string_view piece, const std::vector<int>& sizes,
                                                    const std::atomic<bool>* stop) {
  auto call = std::make_unique<Gathering>();
  call->given = piece;
  call->sizes = sizes;
  call->begins.resize(sizes.size());
  std::exclusive_scan(sizes.begin(), sizes.end(), call->begins.begin(), 0);
  call->taken.resize(static_cast<std::size_t>(call->begins.back() + sizes.back()));
  MPI_Request request = MPI_REQUEST_NULL;
  {
    const std::lock_guard lock(mutex_);
    PMPI_Iallgatherv(call->given.data(), static_cast<int>(piece.size()), MPI_BYTE, call->taken.data(),
                     call->sizes.data(), call->begins.data(), MPI_BYTE, world_, &request);
  }
  if (!wait(request, stop)) {
    held_.push_back(std::move(call));  // what other ranks still send is written there
    throw Stopped("stopped on request");
  }
  std::vector<std::string> all;
  for (std::size_t rank = 0; rank < sizes.size(); ++rank) {
    all.push_back(
        call->taken.substr(static_cast<std::size_t>(call->begins[rank]), static_cast<std::size_t>(sizes[rank])));
  }
  return all;
}

std::vector<std::string> MessageCalls::gather(std::string_view bytes, const std::atomic<bool>* stop) {
  const auto ranks = static_cast<std::size_t>(count_);
  const auto own = static_cast<std::int64_t>(bytes.size());
  std::vector<std::int64_t> sizes;
  const std::string_view own_size(reinterpret_cast<const char*>(&own), sizeof(own));
  for (const std::string& size : gather_piece(own_size, std::vector<int>(ranks, sizeof(own)), stop)) {
    std::memcpy(&sizes.emplace_back(), size.data(), sizeof(own));
  }
  // MPI counts bytes in int: what is longer goes in pieces.
  const std::int64_t longest = std::numeric_limits<int>::max() / 2 / count_;
  std::vector<std::string> all(ranks);
  for (std::int64_t begin = 0; begin < *std::max_element(sizes.begin(), sizes.end()); begin += longest) {
    std::vector<int> here;
    for (const std::int64_t size : sizes) {
      here.push_back(static_cast<int>(std::clamp(size - begin, std::int64_t{0}, longest)));
    }
    const auto first = static_cast<std::size_t>(std::min(begin, own));
    const std::string_view piece = bytes.substr(first, static_cast<std::size_t>(here[static_cast<std::size_t>(rank_)]));
    const std::vector<std::string> pieces = gather_piece(piece, here, stop);
    for (std::size_t rank = 0; rank < ranks; ++rank) all[rank] += pieces[rank];
  }
  return all;
}

void MessageCalls::send(int rank, int tag, std::string_view bytes) {
  MPI_Request request = MPI_REQUEST_NULL;
  {
    const std::lock_guard lock(mutex_);
    PMPI_Isend(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, rank, tag, world_, &request);
  }
  wait(request, nullptr);
}

std::string MessageCalls::receive(int rank, int tag) {
  Backoff backoff;
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
    backoff.wait();
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
