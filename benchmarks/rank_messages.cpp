// What messages between ranks cost: numbers of a shared counter, and the gathering of rows.
//
//   mpirun -n 2 PROGRAM libmottle_mpi.so
//
// Rank 0 writes one line of JSON, times in s. Ranks wait with short sleeps, which are part of what is measured.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <vector>

#include "mottle/core/launcher.hpp"

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// Time from a rank's question for a number to the answer; by rank 1, while the others wait for it.
double counter_latency(mottle::Ranks& ranks) {
  constexpr int k_questions = 2000;
  const std::uint64_t counter = ranks.new_counter();
  std::vector<double> times{0.0};
  for (int i = 0; i < k_questions && ranks.rank() == 1; ++i) {
    const Clock::time_point begin = Clock::now();
    ranks.add(counter, 1);
    times.push_back(seconds_since(begin));
  }
  ranks.gather("");
  return median(times);
}

/// Time of one number where many threads of rank 1 ask without a pause: what rank 0 needs to serve it.
double counter_service(mottle::Ranks& ranks) {
  constexpr int k_threads = 16;
  constexpr int k_questions = 500;  // of each thread
  const std::uint64_t counter = ranks.new_counter();
  const Clock::time_point begin = Clock::now();
  if (ranks.rank() == 1) {
    std::vector<std::jthread> threads;
    for (int thread = 0; thread < k_threads; ++thread) {
      threads.emplace_back([&] {
        for (int i = 0; i < k_questions; ++i) ranks.add(counter, 1);
      });
    }
  }
  const double time = seconds_since(begin);  // the threads have been joined
  ranks.gather("");
  return time / (k_threads * k_questions);
}

/// Time in which every rank has the bytes of all; `bytes` of each.
double gather_time(mottle::Ranks& ranks, std::size_t bytes) {
  constexpr int k_repeats = 15;
  const std::string own(bytes, 'x');
  std::vector<double> times;
  for (int i = 0; i < k_repeats; ++i) {
    const Clock::time_point begin = Clock::now();
    ranks.gather(own);
    times.push_back(seconds_since(begin));
  }
  return median(times);
}

/// Value of a rank as every rank gets to know it.
double of_rank(mottle::Ranks& ranks, int rank, double value) {
  return std::stod(ranks.gather(fmt::format("{}", value)).at(static_cast<std::size_t>(rank)));
}

int measure(mottle::Ranks& ranks) {
  const double latency = of_rank(ranks, 1, counter_latency(ranks));
  const double service = of_rank(ranks, 1, counter_service(ranks));
  constexpr std::size_t k_much = 8'000'000;
  const double little = gather_time(ranks, 8);
  const double much = gather_time(ranks, k_much);
  if (ranks.is_first()) {
    fmt::print(
        "{{\"ranks\": {}, \"counter_latency\": {:.3g}, \"counter_service\": {:.3g}, \"gather\": {:.3g}, "
        "\"gather_byte\": {:.3g}}}\n",
        ranks.count(), latency, service, little,
        (much - little) / static_cast<double>(k_much * static_cast<std::size_t>(ranks.count())));
  }
  return ranks.leave({}).code;
}

}  // namespace

int main(int count, char** arguments) {
  const mottle::Launch launch = mottle::find_launch();
  if (count != 2 || !launch.is_shared()) {
    fmt::print("usage: mpirun -n 2 {} libmottle_mpi.so\n", arguments[0]);
    return count == 1 ? 0 : 2;  // `make bench` calls every program without arguments
  }
  return measure(*mottle::join_ranks(launch, {arguments[1]}));
}
