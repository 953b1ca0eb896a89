// The objects that an update was computed with.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/model.hpp"
#include "mottle/updating/methods/surrogate_update.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "study/jobs/factor_nominals.hpp"
#include "study/jobs/update_plan.hpp"
#include "study/results/model_files.hpp"

namespace mottle::study {

struct UpdateWorkings {
  UpdatePlan plan;
  std::vector<ModelFile> model_files = {};                           ///< as they were when the model was read
  std::vector<ModelFile> study_files = {};                           ///< the study's own and its tests', likewise
  std::vector<std::optional<FactorNominal>> factors = {};            ///< [parameter]
  std::unique_ptr<const Model> model = nullptr;                      ///< that was run; see plan.made for what it is
  std::unique_ptr<const DifferentiableModel> derivatives = nullptr;  ///< of a given model, as they are kept
  std::unique_ptr<const UpdatingProblem> given = nullptr;            ///< over `model`
  std::unique_ptr<SurrogateUpdate> surrogate = nullptr;              ///< null: the method ran the model itself

  const UpdatingProblem& problem() const { return surrogate ? surrogate->problem() : *given; }
};

}  // namespace mottle::study
