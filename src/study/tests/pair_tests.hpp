// Gives measured modes the model's mode numbers, by their shapes.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/structure_model.hpp"

namespace mottle::study {

/// Renumbers the modes of every specimen: a test counts its modes as it finds them, the model as the reference does.
///
/// Each specimen's shapes are paired with the reference's by MAC and optimal assignment; frequency, damping ratio and
/// shape of a measured mode move to the number of the mode that it is, turned to the sign of the reference. A pair
/// whose MAC is below `minimum_mac` is left out (not measured), as is a mode with a missing component.
///
/// @param values     [specimen x output], frequencies, shapes mode by mode, damping ratios, as StructureModel names
/// them; others behind them stay; changed
/// @param selection  whose frequencies and shape_modes are the same modes
/// @param reference  shapes at the outputs' degrees of freedom [degree of freedom x shape mode]
/// @return           what was changed or left out, a sentence each
/// @throws InvalidInput  no shapes among the outputs, or other modes than the frequencies'
std::vector<std::string> pair_tests(Eigen::MatrixXd& values, const OutputSelection& selection,
                                    const Eigen::Ref<const Eigen::MatrixXd>& reference);

/// Turns shapes that stand upside down to the sign of the reference: those of at least two measured components whose
/// cosine with the reference is at most -sqrt(minimum_mac). One component alone may have another sign by noise.
///
/// @param values     [specimen x output], as of pair_tests(); changed
/// @param reference  as of pair_tests()
/// @return           which were turned; empty: none
std::string turn_shapes(Eigen::MatrixXd& values, const OutputSelection& selection,
                        const Eigen::Ref<const Eigen::MatrixXd>& reference);

}  // namespace mottle::study
