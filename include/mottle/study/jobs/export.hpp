// The job of `mottle export`: what an update found, as decks for the solver, tables, and a study that goes on from it.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/run.hpp"

namespace mottle::study {

struct ExportSettings {
  std::filesystem::path results;   ///< folder of an update
  std::filesystem::path out = {};  ///< folder to make, which must not be there; empty: "export" within `results`
  int decks = 0;                   ///< decks of so many samples besides that of the means
  bool accepts_changes = false;    ///< go on where files of the model have changed since the update
};

struct ExportOutcome {
  std::filesystem::path folder = {};
  std::map<std::filesystem::path, std::string> files = {};  ///< by path within the folder
  std::vector<std::string> notes = {};
};

/// Reads the results of an update and makes, without writing anything:
///
/// - `mean/`: the model's deck with the updated means in it, all other lines as they are (Nastran, CalculiX);
/// - `sample-0001/`, ...: the same of samples of the last cloud;
/// - `parameters.csv`: name, unit, mean, standard deviation, 95 % intervals;
/// - `samples.csv`: the parameters of the last cloud's samples;
/// - `study.toml`: the study with the result as its prior, for a next update or `mottle propagate`.
///
/// @throws InvalidInput  no results of an update, a folder that is there, files of the model that have changed since,
///                       numbers that cannot be written into the deck
ExportOutcome make_export(const ExportSettings& settings);

/// Writes the folder whole or not at all.
void write_results(const ExportOutcome& outcome);
RunSummary summarise(const ExportOutcome& outcome);

}  // namespace mottle::study
