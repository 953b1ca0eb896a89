// Tests that number modes by rank of frequency against a model that numbers them by shape.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::study {

/// What to say where no cloud shows whether modes cross. Nothing where the model numbers its modes by order, or where a
/// specimen's frequencies do not ascend (its modes were identified by other means).
///
/// @param tests  [specimen x output], frequencies first, as StructureModel names them; nan: missing
std::optional<std::string> rank_note(const OutputSelection& selection, const Eigen::Ref<const Eigen::MatrixXd>& tests);

/// What to say where modes cross in the prior's or the updated cloud, so that a test's f1 may be the model's f2: then
/// means and standard deviations are biased. Nothing where rank_note() says nothing or crossings are rare (1 % of both
/// clouds).
///
/// @param history  states of the update, with their clouds' notes
std::optional<std::string> rank_warning(const OutputSelection& selection,
                                        const Eigen::Ref<const Eigen::MatrixXd>& tests,
                                        const std::vector<IterationRecord>& history);

/// What to say where both number modes by rank and neighbours cross: their gap in the cloud of the updated population
/// is less than 2.33 of its standard deviations. Nothing where the model numbers its modes by shape.
std::optional<std::string> bend_warning(const OutputSelection& selection, const IterationRecord& state);

}  // namespace mottle::study
