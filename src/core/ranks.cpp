#include "mottle/core/ranks.hpp"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <set>
#include <thread>

#include "mottle/core/bytes.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/gather_alike.hpp"
#include "mottle/core/parallel.hpp"

namespace mottle {
namespace {

/// The processors that this process may run on, as bytes.
std::string processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (::sched_getaffinity(0, sizeof(set), &set) != 0) return {};
  return {reinterpret_cast<const char*>(&set), sizeof(set)};
}

}  // namespace

std::string node_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

std::string Ranks::once(const Digest& key, bool may_make, const std::function<std::string()>& make) {
  constexpr std::chrono::milliseconds k_longest_pause{20};
  std::chrono::milliseconds pause{1};
  std::string made;
  for (;;) {
    const Claim claimed = claim(key, may_make, made);
    if (claimed == Claim::made) return made;
    if (claimed == Claim::own) {
      made = make();
      publish(key, made);
      return made;
    }
    if (stop_ != nullptr && stop_->load(std::memory_order_relaxed)) throw Stopped("stopped on request");
    std::this_thread::sleep_for(pause);
    pause = std::min(k_longest_pause, 2 * pause);
  }
}

void require_same_digests(const std::vector<Digest>& digests, const char* what) {
  for (std::size_t rank = 1; rank < digests.size(); ++rank) {
    if (digests[rank] == digests[0]) continue;
    throw SystemFailure(
        fmt::format("rank {} computes with other numbers than rank 0: {} differ; all ranks need the same version of "
                    "Mottle, the same libraries, the same files and processors of one kind",
                    rank, what));
  }
}

std::vector<std::string> gather_alike(Ranks& ranks, const std::vector<AlikeDigest>& digests, std::string_view bytes) {
  std::string own;
  for (const AlikeDigest& each : digests) append_value(own, each.digest);
  const std::size_t head = own.size();
  own += bytes;
  std::vector<std::string> all = ranks.gather(own);
  for (std::size_t i = 0; i < digests.size(); ++i) {
    std::vector<Digest> theirs(all.size());
    for (std::size_t rank = 0; rank < all.size(); ++rank) {
      assert(all[rank].size() >= head);
      std::memcpy(&theirs[rank], all[rank].data() + i * sizeof(Digest), sizeof(Digest));
    }
    require_same_digests(theirs, digests[i].what);
  }
  for (std::string& theirs : all) theirs.erase(0, head);
  return all;
}

int threads_of_rank(Ranks& ranks) {
  const std::string own = node_name() + '\n' + processors();
  const std::vector<std::string> places = ranks.gather(own);
  const auto sharing = static_cast<int>(std::count(places.begin(), places.end(), own));
  return std::max(1, available_threads() / std::max(1, sharing));
}

int count_nodes(Ranks& ranks) {
  const std::vector<std::string> names = ranks.gather(node_name());
  return static_cast<int>(std::set<std::string>(names.begin(), names.end()).size());
}

}  // namespace mottle
