// The job of `mottle modes`: natural frequencies and shapes of one finite-element model, for display and comparison.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/run.hpp"

namespace mottle::study {

/// What to compute.
struct ModesSettings {
  std::filesystem::path model;  ///< a Nastran deck
  int modes = 0;                ///< 0: what the deck's EIGRL asks for, else 10
  std::optional<std::filesystem::path>
      compare;  ///< shapes to compare with: a CSV, or another deck with the same grid points
  std::set<std::string> ignore_cards = {};
  std::optional<int> subcase = std::nullopt;  ///< id; without it the first one that asks for modes
  bool writes_universal_file = false;         ///< also modes.uff, for programs of the test laboratory
  const std::atomic<bool>* stop = nullptr;    ///< true: the solution is to be stopped
};

/// A deck with its modes, opaque: src/study/jobs/solved_deck.hpp.
struct SolvedDeck;

/// The modes' shapes against others.
struct ModeComparison {
  std::vector<std::string> names;  ///< of the other side's modes
  Eigen::MatrixXd mac;             ///< modal assurance criterion [own mode x other mode]
  std::vector<Eigen::Index>
      partner;  ///< other mode of each own one, -1: none; the sum of their MAC is the largest [own mode]
  Eigen::Index degrees_of_freedom = 0;  ///< that both sides have
};

struct ModesOutcome {
  ModesSettings settings;
  std::shared_ptr<const SolvedDeck> deck = nullptr;
  std::optional<ModeComparison> comparison = std::nullopt;
  double seconds = 0.0;

  const Eigen::VectorXd& frequencies() const;  ///< Hz where the deck's time unit is the second [mode]
  const Eigen::VectorXd& residuals() const;    ///< relative, of the eigenvalue problem [mode]
};

/// Mode shapes at grid points, of modal mass 1, in the basic coordinate system.
struct GridShapes {
  std::vector<int> nodes = {};                       ///< ids
  Eigen::MatrixX3d positions = {};                   ///< [node x 3]
  std::vector<Eigen::MatrixX3d> displacements = {};  ///< of each mode [node x 3]
};
GridShapes grid_shapes(const ModesOutcome& outcome);

/// Solves the model.
///
/// A CSV of shapes has a column "dof" (101:+Z) and one column a mode, named as the test calls it.
///
/// @param folder  where results of an earlier run are set aside; empty: nowhere
///
/// Throws InvalidInput: a deck or CSV that cannot be understood, shapes without a degree of freedom in common;
/// SystemFailure: the modes do not converge, or fewer were found than the inertia of K - s M counts; Stopped: on
/// request.
ModesOutcome find_modes(const ModesSettings& settings, const std::filesystem::path& folder = {});

/// modes.csv (frequencies, residuals), modes.json (what the page shows), modes.vtu, modes.uff where it is wanted.
void write_results(const ModesOutcome& outcome, const std::filesystem::path& folder);
RunSummary summarise(const ModesOutcome& outcome, const std::filesystem::path& folder);

}  // namespace mottle::study
