#include "study/tests/shape_size.hpp"

#include <algorithm>

#include "mottle/core/text.hpp"
#include "study/input/first_few.hpp"
#include "study/tests/test_files.hpp"

namespace mottle::study {
namespace {

bool is_shape(const Quantity& quantity) {
  return quantity.kind == QuantityKind::displacement || quantity.kind == QuantityKind::rotation;
}

/// Whether a specimen has any of the components of a mode.
bool has_mode(const std::vector<Quantity>& quantities, const Eigen::MatrixXd& values, Eigen::Index specimen, int mode) {
  for (std::size_t k = 0; k < quantities.size(); ++k) {
    const bool is_wanted = is_shape(quantities[k]) && quantities[k].number == mode;
    if (is_wanted && !std::isnan(values(specimen, static_cast<Eigen::Index>(k)))) return true;
  }
  return false;
}

bool have_mostly_no_mass(const std::vector<MeasuredModes>& specimens) {
  int with = 0;
  int without = 0;
  for (const MeasuredModes& modes : specimens) {
    for (Eigen::Index mode = 0; mode < modes.shapes.cols(); ++mode) {
      if (modes.has_shape(mode)) ++(modes.is_scaled[static_cast<std::size_t>(mode)] ? with : without);
    }
  }
  return without > with;
}

}  // namespace

ShapeSize shape_size_of(Study& study) {
  const ShapeSize stated = study.outputs.shape_size;
  if (stated != ShapeSize::by_tests || study.outputs.shape_modes.empty() || !study.test) return stated;
  try {
    study.test->contents = std::make_shared<const TestContents>(read_test_files(study));
    return have_mostly_no_mass(study.test->contents->specimens) ? ShapeSize::free : stated;
  } catch (const InvalidInput&) {
    return stated;
  }
}

std::string free_size_note(const StructureModel& model, const Eigen::MatrixXd& measured, const TestData& tests) {
  std::vector<std::string> dropped;
  for (const Quantity& quantity : model.measured()) {
    if (std::ranges::find(model.outputs(), quantity) == model.outputs().end()) dropped.push_back(quantity.name());
  }
  std::vector<std::string> lost;
  for (Eigen::Index s = 0; s < measured.rows(); ++s) {
    for (const int mode : model.selection().shape_modes) {
      if (has_mode(model.measured(), measured, s, mode) && !has_mode(model.outputs(), tests.values, s, mode)) {
        lost.push_back(fmt::format("specimen {} mode {}", tests.number_of(s), mode));
      }
    }
  }
  std::string note = fmt::format(
      "The size of shapes is free for each mode and specimen: shapes of tests and of the model are compared after "
      "scaling to the same projection on those of the reference, and {} {} from the others and {} no output{}.",
      first_few(dropped), dropped.size() == 1 ? "follows" : "follow", dropped.size() == 1 ? "is" : "are",
      dropped.size() == 1 ? "" : "s");
  if (!lost.empty()) {
    note += fmt::format(
        " Left out are shapes that cannot be scaled alike, since they miss a component of outputs.shapes.dofs (they "
        "can be used without those dofs), are zero or nearly orthogonal to the reference's: {}.",
        first_few(lost));
  }
  return note;
}

}  // namespace mottle::study
