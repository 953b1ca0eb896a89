// What the files of a diagnosis are called.
#pragma once

#include "mottle/layers.hpp"

namespace mottle::study {

inline constexpr const char* k_diagnosis = "diagnosis.json";
inline constexpr const char* k_diagnosis_log = "diagnosis.log";
inline constexpr const char* k_diagnosis_journal = "diagnosis.journal";

}  // namespace mottle::study
