// Sentences on errors of fixed numbers that could hide behind a verdict.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/could_hide.hpp"

namespace mottle::study {

/// "1.2 %"; of a number that is 0 in the model the change itself.
std::string change_text(const NamedError& error);

/// "k1 by 1.4 half-widths of its 95 % interval", of the parameter that moves most; in prior standard deviations where
/// it has no interval; without a number where a mean moves too far for first order.
std::string harm_text(const HiddenError& error, const std::vector<std::string>& parameters);

/// "k6 off by 10 % would not show in these tests, and moves k1 by ...".
///
/// @param is_level_known  whether the test of the means knows the noise; it promises less where its level is estimated
std::string hidden_error_sentence(const NamedError& error, const std::vector<std::string>& parameters,
                                  bool is_level_known);

/// The most harmful errors in one sentence, those that the verdict sees and those that it does not apart.
std::string summary_text(const std::vector<NamedError>& worst, const std::vector<std::string>& parameters,
                         bool is_level_known);

/// "k6 off by 1.2 %, k4 off by 2 %".
std::string sizes_text(const std::vector<NamedError>& errors);

}  // namespace mottle::study
