// Finds key and line of a study to which an error belongs.
#include "mottle/core/subject.hpp"
#include "mottle/study/input/study.hpp"
#include "study/input/key_error.hpp"

namespace mottle::study {
namespace {

/// The key of a study that a subject is read from.
std::string key_of(const Study& study, const Subject& subject) {
  switch (subject.kind) {
    case Subject::Kind::parameter:
      return fmt::format("parameter '{}'", subject.name);
    case Subject::Kind::model:
      return "model";
    case Subject::Kind::stiffness:
      return "model.stiffness";
    case Subject::Kind::mass:
      return "model.mass";
    case Subject::Kind::matrix_part:
      return fmt::format("model.terms '{}'", subject.name);
    case Subject::Kind::row_names:
      return "model.degrees_of_freedom";
    case Subject::Kind::program:
      return "model.program";
    case Subject::Kind::command:
      return "model.command";
    case Subject::Kind::retry_command:
      return "model.retry_command";
    case Subject::Kind::run_files:
      return "model.files";
    case Subject::Kind::outputs:
      return subject.name.empty() ? study.outputs_key : study.outputs_key + "." + subject.name;
    case Subject::Kind::frequencies:
      return study.outputs_key + ".frequencies";
    case Subject::Kind::shape_modes:
      return study.outputs_key + ".shapes.modes";
    case Subject::Kind::shape_locations:
      return study.outputs_key + ".shapes.dofs";
    case Subject::Kind::damping:
      return study.outputs_key + ".damping";
    case Subject::Kind::tests:
      return "test";
    case Subject::Kind::repeatability:
      return "test.repeatability";
    case Subject::Kind::model_error:
      return "test.model_error";
    case Subject::Kind::pairing:
      return "test.pairing";
    case Subject::Kind::method:
      return fmt::format("method '{}'", subject.name);
    case Subject::Kind::option:
      return "update." + subject.name;
    case Subject::Kind::samples:
      return "update.samples";
    case Subject::Kind::surrogate_runs:
      return "surrogate.runs";
  }
  return subject.name;
}

/// Line of a key, or of the table that it would stand in; 0: neither is there.
int line_of(const Study& study, std::string key) {
  while (true) {
    const auto found = study.lines.find(key);
    if (found != study.lines.end()) return found->second;
    const std::size_t dot = key.rfind('.');
    if (dot == std::string::npos) return 0;
    key.resize(dot);
  }
}

}  // namespace

std::string located(const Study& study, const std::string& key, const std::string& fault, const std::string& section) {
  const int line = line_of(study, section + key);
  if (study.file.empty()) return fmt::format("{}: {}", key, fault);  // a program gave the study
  return line > 0 ? fmt::format("{}:{}: {}: {}", study.file.string(), line, key, fault)
                  : fmt::format("{}: {}: {}", study.file.string(), key, fault);
}

std::string located(const Study& study, const InvalidInput& error, const std::string& section) {
  if (const auto* of = dynamic_cast<const SubjectError*>(&error)) {
    return located(study, key_of(study, of->subject()), of->fault(), section);
  }
  if (const auto* of = dynamic_cast<const KeyError*>(&error)) return located(study, of->key(), of->fault(), section);
  // Names the file and the line itself.
  if (dynamic_cast<const FormatError*>(&error) != nullptr || study.file.empty()) return error.what();
  return fmt::format("{}: {}", study.file.string(), error.what());
}

}  // namespace mottle::study
