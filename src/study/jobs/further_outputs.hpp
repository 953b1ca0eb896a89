// Outputs that a test could measure beside those of a study: which there are, and what they would be named.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/input/study.hpp"

namespace mottle::study {

/// What is measured together: a natural frequency, or one mode's shape.
struct FurtherOutputs {
  std::string text;                ///< "f4", "the shape of mode 2 at m1, m2, m3"
  std::vector<std::string> names;  ///< of the outputs
  bool is_shape = false;
};

/// Frequencies of modes that the study does not use, up to a few above its highest, and shapes of its lowest modes at
/// the degrees of freedom of its other shapes, or at the masses of a mass-spring system.
///
/// @param mode_count  modes that the model has
std::vector<FurtherOutputs> further_outputs(const Study& study, Eigen::Index mode_count);

/// The study's outputs with everything that further_outputs() names.
OutputSelection wider_outputs(const Study& study, Eigen::Index mode_count);

}  // namespace mottle::study
