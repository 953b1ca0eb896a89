#include "mottle/core/ranks.hpp"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <set>

#include "mottle/core/error.hpp"
#include "mottle/core/parallel.hpp"

namespace mottle {
namespace {

std::string node_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

/// The processors that this process may run on, as bytes.
std::string processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (::sched_getaffinity(0, sizeof(set), &set) != 0) return {};
  return {reinterpret_cast<const char*>(&set), sizeof(set)};
}

}  // namespace

void require_same_digests(const std::vector<Digest>& digests, const char* what) {
  for (std::size_t rank = 1; rank < digests.size(); ++rank) {
    if (digests[rank] == digests[0]) continue;
    throw SystemFailure(
        fmt::format("rank {} computes with other numbers than rank 0: {} differ; all ranks need the same version of "
                    "Mottle, the same libraries, the same files and processors of one kind",
                    rank, what));
  }
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
