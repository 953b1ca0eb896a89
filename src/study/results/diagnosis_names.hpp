// What the files of a diagnosis are called.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::study {

inline constexpr const char* k_diagnosis = "diagnosis.json";
inline constexpr const char* k_diagnosis_model = "diagnosis-model.json";
inline constexpr const char* k_diagnosis_page = "diagnosis.html";
inline constexpr const char* k_diagnosis_log = "diagnosis.log";
inline constexpr const char* k_diagnosis_journal = "diagnosis.journal";
inline constexpr const char* k_linear_stage = "linear";  ///< of diagnosis.json, before any candidate is fitted

/// The results; the last name says that they are complete.
inline std::vector<std::string> diagnosis_names() {
  return {k_diagnosis_page, k_diagnosis_model, k_diagnosis};
}

}  // namespace mottle::study
