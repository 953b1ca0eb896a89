// Where and how a job runs.
#pragma once

#include <atomic>
#include <filesystem>

#include "mottle/core/run_context.hpp"
#include "mottle/layers.hpp"

namespace mottle::study {

struct RunSettings {
  std::filesystem::path folder{};  ///< empty: no log, no journal to resume from
  std::filesystem::path cache{};   ///< folder of what later runs may use again; empty: none. Changes no number
  int threads = 1;
  bool resume = false;
  bool may_run_programs = true;  ///< else a study whose model is run by a program is refused
  bool ends_by_failures = true;  ///< too many failed runs of a program end the job; else each costs its sample alone
  ProgressObserver* observer = nullptr;
  const std::atomic<bool>* stop = nullptr;  ///< a model made for the job may ask it for as long as it lives
  Ranks* ranks = nullptr;  ///< that do the same job and share the model's evaluations; null: this process is alone
  /// Where runs of a solver by command are kept; empty: in `folder`. Other ranks than the first have no folder of their
  /// own and keep their runs beside the first one's.
  std::filesystem::path run_folder{};
};

}  // namespace mottle::study
