#include "mottle/core/launcher.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>

#include "mottle/core/error.hpp"

namespace mottle {
namespace {

struct Variables {
  const char* count;
  const char* rank;
};

constexpr std::array k_launchers{
    Variables{"OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"},  // Open MPI's mpirun
    Variables{"PMI_SIZE", "PMI_RANK"},                          // MPICH's and Intel's mpirun, srun --mpi=pmi2
    Variables{"MV2_COMM_WORLD_SIZE", "MV2_COMM_WORLD_RANK"},    // MVAPICH
    Variables{"JSM_NAMESPACE_SIZE", "JSM_NAMESPACE_RANK"},      // jsrun
    Variables{"SLURM_STEP_NUM_TASKS", "SLURM_PROCID"},          // srun; a batch script has no step
};

/// -1 where it is none.
int number_in(const char* variable) {
  const char* text = std::getenv(variable);
  if (text == nullptr || *text == '\0') return -1;
  char* end = nullptr;
  const long value = std::strtol(text, &end, 10);
  constexpr long k_most = 1'000'000;
  return *end == '\0' && 0 <= value && value <= k_most ? static_cast<int>(value) : -1;
}

/// Null where no file is there; throws where one is and cannot be used.
void* load_first(const std::vector<std::filesystem::path>& modules) {
  for (const std::filesystem::path& file : modules) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) continue;
    // Global: parts of the MPI library are loaded later and look for it there. The module itself calls it by names that
    // no other library has (MUMPS's sequential build brings some functions of MPI that do nothing).
    void* module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_GLOBAL);
    if (module == nullptr) throw SystemFailure(fmt::format("the module for MPI cannot be loaded: {}", ::dlerror()));
    const auto* version = static_cast<const int*>(::dlsym(module, "mottle_ranks_version"));
    if (version == nullptr || *version != k_ranks_version) {
      throw SystemFailure(
          fmt::format("{}: belongs to another version of Mottle; install both from one build", file.string()));
    }
    return module;
  }
  return nullptr;
}

}  // namespace

Launch find_launch() {
  const char* wish = std::getenv("MOTTLE_RANKS");
  if (wish != nullptr && std::strcmp(wish, "off") == 0) return {};
  for (const Variables& variables : k_launchers) {
    const int count = number_in(variables.count);
    const int rank = number_in(variables.rank);
    if (count < 1 || rank < 0) continue;
    // The first is the innermost: mpirun -n 1 in a step of srun starts a process that is alone.
    return count > 1 ? Launch{.variable = variables.count, .count = count, .rank = rank} : Launch{};
  }
  return {};
}

bool is_launch_variable(std::string_view name) {
  constexpr std::array<std::string_view, 6> k_prefixes{"OMPI_", "PMIX_", "PMI_", "PRTE_", "MV2_COMM_WORLD_", "JSM_"};
  constexpr std::string_view k_permission = "OMPI_ALLOW_";  // the user's word, not the launcher's
  if (name.starts_with(k_permission)) return false;
  const auto is_it = [&](const Variables& variables) { return name == variables.count || name == variables.rank; };
  if (std::ranges::any_of(k_launchers, is_it)) return true;
  return std::ranges::any_of(k_prefixes, [&](std::string_view prefix) { return name.starts_with(prefix); });
}

std::unique_ptr<Ranks> join_ranks(const Launch& launch, const std::vector<std::filesystem::path>& modules) {
  void* module = load_first(modules);
  if (module == nullptr) {
    throw SystemFailure(fmt::format(
        "started {} times at once ({}={}), but the module for MPI is not installed; install the package mottle-mpi, or "
        "start Mottle once; MOTTLE_RANKS=off in the environment makes it work alone",
        launch.count, launch.variable, launch.count));
  }
  auto* const join = reinterpret_cast<JoinRanks*>(::dlsym(module, "mottle_join_ranks"));
  if (join == nullptr) throw SystemFailure(fmt::format("the module for MPI cannot be used: {}", ::dlerror()));
  std::unique_ptr<Ranks> ranks(join());
  if (ranks->count() != launch.count) {
    throw SystemFailure(fmt::format(
        "started {} times at once ({}={}), but MPI connects {} of these processes; start Mottle by the mpirun of the "
        "MPI library that it uses (Debian: Open MPI), or by srun with --mpi=pmix or --mpi=pmi2; MOTTLE_RANKS=off "
        "in the environment makes each work alone",
        launch.count, launch.variable, launch.count, ranks->count()));
  }
  return ranks;
}

}  // namespace mottle
