// What the jobs of studies and of functions have in common: arguments, and what is done with a folder.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "calling_thread.hpp"
#include "mottle/mottle.hpp"
#include "mottle/study/results/folder_lock.hpp"
#include "mottle/study/results/run_folder.hpp"

namespace mottle::python {

/// What every job is given.
struct JobArguments {
  std::optional<std::filesystem::path> folder = std::nullopt;
  int threads = 0;
  bool resume = false;
  bool may_run_programs = true;
  std::filesystem::path cache = {};
  pybind11::object progress = pybind11::none();
};

inline RunSettings settings_of(const JobArguments& arguments, CallingThread& caller) {
  return {.folder = arguments.folder.value_or(std::filesystem::path()),
          .cache = arguments.cache,
          .threads = arguments.threads > 0 ? arguments.threads : available_threads(),
          .resume = arguments.resume,
          .may_run_programs = arguments.may_run_programs,
          .observer = &caller,
          .stop = caller.stop()};
}

/// Does the job and, where there is a folder, what the command of its name does with it.
template <typename Outcome, typename Job, typename Finish>
std::shared_ptr<Outcome> run_job(CallingThread& caller, const JobArguments& arguments, const Job& job,
                                 const Finish& finish) {
  const RunSettings settings = settings_of(arguments, caller);
  return caller.run([&] {
    std::optional<FolderLock> lock;
    if (arguments.folder) lock.emplace(*arguments.folder);
    auto outcome = std::make_shared<Outcome>(job(settings));
    if (arguments.folder) {
      write_results(*outcome, *arguments.folder);
      finish(*arguments.folder);
    }
    return outcome;
  });
}

inline void finish_with_report(const std::filesystem::path& folder) {
  write_report(folder);
  RunFolder(folder).finish();
}

}  // namespace mottle::python
