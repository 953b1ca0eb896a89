// An update of a model that a program gives, a function of its own, in place of a study file's.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/model.hpp"
#include "mottle/study/jobs/update.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::study {

/// What a study file would say, as objects.
struct GivenStudy {
  std::shared_ptr<const Model> model;  ///< also a DifferentiableModel where it has derivatives
  ParameterSpace space;
  TestData tests;                       ///< without specimens that have no value
  std::vector<std::string> notes = {};  ///< what a reader of the tests should know
  StudyUpdate update = {};
  std::optional<SurrogateSettings> surrogate = std::nullopt;
  std::uint64_t seed = 1;
  std::string title = {};
  /// All of this but model and tests, as TOML with a table [model]: it becomes study.toml of the results, and an update
  /// that was interrupted is only resumed where it is the same.
  std::string text = "[model]\n";
};

/// Updates it as update() does a study: log, journal and resumption are the same. Errors that could hide behind the
/// verdict are not looked for, since a function's fixed numbers are not known.
///
/// A resumed update takes what the model has answered before as it is: whether the model is still the same cannot be
/// seen. It is asked for batches of Model::batch_size() samples at most, each of which is kept at once, as are its
/// derivatives.
///
/// @throws InvalidInput  parameters, outputs or tests do not fit each other or the method
/// @throws SystemFailure, Stopped  as update()
UpdateOutcome update(GivenStudy given, const RunSettings& settings);

}  // namespace mottle::study
