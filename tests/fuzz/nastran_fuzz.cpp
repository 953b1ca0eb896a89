// libFuzzer target for formats/nastran: whatever the bytes, a deck is refused with InvalidInput or gives a model whose
// indices, axes and numbers hold what the headers promise. A line "$FILE" begins the next included file: INCLUDE 1
// names the first one behind it. Seeds: tests/formats/nastran.
#include <Eigen/LU>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/formats/nastran/model.hpp"

namespace {

using namespace mottle;
using namespace mottle::formats;

void expect(bool claim) {
  if (!claim) std::abort();
}

bool is_index(int index, std::size_t count) {
  return index >= 0 && static_cast<std::size_t>(index) < count;
}

bool is_index_or_none(int index, std::size_t count) {
  return index == -1 || is_index(index, count);
}

bool is_rotation(const Eigen::Matrix3d& axes) {
  return axes.allFinite() && (axes.transpose() * axes - Eigen::Matrix3d::Identity()).norm() < 1e-6 &&
         axes.determinant() > 0.0;
}

void check_deck(const NastranDeck& deck) {
  for (const BulkCard& card : deck.cards) {
    expect(!card.name.empty() && is_index(card.file, deck.files.size()) && card.line > 0);
    expect(card.fields.empty() || !card.fields.back().empty());
  }
  for (const CaseCommand& command : deck.case_control) {
    expect(is_index_or_none(command.subcase, deck.subcases.size()));
  }
}

void check_points(const FiniteElementModel& model) {
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    const Node& node = model.nodes[i];
    expect(node.id > (i == 0 ? 0 : model.nodes[i - 1].id));
    expect(node.position.allFinite());
    expect(is_index_or_none(node.displacement_system, model.coordinate_systems.size()));
    expect(model.find_node(node.id) == static_cast<int>(i));
  }
  for (const CoordinateSystem& system : model.coordinate_systems) {
    expect(is_rotation(system.axes) && system.origin.allFinite());
  }
  for (const auto& [node, components] : model.fixed) expect(is_index(node, model.nodes.size()) && components != 0);
  expect(is_index_or_none(model.settings.reference_node, model.nodes.size()));
}

class Checker {
 public:
  explicit Checker(const FiniteElementModel& model) : model_(model) {}

  void check_numbers() const {
    for (const CardField& known : model_.fields) expect(std::isfinite(known.value) && !known.card.empty());
    for (const Material& m : model_.materials) fields({m.young, m.shear, m.poisson, m.density});
    for (const ShellProperty& p : model_.shell_properties) {
      fields({p.thickness, p.nonstructural_mass});
      materials({p.membrane_material, p.bending_material, p.shear_material});
    }
    for (const BeamProperty& p : model_.beam_properties) {
      fields({p.area, p.inertia_1, p.inertia_2, p.inertia_12, p.torsion, p.nonstructural_mass});
      for (const FieldIndex dimension : p.dimensions) expect(is_index(dimension, model_.fields.size()));
      expect(is_index(p.material, model_.materials.size()));
    }
  }

  void check_elements() const {
    constexpr std::size_t k_corners[] = {8, 6, 4, 10};
    for (const SolidElement& e : model_.elements<SolidElement>()) {
      for (std::size_t i = 0; i < k_corners[static_cast<int>(e.shape)]; ++i) grid(e.nodes[i]);
      expect(is_index(e.material, model_.materials.size()));
    }
    for (const ShellElement& e : model_.elements<ShellElement>()) {
      for (int i = 0; i < e.node_count; ++i) grid(e.nodes[static_cast<std::size_t>(i)]);
      expect(is_index(e.property, model_.shell_properties.size()) && std::isfinite(e.offset));
      const FieldIndex own = e.thickness;
      const FieldIndex used =
          own != k_no_field ? own : model_.shell_properties[static_cast<std::size_t>(e.property)].thickness;
      expect(used != k_no_field && model_.value(used) > 0.0);
    }
    for (const RodElement& e : model_.elements<RodElement>()) {
      for (const int node : e.nodes) grid(node);
      fields({e.area, e.torsion, e.nonstructural_mass});
      expect(is_index(e.material, model_.materials.size()));
    }
    for (const BeamElement& e : model_.elements<BeamElement>()) {
      for (const int node : e.nodes) grid(node);
      expect(is_index(e.property, model_.beam_properties.size()));
      expect(e.orientation.allFinite() && e.offsets[0].allFinite() && e.offsets[1].allFinite());
      expect(e.orientation.norm() > 0.0);
    }
  }

  void check_points_and_links() const {
    for (const ScalarElement& e : model_.elements<ScalarElement>()) {
      expect(is_index(e.nodes[0], model_.nodes.size()) && is_index_or_none(e.nodes[1], model_.nodes.size()));
      for (const int component : e.components) expect(component >= 0 && component < 6);
      fields({e.value});
    }
    for (const BushElement& e : model_.elements<BushElement>()) {
      grid(e.nodes[0]);
      expect(is_index_or_none(e.nodes[1], model_.nodes.size()) && is_rotation(e.axes) && e.location.allFinite());
    }
    for (const PointMassElement& e : model_.elements<PointMassElement>()) {
      grid(e.node);
      fields({e.mass});
      expect(is_rotation(e.axes) && e.offset.allFinite() && (e.matrix.empty() || e.matrix.size() == 21));
    }
    for (const RigidBody& e : model_.rigid_bodies) {
      grid(e.independent);
      expect(e.components != 0 && !e.dependents.empty());
      for (const int node : e.dependents) grid(node);
    }
    for (const RigidBar& e : model_.rigid_bars) {
      for (const int node : e.nodes) grid(node);
    }
    for (const Interpolation& e : model_.interpolations) {
      grid(e.reference);
      expect(!e.sources.empty());
      for (const auto& source : e.sources) grid(source.node);
    }
    for (const MultipointEquation& e : model_.multipoint_equations) {
      expect(!e.terms.empty() && e.terms[0].coefficient != 0.0);
      for (const auto& term : e.terms) expect(is_index(term.node, model_.nodes.size()));
    }
  }

 private:
  void fields(std::initializer_list<FieldIndex> indices) const {
    for (const FieldIndex index : indices) expect(is_index_or_none(index, model_.fields.size()));
  }
  void materials(std::initializer_list<int> indices) const {
    for (const int index : indices) expect(is_index_or_none(index, model_.materials.size()));
  }
  void grid(int node) const {
    expect(is_index(node, model_.nodes.size()) && !model_.nodes[static_cast<std::size_t>(node)].is_scalar);
  }

  const FiniteElementModel& model_;
};

/// A million scalar points by one card are allowed, but take the time of a thousand other inputs.
bool has_wide_range(const NastranDeck& deck) {
  for (const BulkCard& card : deck.cards) {
    const bool is_range = card.name == "SPOINT" && card.fields.size() >= 3 && card.fields[1] == "THRU";
    if (is_range && card.fields[2].size() > 4) return true;
  }
  return false;
}

std::vector<std::string> files_of(std::string_view bytes) {
  constexpr std::string_view k_border = "$FILE\n";
  std::vector<std::string> files;
  for (std::size_t border = bytes.find(k_border); border != std::string_view::npos; border = bytes.find(k_border)) {
    files.emplace_back(bytes.substr(0, border));
    bytes.remove_prefix(border + k_border.size());
  }
  files.emplace_back(bytes);
  return files;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::vector<std::string> files = files_of({reinterpret_cast<const char*>(data), size});
  std::size_t budget = 200000;  // bytes by all includes, so that one input does not take the time of many
  const auto resolve = [&](const std::string& written, const std::string&) -> std::optional<IncludedFile> {
    const std::size_t file = written.size() == 1 ? static_cast<std::size_t>(written[0] - '0') : files.size();
    if (file >= files.size() || budget < files[file].size()) return std::nullopt;
    budget -= files[file].size();
    return IncludedFile{written, files[file]};
  };
  try {
    const NastranDeck deck = parse_nastran_deck(files[0], "0", resolve);
    check_deck(deck);
    if (has_wide_range(deck)) return 0;
    const NastranModel read = build_nastran_model(deck);
    check_points(read.model);
    const Checker checker(read.model);
    checker.check_numbers();
    checker.check_elements();
    checker.check_points_and_links();
  } catch (const InvalidInput& error) {
    expect(std::string_view(error.what()).size() < 4096);
  }
  return 0;
}
