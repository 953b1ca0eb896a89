// Reader of [outputs], and of the outputs of [predict].
#include "mottle/study/models/model_source.hpp"
#include "study/input/study_sections.hpp"

namespace mottle::study {
namespace {

std::vector<ShapeRatio> read_shape_ratios(TomlReader& reader) {
  std::vector<ShapeRatio> ratios;
  for (TomlReader& entry : reader.tables("shape_ratios")) {
    const int mode = static_cast<int>(entry.integer_or("mode", 0, {.lower = 1.0, .upper = 1e6}));
    if (mode == 0) entry.fail("mode", "is missing; give the number of the mode");
    const std::vector<std::string> dofs = entry.texts("dofs");
    if (dofs.size() != 2 || dofs[0] == dofs[1]) {
      entry.fail_value("dofs", "two different degrees of freedom: the first is divided by the second");
    }
    entry.finish();
    ratios.push_back({mode, dofs[0], dofs[1]});
  }
  return ratios;
}

}  // namespace

OutputSelection read_outputs(TomlReader reader, const ModelSource& model) {
  OutputSelection outputs;
  outputs.frequencies = reader.mode_numbers("frequencies");
  outputs.damping = reader.mode_numbers("damping");
  if (reader.has("shapes")) {
    TomlReader shapes = reader.table("shapes");
    outputs.shape_modes = shapes.mode_numbers("modes");
    if (outputs.shape_modes.empty()) shapes.fail_value("modes", "a list of mode numbers >= 1, like [1, 2, 3]");
    outputs.shape_degrees_of_freedom = shapes.texts("dofs");
    outputs.shape_size =
        std::vector{ShapeSize::by_tests, ShapeSize::mass_normalised,
                    ShapeSize::free}[shapes.choice("size", {"by-tests", "mass-normalised", "free"}, 0)];
    shapes.finish();
  } else {
    reader.raw("shapes");
  }
  constexpr double k_max_force = 1e100;  // beyond, squares of displacements are no numbers
  for (TomlReader& load : reader.tables("static")) {
    outputs.static_loads.push_back({load.number_map("forces", {-k_max_force, k_max_force}), load.texts("dofs")});
    load.finish();
  }
  outputs.eigenvalues = reader.mode_numbers("eigenvalues");
  outputs.shape_ratios = read_shape_ratios(reader);
  const std::size_t usual = model.tracks_by_mac() ? 1 : 0;
  outputs.tracking =
      std::vector{ModeTracking::order, ModeTracking::mac}[reader.choice("tracking", {"order", "mac"}, usual)];
  if (!model.gives_shapes() && outputs.tracking == ModeTracking::mac) {
    reader.fail("tracking",
                "\"mac\" compares shapes, and the model gives none; say in [model.shapes] where they stand");
  }
  outputs.minimum_mac = reader.number_or("minimum_mac", outputs.minimum_mac, {.lower = 0.0, .upper = 1.0});
  reader.finish();
  return outputs;
}

}  // namespace mottle::study
