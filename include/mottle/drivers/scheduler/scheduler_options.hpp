// What a study says of the scheduler of a cluster that does a solver's runs, as plain data.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::drivers {

enum class SchedulerKind { slurm, pbs, lsf };

struct SchedulerOptions {
  SchedulerKind kind = SchedulerKind::slurm;
  std::string partition = {};           ///< or queue; empty: the cluster's default
  std::chrono::milliseconds time = {};  ///< a task may take; 0: the cluster's default
  std::string account = {};             ///< or project
  int cores = 1;                        ///< of a task, on one node
  int runs_at_once = 0;                 ///< most tasks at work at the same time; 0: as many as the cluster lets
  std::string licences = {};            ///< of a task: "ansys" or "ansys:1"
  int runs_per_task = 0;                ///< 0: chosen from the time of a run
  int tries = 3;                        ///< of a run whose task has died
  std::vector<std::string> extra = {};  ///< arguments handed on to the scheduler's command as they are
};

/// "Slurm", "PBS", "LSF".
std::string scheduler_name(SchedulerKind kind);

}  // namespace mottle::drivers
