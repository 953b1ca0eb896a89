// Tested frequencies that are probably mistaken: in another order, another unit, or mistyped.
#pragma once

#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::study {

/// Doubts of frequencies that no other value of the tests supports. They are not refused, since a model may be far
/// off and a structure may be damaged.
///
/// - Values that differ from the median of their column by a factor of 1.8 or more. Where that factor is within 10 % of
///   2 pi, 60, 1000 or the inverse of one, the unit that makes it is named.
/// - Columns whose median differs from the model's reference by such a factor, relative to the other columns.
/// - Pairs of columns 5 % or more off the model's reference, a common factor apart, and at most a quarter of that when
///   they are exchanged.
/// - Columns near (2 pi f)^2 of the model's frequencies, and nearer to them than to any multiple of f: eigenvalues.
/// - Specimens whose frequencies do not ascend with the modes' numbers, where the model counts its modes by frequency.
std::vector<TestDoubt> doubtful_frequencies(const StructureModel& model, const TestData& tests);

}  // namespace mottle::study
