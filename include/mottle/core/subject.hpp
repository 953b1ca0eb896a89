// What a fault of the input is about, in the library's own terms; the reader of the input knows its key and line.
#pragma once

#include <string>
#include <utility>

#include "mottle/core/error.hpp"

namespace mottle {

struct Subject {
  enum class Kind {
    parameter,  ///< by its name
    model,
    stiffness,  ///< the matrix that no parameter moves
    mass,
    matrix_part,  ///< by its name
    row_names,    ///< names of the matrices' rows
    program,      ///< that the model is run by
    command,
    retry_command,
    run_files,  ///< files that every run gets
    outputs,    ///< all, or those of one kind by its name
    frequencies,
    shape_modes,
    shape_locations,  ///< degrees of freedom of shapes
    damping,
    tests,
    repeatability,
    model_error,
    pairing,  ///< of measured modes with the model's
    method,   ///< of updating, by its name
    option,   ///< of a method: "mares.weighting"
    samples,  ///< of a cloud
    surrogate_runs,
  };
  Kind kind;
  std::string name = {};

  /// "parameter 'k1'", "frequencies".
  std::string text() const;
};

inline Subject subject_parameter(std::string name) {
  return {Subject::Kind::parameter, std::move(name)};
}

/// A fault of the input in one thing: what() is "SUBJECT: FAULT".
class SubjectError final : public InvalidInput {
 public:
  SubjectError(Subject subject, const std::string& fault)
      : InvalidInput(subject.text() + ": " + fault), subject_(std::move(subject)), fault_(fault) {}

  const Subject& subject() const { return subject_; }
  const std::string& fault() const { return fault_; }

 private:
  Subject subject_;
  std::string fault_;
};

/// Throws SubjectError with the formatted fault unless `claim` holds.
template <typename... Arguments>
void require_of(bool claim, const Subject& subject, fmt::format_string<Arguments...> fault, Arguments&&... arguments) {
  if (!claim) throw SubjectError(subject, fmt::format(fault, std::forward<Arguments>(arguments)...));
}

}  // namespace mottle
