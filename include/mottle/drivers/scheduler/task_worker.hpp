// What a task of an array does on its node: its runs, one after the other, each kept at once.
#pragma once

#include <atomic>
#include <filesystem>

#include "mottle/layers.hpp"

namespace mottle::drivers {

/// Does the runs of task `task` that are not done yet. A task that the scheduler starts again goes on.
///
/// @param array  the array's folder; where it was taken away meanwhile, nothing is done
/// @throws InvalidInput   the study's files have changed since the array was made; no such program on this node
/// @throws SystemFailure  disk full; Stopped
void run_task(const std::filesystem::path& array, int task, const std::atomic<bool>* stop);

/// Of a task that has found the study's files changed: its word of it, in the array's folder.
inline constexpr const char* k_changed_files = "changed";

}  // namespace mottle::drivers
