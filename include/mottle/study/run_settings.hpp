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
  ProgressObserver* observer = nullptr;
  const std::atomic<bool>* stop = nullptr;  ///< a model made for the job may ask it for as long as it lives
};

}  // namespace mottle::study
