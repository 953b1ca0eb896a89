#include "job_ranks.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "console.hpp"
#include "mottle/core/bytes.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/launcher.hpp"
#include "mottle/core/text.hpp"
#include "mottle/linalg/batched/batch_eigen.hpp"
#include "mottle/linalg/blas_kernels.hpp"

namespace mottle::app {
namespace {

const Launch& own_launch() {
  static const Launch launch = find_launch();
  return launch;
}

std::unique_ptr<Ranks>& joined() {
  static std::unique_ptr<Ranks> ranks;
  return ranks;
}

/// Beside the command where it was built; where it is installed, in the libraries' folder of the same tree.
std::vector<std::filesystem::path> module_places() {
  constexpr const char* k_module = "libmottle_mpi.so";
  std::error_code ignored;
  const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
  return {folder / k_module, folder.parent_path() / MOTTLE_MODULE_FOLDER / k_module};
}

/// Ends a rank that waits for others to join, which MPI does for ever: one that has ended before, with exit code 0 so
/// that its launcher ends nobody, or that does something else, never comes.
class JoinLimit {
  static constexpr int k_failed = 3;

 public:
  JoinLimit() {
    constexpr int k_usual_s = 300;
    const char* wish = std::getenv("MOTTLE_RANKS_TIMEOUT");
    double seconds = k_usual_s;
    require(wish == nullptr || (parse_number(wish, seconds) && seconds >= 1.0 && seconds <= 1e6),
            "MOTTLE_RANKS_TIMEOUT: found '{}', a number of seconds from 1 to 1000000 is needed", wish ? wish : "");
    // The first rank speaks; where it is the missing one, another does.
    const auto patience = std::chrono::duration<double>(seconds + (is_silent_rank() ? 1.5 : 0.0));
    std::string text = fmt::format(
        "mottle: rank {} on {} has waited {} s for the other ranks to join; one of them has ended before, or was "
        "started with another command: all ranks need the same verb, study and options (MOTTLE_RANKS_TIMEOUT=600 "
        "waits longer)\n",
        own_launch().rank, node_name(), seconds);
    // MPI_Init changes the environment meanwhile: the thread reads nothing of it.
    thread_ = std::jthread([patience, text = std::move(text)](const std::stop_token& stop) {
      std::mutex mutex;
      std::condition_variable_any bell;
      std::unique_lock<std::mutex> lock(mutex);
      if (bell.wait_for(lock, stop, patience, [&] { return stop.stop_requested(); }) || stop.stop_requested()) return;
      (void)!::write(STDERR_FILENO, text.data(), text.size());
      ::_exit(k_failed);
    });
  }

 private:
  std::jthread thread_;  // asked to stop, and awaited, at the end
};

void require_one_verb(Ranks& ranks, const std::string& verb) {
  const std::vector<std::string> verbs = ranks.gather(verb);
  for (std::size_t rank = 1; rank < verbs.size(); ++rank) {
    require(verbs[rank] == verbs.front(),
            "rank {} was started with 'mottle {}' and rank 0 with 'mottle {}'; all ranks need the same verb, study and "
            "options",
            rank, verbs[rank], verbs.front());
  }
}

/// A launcher ends the others where one fails: the first rank, which meets the same error, is to say it before. It may
/// come to that late on a busy machine; the launcher ends this process once it has.
void let_first_rank_speak() {
  constexpr std::chrono::seconds k_patience{10};
  constexpr std::chrono::milliseconds k_pause{50};
  const auto end = std::chrono::steady_clock::now() + k_patience;
  while (std::chrono::steady_clock::now() < end && !stop_flag()) std::this_thread::sleep_for(k_pause);
}

/// All ranks use the instructions that each of them has, and need the same kernels of BLAS.
void use_common_instructions(Ranks& ranks) {
  const SimdLevel own = is_simd_level_available(SimdLevel::avx512) ? SimdLevel::avx512
                        : is_simd_level_available(SimdLevel::avx2) ? SimdLevel::avx2
                                                                   : SimdLevel::plain;
  std::string bytes;
  append_value(bytes, own);
  append_text(bytes, blas_kernels().empty() ? "of the reference" : blas_kernels());
  SimdLevel common = own;
  std::string first;
  int rank = 0;
  for (const std::string& other : ranks.gather(bytes)) {
    ByteReader reader(other);
    SimdLevel level = own;
    std::string kernels;
    if (!reader.read(level) || !reader.read_text(kernels)) throw SystemFailure("a rank's message is torn");
    common = std::min(common, level);
    if (rank == 0) first = kernels;
    if (kernels != first) {
      throw SystemFailure(fmt::format(
          "rank {} runs on another kind of processor than rank 0: its BLAS uses the kernels '{}', there it "
          "uses '{}', and the numbers would differ; name one that all have, as in OPENBLAS_CORETYPE=HASWELL "
          "(mpirun -x OPENBLAS_CORETYPE=HASWELL), or ask for nodes of one kind",
          rank, kernels, first));
    }
    ++rank;
  }
  limit_simd_level(common);
}

}  // namespace

bool is_silent_rank() {
  return own_launch().is_shared() && own_launch().rank > 0;
}

Ranks* join_job(const std::string& verb) {
  if (!own_launch().is_shared()) return nullptr;
  {
    const JoinLimit limit;
    joined() = join_ranks(own_launch(), module_places());
  }
  Ranks& ranks = *joined();
  ranks.on_abort([](const RankEnd& why) { tell(fmt::format("mottle: {}\n", why.message)); });
  ranks.stop_by(&stop_flag());
  require_one_verb(ranks, verb);
  use_common_instructions(ranks);
  return &ranks;
}

RankEnd end_job(const RankEnd& own) {
  if (joined() == nullptr) {
    if (is_silent_rank() && own.code != 0) let_first_rank_speak();
    return own;
  }
  no_longer_stop();
  RankEnd end = own;
  if (!joined()->is_first() && own.code != 0 && own.code != k_stopped) {
    end.message = fmt::format("rank {} on {}: {}", joined()->rank(), node_name(), own.message);
  }
  return joined()->leave(end);
}

}  // namespace mottle::app
