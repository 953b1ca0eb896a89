// The folder of an array of tasks within a folder of results: which runs its tasks do and how, and what they leave.
//
//   RESULTS/tasks/NAME/array     what follows here as an ArrayPlan; written whole before the array is submitted
//                     /job       the scheduler's number of it
//                     /job.sh    what the scheduler starts
//                     /task-N/   a task's own folder: its runs.store, its output, folders of its runs
//                     /task-N.done
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mottle/core/checksum.hpp"
#include "mottle/drivers/command/solver_command.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

inline constexpr const char* k_task_folder = "tasks";  ///< within the folder of results

/// An array's runs, and all that another process needs to do them.
struct ArrayPlan {
  std::string name = {};    ///< under which the scheduler knows it
  std::uint64_t inode = 0;  ///< of its folder: that of a copy is another
  SolverCommand command = {};
  std::vector<std::string> parameters = {};
  int min_modes = 1;                   ///< that a run must give
  Digest constants = {};               ///< of everything that all runs have in common
  std::vector<Digest> keys = {};       ///< [run]
  Eigen::MatrixXd values = {};         ///< [run x parameter]
  std::vector<std::size_t> ends = {};  ///< [task]: number of the first run that is the next task's

  int tasks() const { return static_cast<int>(ends.size()); }
  /// Numbers of the first run of task 1, 2, ... and of the first that is not its own.
  std::size_t begin_of(int task) const { return task == 1 ? 0 : ends[static_cast<std::size_t>(task) - 2]; }
  std::size_t end_of(int task) const { return ends[static_cast<std::size_t>(task) - 1]; }
};

/// What a task says at its end.
struct TaskEnd {
  std::size_t runs = 0;     ///< that it did, or had done before
  std::uint64_t bytes = 0;  ///< of its store
  double seconds = 0.0;     ///< that the runs of this start took
};

/// A name that no other array has: "mottle-1a2b3c4d".
std::string new_array_name();

/// Makes the folder with all that tasks need, and notes its inode there. Throws SystemFailure, InvalidInput: it cannot
/// be written.
///
/// @param number_variable  that tells a task its number
void write_array(const std::filesystem::path& folder, const ArrayPlan& plan, const std::string& number_variable);
/// Throws SystemFailure where the file is damaged or cannot be reached; nothing where there is none.
std::optional<ArrayPlan> read_array(const std::filesystem::path& folder);
/// Whether the folder is a copy of the one that was submitted, whose tasks are not this one's to end.
bool is_copied_array(const std::filesystem::path& folder, const ArrayPlan& plan);
/// Folders with arrays in a folder of results, by name.
std::vector<std::filesystem::path> array_folders(const std::filesystem::path& results);

void write_array_job(const std::filesystem::path& folder, const std::string& job);
/// The scheduler's number of the array; nothing: whether it was submitted is not known.
std::optional<std::string> read_array_job(const std::filesystem::path& folder);

std::filesystem::path task_folder(const std::filesystem::path& array, int task);
void write_task_end(const std::filesystem::path& array, int task, const TaskEnd& end);
std::optional<TaskEnd> read_task_end(const std::filesystem::path& array, int task);

/// Takes the folder of an array away, and the one of all arrays where it is empty.
void remove_array(const std::filesystem::path& folder);

/// `mottle cancel` leaves it in the folder of tasks for a Mottle that waits for them.
std::filesystem::path cancel_mark(const std::filesystem::path& results);

}  // namespace mottle::drivers
