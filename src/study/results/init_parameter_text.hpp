// Parameters of a proposed study, and the numbers that are none, in TOML and in words.
#pragma once

#include <string>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/init.hpp"

namespace mottle::study {

/// A block [[parameter]] with the reasons for its numbers.
std::string parameter_text(const InitParameter& parameter);

/// Comments: the numbers of the deck that are no parameters, those of one reason together. Empty: there are none.
std::string left_out_text(const InitOutcome& outcome);

/// "M_CONM2_7001_7002, with CONM2:7002:M; without it the tests' ln likelihood would be 12 lower".
std::string chosen_text(const InitParameter& parameter);

/// ": `mottle targets`" where that command lists the numbers that are not shown here.
std::string where_others_are(const InitOutcome& outcome);

}  // namespace mottle::study
