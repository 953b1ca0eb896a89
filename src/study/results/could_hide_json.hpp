// Errors of fixed numbers that could hide behind a verdict, in result.json.
#pragma once

#include "mottle/layers.hpp"
#include "mottle/study/jobs/could_hide.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {

/// `verdict.could_hide` of result.json.
Json could_hide_json(const CouldHide& hidden, const std::vector<std::string>& parameters);

}  // namespace mottle::study
