// The model's own error, shared by all specimens: what methods make of [test] model_error.
#pragma once

#include <string>

#include "mottle/layers.hpp"
#include "updating/population/population_fit.hpp"

namespace mottle::updating {

/// The model's error that a fit works with, as given, or in levels to estimate: one for each unit of the outputs, as
/// for noise (see noise_model). Empty where the tests have none. Throws InvalidInput: it is to be estimated but there
/// are no more outputs than parameters.
NoiseModel model_error_model(const UpdatingProblem& problem);

/// What the tests say of the model's error, in words.
std::string model_error_note(const UpdatingProblem& problem, const ModelError& error);

/// Tells in a note what a method makes of a given model error, `use`, or that it cannot estimate one; nothing without.
void note_model_error(const UpdatingProblem& problem, const std::string& method, const std::string& use,
                      UpdatingResult& result);

/// The model's error as a method has it that does not look for its shift: none is found, and the mean takes it over.
///
/// @param gain  change of the estimated mean with what is taken off the tests [parameter x output]
std::optional<ModelError> given_model_error(const UpdatingProblem& problem, const Eigen::MatrixXd& gain);

}  // namespace mottle::updating
