#include "study/tests/missing_output.hpp"

#include <algorithm>

#include "mottle/core/text.hpp"
#include "study/input/first_few.hpp"
#include "study/tests/pair_modes.hpp"
#include "study/tests/specimen_pairing.hpp"

namespace mottle::study {
namespace {

bool is_shape(const Quantity& quantity) {
  return quantity.kind == QuantityKind::displacement || quantity.kind == QuantityKind::rotation;
}

/// Whether the shape of the output's mode was measured in some specimen without a size.
bool has_no_size(const StructureModel& model, const Quantity& output, const StudyTests& tests, bool is_by_mac) {
  return tests.specimens && std::ranges::any_of(*tests.specimens, [&](const PairedSpecimen& specimen) {
           const std::vector<int> modes = SpecimenPairing(model, specimen.modes, is_by_mac).modes_without_size();
           return std::ranges::count(modes, output.number) > 0;
         });
}

/// Why no shape of the output's mode could be scaled; empty: it was never measured at all.
std::string why_not_scaled(const StructureModel& model, const Quantity& output, const Eigen::MatrixXd& measured) {
  std::vector<std::string> missing;
  Eigen::Index components = 0;
  for (std::size_t k = 0; k < model.measured().size(); ++k) {
    const Quantity& quantity = model.measured()[k];
    if (!is_shape(quantity) || quantity.number != output.number) continue;
    ++components;
    const auto column = measured.col(static_cast<Eigen::Index>(k)).array();
    if (column.isNaN().all()) missing.push_back(quantity.name());
  }
  if (static_cast<Eigen::Index>(missing.size()) == components) return {};
  if (missing.empty()) {
    return fmt::format(
        "follows from no specimen: shapes whose size is free are scaled by all components of outputs.shapes.dofs, and "
        "mode {} has them all in none, or is zero or nearly orthogonal to the model's; leave out the dofs or the mode",
        output.number);
  }
  return fmt::format(
      "follows from no specimen: shapes whose size is free are scaled by all components of outputs.shapes.dofs, and {} "
      "{} never measured; leave {} out of dofs",
      first_few(missing), missing.size() == 1 ? "is" : "are", missing.size() == 1 ? "it" : "them");
}

}  // namespace

std::string why_missing(const StructureModel& model, const Quantity& output, const Eigen::MatrixXd& measured,
                        const StudyTests& tests, bool is_by_mac) {
  if (is_shape(output) && model.selection().shape_size == ShapeSize::free) {
    if (std::string reason = why_not_scaled(model, output, measured); !reason.empty()) return reason;
  } else if (is_shape(output) && has_no_size(model, output, tests, is_by_mac)) {
    return fmt::format(
        "is not used of any specimen: the tests' shapes of mode {} have no modal mass, so that their size is unknown; "
        "outputs.shapes.size = \"free\" compares directions alone, or leave the mode out of outputs.shapes.modes",
        output.number);
  }
  return fmt::format("is never measured; leave it out of [outputs]{}",
                     tests.specimens ? ", or, if it is no quantity of a mode, give the tests as a CSV" : "");
}

}  // namespace mottle::study
