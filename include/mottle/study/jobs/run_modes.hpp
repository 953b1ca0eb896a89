// The job of `mottle modes`: natural frequencies and shapes of one finite-element model, to look at and to compare.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>

#include "mottle/study/jobs/run.hpp"

namespace mottle {

/// What to compute and where to leave it.
struct ModesSettings {
  std::filesystem::path model;   ///< a Nastran deck
  std::filesystem::path folder;  ///< for modes.json, modes.csv, modes.vtu
  int modes = 0;                 ///< 0: what the deck's EIGRL asks for, else 10
  std::optional<std::filesystem::path>
      compare;  ///< shapes to compare with: a CSV, or another deck with the same grid points
  std::set<std::string> ignore_cards = {};
  bool writes_universal_file = false;  ///< also modes.uff, for programs of the test laboratory
};

/// Solves the model and writes modes.csv (frequencies, residuals), modes.json (what the page shows) and modes.vtu.
///
/// A CSV of shapes has a column "dof" (101:+Z) and one column a mode, named as the test calls it.
///
/// Throws InvalidInput: a deck or CSV that cannot be understood, shapes without a degree of freedom in common;
/// SystemFailure: the modes do not converge, or fewer were found than the inertia of K - s M counts.
RunSummary run_modes(const ModesSettings& settings);

}  // namespace mottle
