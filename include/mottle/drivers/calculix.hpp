// CalculiX as a source of matrices: decks with other numbers, its runs, and the model that follows from them.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "mottle/formats/calculix_deck.hpp"
#include "mottle/model/matrix_structure.hpp"

namespace mottle {

/// How CalculiX is run.
struct CalculixSettings {
  std::string program = "ccx";
  std::chrono::milliseconds timeout = std::chrono::hours(1);  ///< of one run
  std::filesystem::path cache = {};                           ///< folder where matrices are kept; empty: nowhere
};

/// K(x) and M(x) of a deck whose numbers follow the parameters, from runs that store its matrices; verified at a point
/// that they were not made from. Matrices of a deck that was run before come from the cache.
///
/// @param fallback  nominal value of placeholders, and of numbers that differ where one parameter sets several
/// @throws InvalidInput   a target that is not in the deck, a number tied to two parameters, a nominal value of 0, a
///                        model that is not separable, a program that is not there
/// @throws SystemFailure  a run that fails or takes too long, with the end of what CalculiX printed
MatrixModel calculix_model(const CalculixDeck& deck, const std::vector<ParameterTargets>& parameters,
                           const Eigen::VectorXd& fallback, const CalculixSettings& settings);

}  // namespace mottle
