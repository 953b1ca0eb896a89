// The columns of a table of tests as modes of the model.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/input/study.hpp"
#include "study/tests/pair_by_frequency.hpp"

namespace mottle::study {

/// Renumbers the columns of a table by frequency where the study says so; where it says nothing, notes which of them
/// may be other modes than their names say. No program is run for the note.
///
/// @param notes         added to
/// @throws InvalidInput, FormatError  by frequency: shapes are outputs, or as of FrequencyPairing
std::optional<FrequencyPairing> pair_columns(const Study& study, const StructureModel& model, CsvTable& table,
                                             std::vector<std::string>& notes);

}  // namespace mottle::study
