// How this process was started: alone, or as one of many by mpirun, srun and their like; and the module that lets those
// talk to each other.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/core/ranks.hpp"

namespace mottle {

/// What the launcher's environment variables say.
struct Launch {
  std::string variable = {};  ///< that gives the number: "OMPI_COMM_WORLD_SIZE"; empty: started by itself
  int count = 1;              ///< of processes that were started
  int rank = 0;

  bool is_shared() const { return count > 1; }
};

/// MOTTLE_RANKS=off: none, whatever the launcher says; for a command that each rank of another program runs by itself.
Launch find_launch();

/// Whether a variable tells a process that it is a rank of this job: a solver that is itself an MPI program is not.
bool is_launch_variable(std::string_view name);

/// A module's function that joins the job; it is `mottle_join_ranks` there, with C linkage.
using JoinRanks = Ranks*();
/// Version of the interface of Ranks; a module says the one that it was built with as `mottle_ranks_version`.
inline constexpr int k_ranks_version = 2;

/// The ranks of the job that a launcher started.
///
/// @param modules  files that may be the module, in order
/// @throws SystemFailure  there is no module; it cannot be loaded; it knows other ranks than the launcher started
std::unique_ptr<Ranks> join_ranks(const Launch& launch, const std::vector<std::filesystem::path>& modules);

}  // namespace mottle
