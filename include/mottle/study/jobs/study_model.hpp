// The model of a study.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/parameters/parameter_space.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/study/models/program_runs.hpp"

namespace mottle::study {

/// Parameters and the model that they drive.
struct StudyModel {
  std::unique_ptr<ParameterSpace> space;
  std::unique_ptr<StructureModel> model;
  std::vector<std::string> files = {};      ///< that the model was read from
  std::vector<std::string> notes = {};      ///< what a reader of the model should know
  std::optional<ProgramRuns> program = {};  ///< of a model each of whose solutions is a run of a program
};

}  // namespace mottle::study
