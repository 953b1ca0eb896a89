// Hidden errors in words.
#pragma once

#include <string>
#include <vector>

#include "mottle/updating/hidden_errors.hpp"

namespace mottle {

/// A hidden error with the names of what it is of and what it moves.
struct NamedError {
  std::string name;
  double nominal = 0.0;
  HiddenError error;
};

/// "k1 by 1.4 half-widths of its 95 % interval", of the parameter that moves most.
std::string harm_text(const HiddenError& error, const std::vector<std::string>& parameters);

/// "k6 off by 10 % would have passed, and moves k1 by ...".
std::string hidden_error_sentence(const NamedError& error, const std::vector<std::string>& parameters);

/// The most harmful errors in one sentence, those that the verdict sees and those that it does not apart.
std::string summary_text(const std::vector<NamedError>& worst, const std::vector<std::string>& parameters);

/// "k6 off by 1.2 %, k4 off by 2 %".
std::string sizes_text(const std::vector<NamedError>& errors);

}  // namespace mottle
