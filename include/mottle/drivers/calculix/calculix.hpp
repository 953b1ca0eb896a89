// CalculiX as a source of matrices: decks with other numbers, its runs, and the model that follows from them.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "mottle/drivers/command/solver_command.hpp"
#include "mottle/formats/calculix/deck.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/structures/matrix_structure.hpp"

namespace mottle::drivers {

/// How CalculiX is run.
struct CalculixSettings {
  std::string program = "ccx";
  std::chrono::milliseconds timeout = std::chrono::hours(1);  ///< of one run
  std::filesystem::path cache = {};                           ///< folder where matrices are kept; empty: nowhere
  int parallel = 1;                                           ///< runs of samples at once
  const std::atomic<bool>* stop = nullptr;                    ///< ends a run early
};

/// K(x) and M(x) of a deck whose numbers follow the parameters, from runs that store its matrices; verified at a point
/// that they were not made from, and by the modes that CalculiX finds itself at the nominal one. What was run before
/// comes from the cache.
///
/// @param fallback  nominal value of placeholders, and of numbers that differ where one parameter sets several
/// @throws InvalidInput   a target that is not in the deck, a number tied to two parameters, a nominal value of 0, a
///                        program that is not there; NotSeparable: there are no such K(x) and M(x),
///                        or CalculiX prints them with too few digits; InvalidInput: cards that CalculiX ignores
/// @throws SystemFailure  a run that fails or takes too long, with the end of what CalculiX printed
MatrixModel calculix_model(const CalculixDeck& deck, const std::vector<ParameterTargets>& parameters,
                           const Eigen::VectorXd& fallback, const CalculixSettings& settings);

/// The deck as a solver to run for each sample, with a placeholder for each parameter: frequencies from .dat, and
/// shapes from .frd where the deck asks for displacements.
///
/// @throws InvalidInput  as calculix_model; a deck without the one step *FREQUENCY
SolverCommand calculix_command(const CalculixDeck& deck, const std::vector<ParameterTargets>& parameters,
                               const CalculixSettings& settings);

}  // namespace mottle::drivers
