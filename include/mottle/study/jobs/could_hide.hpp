// Errors in a model's fixed numbers (moved by no parameter) that could bias the estimates without the verdict's tests
// showing it.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/verdict/hidden_errors.hpp"

namespace mottle::study {

/// A hidden error with the name of the number that it is of.
struct NamedError {
  std::string name;
  double nominal = 0.0;
  double size = 0.0;  ///< of relative changes: the number itself, of a zero the size of its kind
  HiddenError error;

  double change() const { return error.relative_change * size; }
};

/// Errors that could hide.
struct CouldHide {
  std::vector<NamedError> errors;      ///< the most harmful first, a dozen at most
  bool is_level_known = false;         ///< the test of the means knows the noise; else its level is estimated
  std::vector<std::string> sentences;  ///< where undecided: the most harmful, and which further outputs would show them
  std::vector<std::string> notes;      ///< what was not examined
  std::string summary;                 ///< one line; empty where nothing is known
};

}  // namespace mottle::study
