// What the files of a diagnosis are called.
#pragma once

namespace mottle {

inline constexpr const char* k_diagnosis = "diagnosis.json";
inline constexpr const char* k_diagnosis_log = "diagnosis.log";
inline constexpr const char* k_diagnosis_journal = "diagnosis.journal";

}  // namespace mottle
