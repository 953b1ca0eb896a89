// The files that [test] names: their paths and contents.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mottle/formats/tables/csv.hpp"
#include "mottle/layers.hpp"
#include "mottle/study/input/study.hpp"
#include "study/tests/measured_modes.hpp"

namespace mottle::study {

/// The files of test.file: a file itself, of a folder all .uff and .unv, of a pattern in the last part of a path ("*"
/// and
/// "?") those that fit it, in the order of their names.
///
/// Throws InvalidInput: nothing fits.
std::vector<std::filesystem::path> list_test_files(const Study& study);

/// A table of outputs, a row a specimen; or else the modes of every specimen.
struct TestContents {
  std::optional<CsvTable> table = std::nullopt;
  std::vector<MeasuredModes> specimens = {};
  std::vector<std::string> notes = {};
};

/// Reads them by what they are: .uff and .unv, .mat, else CSV.
///
/// Throws FormatError, InvalidInput: a file that cannot be read or understood, a table beside other files.
TestContents read_test_files(const Study& study);

/// The table of a .csv or .mat file that the study names under `key`.
CsvTable read_named_table(const Study& study, const std::string& key, const std::filesystem::path& file);

}  // namespace mottle::study
