#include "mottle/core/subject.hpp"

namespace mottle {

std::string Subject::text() const {
  switch (kind) {
    case Kind::parameter:
      return fmt::format("parameter '{}'", name);
    case Kind::model:
      return "model";
    case Kind::stiffness:
      return "stiffness matrix";
    case Kind::mass:
      return "mass matrix";
    case Kind::matrix_part:
      return fmt::format("matrix part '{}'", name);
    case Kind::row_names:
      return "names of the matrices' rows";
    case Kind::program:
      return "program";
    case Kind::command:
      return "command";
    case Kind::retry_command:
      return "command to try again";
    case Kind::run_files:
      return "files of a run";
    case Kind::outputs:
      return name.empty() ? "outputs" : name;
    case Kind::frequencies:
      return "frequencies";
    case Kind::shape_modes:
      return "modes of shapes";
    case Kind::shape_locations:
      return "degrees of freedom of shapes";
    case Kind::damping:
      return "damping ratios";
    case Kind::tests:
      return "tests";
    case Kind::repeatability:
      return "repeatability";
    case Kind::model_error:
      return "model error";
    case Kind::pairing:
      return "pairing of modes";
    case Kind::method:
      return fmt::format("method '{}'", name);
    case Kind::option:
      return fmt::format("option {}", name);
    case Kind::samples:
      return "samples";
    case Kind::surrogate_runs:
      return "runs for a surrogate";
  }
  return name;
}

}  // namespace mottle
