// Makes report.html of a run's folder from the files in it.
#pragma once

#include <filesystem>

#include "mottle/layers.hpp"

namespace mottle::report {

/// Reads result.json, tests.csv and clouds.csv of `folder` and writes report.html beside them.
///
/// Throws InvalidInput: no result.json there, or one of these files cannot be understood; SystemFailure: cannot write.
void write_report(const std::filesystem::path& folder);

/// Reads modes.json of `folder` and writes modes.html beside it.
void write_modes_page(const std::filesystem::path& folder);

}  // namespace mottle::report
