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
/// Each specimen's shapes are paired with the reference's by MAC and optimal assignment; all quantities of a measured
/// mode move to the number of the mode that it is, its shape turned to the sign of the reference. A pair
/// whose MAC is below `minimum_mac` is left out (not measured), as is a mode with a missing component.
///
/// @param values     [specimen x output] in the order of StructureModel::measured(); those of no mode stay; changed
/// @param selection  whose frequencies and shape_modes are the same modes
/// @param reference  shapes at the outputs' degrees of freedom [degree of freedom x shape mode]
/// @param numbers    of the specimens, as of TestData::numbers
/// @return           what was changed or left out, a sentence each
/// @throws InvalidInput  no shapes among the outputs, or other modes than the frequencies'
std::vector<std::string> pair_tests(Eigen::MatrixXd& values, const OutputSelection& selection,
                                    const Eigen::Ref<const Eigen::MatrixXd>& reference,
                                    const std::vector<int>& numbers = {});

/// Turns shapes that stand upside down to the sign of the reference: those of at least two measured components whose
/// cosine with the reference is at most -sqrt(minimum_mac). One component alone may have another sign by noise.
///
/// @param values     [specimen x output], as of pair_tests(); changed
/// @param reference, numbers  as of pair_tests()
/// @return           which were turned; empty: none
std::string turn_shapes(Eigen::MatrixXd& values, const OutputSelection& selection,
                        const Eigen::Ref<const Eigen::MatrixXd>& reference, const std::vector<int>& numbers = {});

/// Names shapes that no sign of the whole makes like the model's: at least two measured components and a MAC below
/// `minimum_mac`. Where they would be alike (mean MAC of 0.8) with the other sign of one degree of freedom, that is
/// said.
///
/// @param values, reference, numbers  as of pair_tests(), signs as turn_shapes() leaves them
/// @return                            empty: there are none
std::string unlike_shapes(const Eigen::MatrixXd& values, const OutputSelection& selection,
                          const Eigen::Ref<const Eigen::MatrixXd>& reference, const std::vector<int>& numbers = {});

}  // namespace mottle::study
