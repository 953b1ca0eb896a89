// What a first study needs of a model: its modes, the numbers in it, and what each changes.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/init.hpp"
#include "mottle/study/jobs/targets.hpp"

namespace mottle::study {

struct InitModel {
  Eigen::VectorXd frequencies;       ///< 0 of rigid-body modes [mode]
  std::vector<Target> targets = {};  ///< by largest sensitivity, descending
  Eigen::Index mode_count = 0;       ///< the most that there can be
  std::vector<std::string> notes = {};
};

/// "nastran", "calculix" (*.inp), or "command" of a file with placeholders {{name}} that is no Nastran deck by its
/// name.
std::string model_kind_of(const std::filesystem::path& model);

/// Solves the model that `outcome` names; units that are not known yet are proposed there.
///
/// @param modes  that are wanted; fewer where there are fewer
/// @throws InvalidInput, FormatError  a deck that cannot be read, or none of its numbers changes its modes
/// @throws SystemFailure  the modes do not converge, CalculiX fails
InitModel solve_for_proposal(InitOutcome& outcome, int modes);

}  // namespace mottle::study
