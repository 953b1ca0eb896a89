// Whether files in a folder are what Mottle left there.
#pragma once

#include <filesystem>

#include "mottle/layers.hpp"

namespace mottle::study {

/// Whether a job may write over the file: it is not there; what it holds says that an earlier job wrote it (a result, a
/// log, a journal, whatever else has such a name); or, where that cannot tell (tables, pages), another file of its
/// folder does.
bool may_be_own_result(const std::filesystem::path& file);

}  // namespace mottle::study
