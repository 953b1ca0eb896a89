// What a task of an array does on its node: its runs, one after the other, each kept at once.
#pragma once

#include <atomic>
#include <filesystem>

#include "mottle/layers.hpp"

namespace mottle::drivers {

/// Does the runs of task `task` that are not done yet. A task that the scheduler starts again goes on.
///
/// Does nothing where the task was given up, or where another process does it.
///
/// @param array  the array's folder
/// @throws InvalidInput   there is no array; the study's files have changed since it was made; no such program on this
///                        node
/// @throws SystemFailure  disk full; Stopped
void run_task(const std::filesystem::path& array, int task, const std::atomic<bool>* stop);

/// Of a task that has found the study's files changed: its word of it, in the array's folder.
inline constexpr const char* k_changed_files = "changed";

/// Of a task that has ended because the disk was full: its word of it, in its own folder.
inline constexpr const char* k_full_disk = "disk-was-full";

}  // namespace mottle::drivers
