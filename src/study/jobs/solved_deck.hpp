// A deck with its modes, as `modes` solves it and its files show it.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "mottle/formats/nastran/model.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/solvers/exact_solver.hpp"
#include "mottle/model/structures/finite_element_structure.hpp"

namespace mottle::study {

/// A deck with its modes.
struct SolvedDeck {
  std::unique_ptr<ExactSolver> solver;
  const FiniteElementStructure* structure = nullptr;  ///< the solver's
  SparseModes modes;
  Eigen::VectorXd frequencies;  ///< in frequency_unit [mode]
  std::string frequency_unit;   ///< "Hz", or "kHz" where modulus and density are those of mm, kg and ms
  Eigen::Index asked = 0;       ///< of the modes; those beyond tell whether a repeated frequency is cut
  std::vector<std::string> notes;
  double read_seconds = 0.0, assembly_seconds = 0.0, solution_seconds = 0.0;
};

/// Reads a Nastran deck and finds its lowest modes.
///
/// @param options       cards to leave out, subcase
/// @param modes         0: what the deck's EIGRL asks for (V1, V2, ND), else 10
/// @param beyond        further modes, as far as there are any
/// @throws FormatError, InvalidInput  a deck that cannot be understood or has no modes
/// @throws SystemFailure  fewer modes were found than the inertia of K - s M counts
/// @throws Stopped  on request
SolvedDeck solve_deck(const std::filesystem::path& deck, const NastranOptions& options, int modes,
                      const std::atomic<bool>* stop = nullptr, int beyond = 0);

}  // namespace mottle::study
