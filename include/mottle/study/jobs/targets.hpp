// The job of `mottle targets`: the numbers of a deck that can be parameters, and what each does to the modes.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/run.hpp"

namespace mottle::study {

/// What to compute.
struct TargetsSettings {
  std::filesystem::path model;  ///< a deck of Nastran, or of CalculiX (.inp)
  int modes = 0;                ///< 0: what the deck's EIGRL asks for, else 10
  std::set<std::string> ignore_cards = {};
  std::optional<int> subcase = std::nullopt;        ///< id; without it the first one that asks for modes
  std::optional<std::string> units = std::nullopt;  ///< "SI", ..., only named; without them guessed from the materials
  std::filesystem::path cache = {};                 ///< of CalculiX's matrices, as InitSettings::cache
  bool lists_all = false;                           ///< also numbers that are zero, change no mode or are seldom wrong
  const std::atomic<bool>* stop = nullptr;          ///< true: the solution of a Nastran deck is to be stopped
};

/// A number that a parameter may act on.
struct Target {
  std::string name;  ///< "MAT1:2:E"
  std::string unit;
  double value = 0.0;  ///< as in the deck
  int elements = 0;    ///< that use it, where has_energies()
  /// Fraction of the strain energy, in elements whose stiffness depends on it; nan of rigid-body modes [mode].
  Eigen::RowVectorXd strain = {};
  Eigen::RowVectorXd kinetic = {};      ///< the same of the kinetic energy and mass [mode]
  Eigen::RowVectorXd sensitivity = {};  ///< d ln f / d ln p, % per %; nan of rigid-body modes [mode]

  /// Whether elements and energies are known: those of a CalculiX deck are not.
  bool has_energies() const { return strain.size() > 0; }
  /// The largest sensitivity by size; 0 where there is none.
  double largest_sensitivity() const;
};

struct TargetsOutcome {
  TargetsSettings settings;          ///< with the units that were guessed
  Eigen::VectorXd frequencies;       ///< Hz [mode]
  std::vector<Target> targets = {};  ///< by largest sensitivity, descending
  int left_out = 0;                  ///< numbers that `lists_all` would add
  std::vector<std::string> notes = {};
};

/// Solves the deck and finds what each number on its cards changes.
///
///   d ln f / d ln p = (phi' dK/dlnp phi / phi' K phi - phi' dM/dlnp phi / phi' M phi) / 2
///
/// Of modes of one frequency any combination is a mode: theirs are the values into which the frequency splits (the
/// eigenvalues of the derivative on the space that they span), in ascending order, and so are their energies.
///
/// Of a CalculiX deck moduli, densities, springs and masses, and thicknesses where they cost no runs or `lists_all` is
/// set; without energies, by derivatives of its matrices or central differences of runs.
///
/// Throws InvalidInput, FormatError, SystemFailure, Stopped as find_modes().
TargetsOutcome find_targets(const TargetsSettings& settings);

/// A table for a person: the most sensitive mode of each. JSON and CSV have every mode.
RunSummary summarise(const TargetsOutcome& outcome);
std::string targets_csv(const TargetsOutcome& outcome);

}  // namespace mottle::study
