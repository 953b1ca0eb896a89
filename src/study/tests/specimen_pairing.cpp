#include "study/tests/specimen_pairing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <set>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/dynamics/modes/mac.hpp"
#include "mottle/fem/finite_element_model.hpp"

namespace mottle::study {
namespace {

constexpr double k_not_measured = std::numeric_limits<double>::quiet_NaN();
constexpr double k_sure_mac = 0.8;
constexpr double k_min_lead = 0.1;
constexpr double k_sure_collinearity = 0.9;
constexpr double k_alike_scale = 2.0;
constexpr double k_alike_frequency = 2.0;

/// Directions of the model's components at a node, which the file gives in the global frame.
Eigen::Matrix3d model_directions(const StructureModel& model, int node) {
  const FiniteElementModel* mesh = model.structure().mesh();
  const int index = mesh == nullptr ? -1 : mesh->find_node(node);
  if (index < 0) return Eigen::Matrix3d::Identity();
  const Node& point = mesh->nodes[static_cast<std::size_t>(index)];
  if (point.displacement_system < 0) return Eigen::Matrix3d::Identity();
  return mesh->coordinate_systems[static_cast<std::size_t>(point.displacement_system)].directions_at(point.position);
}

LinearCombination terms_of(const StructureModel& model, const MeasuredComponent& component) {
  constexpr double k_rounding = 1e-5;  // of axes written with six digits
  LinearCombination terms;
  if (!component.name.empty()) {
    const int slot = model.structure().find_degree_of_freedom(component.name);
    if (slot >= 0) terms.emplace_back(slot, component.sign);
    return terms;
  }
  const Eigen::Vector3d weights = model_directions(model, component.node).transpose() * component.direction;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(weights(axis)) < k_rounding) continue;
    const int slot = model.structure().find_degree_of_freedom(
        fmt::format("{}:+{}{}", component.node, component.is_rotation ? "R" : "", "XYZ"[axis]));
    if (slot < 0) return {};
    terms.emplace_back(slot, weights(axis));
  }
  return terms;
}

std::vector<Eigen::Index> measured_rows(const ShapeComparison& comparison, const MeasuredModes& modes,
                                        Eigen::Index mode) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index k = 0; k < modes.shapes.rows(); ++k) {
    if (!comparison.terms[static_cast<std::size_t>(k)].empty() && !std::isnan(modes.shapes(k, mode))) rows.push_back(k);
  }
  return rows;
}

/// Modes of the outputs, counted from 1, ascending.
std::set<int> output_modes(const StructureModel& model) {
  std::set<int> modes;
  for (int mode = 1; mode <= model.highest_mode(); ++mode) {
    if (model.is_output(mode - 1)) modes.insert(mode);
  }
  return modes;
}

/// Measured mode of each reference mode, counted from 0; absent: none.
std::map<int, Eigen::Index> assign_by_mac(const Eigen::MatrixXd& mac, double minimum) {
  const bool is_wide = mac.rows() <= mac.cols();
  const std::vector<int> pairs = optimal_assignment(is_wide ? mac : Eigen::MatrixXd(mac.transpose()));
  std::map<int, Eigen::Index> assigned;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const int reference = is_wide ? static_cast<int>(k) : pairs[k];
    const int test = is_wide ? pairs[k] : static_cast<int>(k);
    const double agreement = mac(reference, test);
    if (agreement >= minimum && agreement > 0.0) assigned.emplace(reference, test);
  }
  return assigned;
}

std::map<int, Eigen::Index> assign_by_order(const Eigen::VectorXd& frequencies, const std::set<int>& wanted) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(frequencies.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return frequencies(a) < frequencies(b); });
  std::map<int, Eigen::Index> assigned;
  auto next = order.begin();
  for (const int mode : wanted) {
    if (next != order.end()) assigned.emplace(mode - 1, *next++);
  }
  return assigned;
}

/// Largest entry of a vector but one.
double largest_other(const Eigen::VectorXd& values, Eigen::Index but) {
  double largest = 0.0;
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    if (k != but) largest = std::max(largest, values(k));
  }
  return largest;
}

}  // namespace

ShapeComparison compare_shapes(const StructureModel& model, const MeasuredModes& modes) {
  return compare_shapes(model, model.reference_modes().shapes, modes);
}

ShapeComparison compare_shapes(const StructureModel& model, const Eigen::Ref<const Eigen::MatrixXd>& shapes,
                               const MeasuredModes& modes) {
  ShapeComparison comparison;
  comparison.reference = Eigen::MatrixXd::Zero(modes.shapes.rows(), shapes.cols());
  for (Eigen::Index k = 0; k < modes.shapes.rows(); ++k) {
    comparison.terms.push_back(terms_of(model, modes.components[static_cast<std::size_t>(k)]));
    comparison.seen += comparison.terms.back().empty() ? 0 : 1;
    for (const auto& [slot, weight] : comparison.terms.back()) {
      comparison.reference.row(k) += weight * model.structure().displacements(shapes, {slot});
    }
  }
  comparison.cosines.resize(shapes.cols(), modes.shapes.cols());
  for (Eigen::Index t = 0; t < modes.shapes.cols(); ++t) {
    const std::vector<Eigen::Index> rows = measured_rows(comparison, modes, t);
    comparison.cosines.col(t) = shape_cosines(comparison.reference(rows, Eigen::all), modes.shapes(rows, t));
  }
  return comparison;
}

double total_mac(const StructureModel& model, const MeasuredModes& modes) {
  const Eigen::MatrixXd mac = compare_shapes(model, modes).cosines.cwiseAbs2();
  double total = 0.0;
  for (const auto& [reference, test] : assign_by_mac(mac, 0.0)) total += mac(reference, test);
  return total;
}

SpecimenPairing::SpecimenPairing(const StructureModel& model, const MeasuredModes& modes, bool by_mac)
    : model_(model), modes_(modes), comparison_(compare_shapes(model, modes)) {
  require(!by_mac || comparison_.seen > 0,
          "{}: none of its {} measured degrees of freedom is in the model, so its modes cannot be paired by shape",
          modes.file, modes.components.size());
  mac_ = comparison_.cosines.cwiseAbs2();
  assigned_ = by_mac ? assign_by_mac(mac_, model.selection().minimum_mac)
                     : assign_by_order(modes.frequencies, output_modes(model));
}

void SpecimenPairing::fill(Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>> row) const {
  std::map<int, double> scales;  // of the paired shapes
  for (const auto& [reference, test] : assigned_) scales[reference] = scale_of(reference, test);
  for (Eigen::Index k = 0; k < row.size(); ++k) {
    const Quantity& output = model_.measured()[static_cast<std::size_t>(k)];
    const auto pair = assigned_.find(output.number - 1);
    row(k) = pair == assigned_.end() ? k_not_measured : value_of(output, pair->second, scales[pair->first]);
  }
}

/// Why a pair should be checked by the user; empty: it is unambiguous.
std::string SpecimenPairing::doubt(int reference, Eigen::Index test) const {
  std::vector<std::string> doubts;
  if (comparison_.seen > 0 && mac_(reference, test) < k_sure_mac) {
    doubts.push_back(fmt::format("MAC {:.2f}", mac_(reference, test)));
  }
  if (comparison_.seen > 0 && second(reference, test) > mac_(reference, test) - k_min_lead) {
    doubts.push_back(fmt::format("another mode has MAC {:.2f}", second(reference, test)));
  }
  const double own = natural_frequency_hz(std::max(0.0, model_.reference_modes().eigenvalues(reference)), 1.0);
  const double ratio = modes_.frequencies(test) / own;
  if (ratio > k_alike_frequency || ratio < 1.0 / k_alike_frequency) {
    doubts.push_back(fmt::format("its frequency is {:.2g} times the model's", ratio));
  }
  if (modes_.collinearity(test) < k_sure_collinearity) {
    doubts.push_back(fmt::format("phase collinearity {:.2f}", modes_.collinearity(test)));
  }
  const bool is_used = !model_.selection().shape_modes.empty() && modes_.has_shape(test) && has_size(test);
  const double factor = is_used ? std::abs(fitted_scale(reference, test)) : 1.0;
  if (factor > k_alike_scale || factor < 1.0 / k_alike_scale) {
    doubts.push_back(fmt::format("it is {:.2g} times as large as the model's", 1.0 / factor));
  }
  return join(doubts, "; ");
}

std::vector<int> SpecimenPairing::modes_without_size() const {
  std::vector<int> modes;
  const std::vector<int>& wanted = model_.selection().shape_modes;
  for (const auto& [reference, test] : assigned_) {
    if (std::isnan(scale_of(reference, test)) && modes_.has_shape(test) &&
        std::ranges::count(wanted, reference + 1) > 0) {
      modes.push_back(reference + 1);
    }
  }
  return modes;
}

std::vector<PairingRow> SpecimenPairing::rows() const {
  std::vector<PairingRow> rows;
  std::set<Eigen::Index> used;
  for (const int mode : output_modes(model_)) {
    const auto pair = assigned_.find(mode - 1);
    if (pair == assigned_.end()) {
      rows.push_back({mode, -1, k_not_measured, k_not_measured, "missing"});
      continue;
    }
    const auto& [reference, test] = *pair;
    used.insert(test);
    const std::string doubts = doubt(reference, test);
    rows.push_back(
        {mode, test, mac_(reference, test), second(reference, test), doubts.empty() ? "paired" : "doubtful", doubts});
  }
  for (Eigen::Index test = 0; test < mac_.cols(); ++test) {
    if (used.contains(test)) continue;
    Eigen::Index best = 0;
    const double agreement = mac_.col(test).maxCoeff(&best);
    const int mode = static_cast<int>(best) + 1;
    const bool is_output = model_.is_output(std::min(mode, model_.highest_mode()) - 1) && mode <= model_.highest_mode();
    rows.push_back({mode, test, agreement, second(mode - 1, test), "left out",
                    is_output ? "it fits no mode well enough" : "nearest to a mode that is no output"});
  }
  return rows;
}

/// A quantity of one measured mode; nan: modes do not give it.
double SpecimenPairing::value_of(const Quantity& output, Eigen::Index test, double scale) const {
  switch (output.kind) {
    case QuantityKind::frequency:
      return modes_.frequencies(test);
    case QuantityKind::displacement:
    case QuantityKind::rotation:
      return scale * component(output.location, test);
    case QuantityKind::damping_ratio:
      return modes_.damping(test);
    case QuantityKind::eigenvalue:
      return std::pow(2.0 * std::numbers::pi * modes_.frequencies(test), 2);
    case QuantityKind::shape_ratio: {
      const double ratio = component(output.location, test) / component(output.denominator, test);
      return std::isfinite(ratio) ? ratio : k_not_measured;
    }
    default:
      return k_not_measured;
  }
}

/// The best MAC that either of the two has with another mode.
double SpecimenPairing::second(int reference, Eigen::Index test) const {
  return std::max(largest_other(mac_.row(reference), test), largest_other(mac_.col(test), reference));
}

/// Factor by which the measured shape is nearest to the reference's (least squares).
double SpecimenPairing::fitted_scale(int reference, Eigen::Index test) const {
  const std::vector<Eigen::Index> rows = measured_rows(comparison_, modes_, test);
  const Eigen::VectorXd shape = modes_.shapes(rows, test);
  return shape.dot(comparison_.reference(rows, reference)) / shape.squaredNorm();
}

/// Whether the size of a measured shape is data.
bool SpecimenPairing::has_size(Eigen::Index test) const {
  const ShapeSize stated = model_.selection().shape_size;
  return stated == ShapeSize::mass_normalised ||
         (stated == ShapeSize::by_tests && modes_.is_scaled[static_cast<std::size_t>(test)]);
}

double SpecimenPairing::scale_of(int reference, Eigen::Index test) const {
  if (model_.selection().shape_size == ShapeSize::free) return fitted_scale(reference, test);
  if (!has_size(test)) return k_not_measured;
  return comparison_.cosines(reference, test) < 0.0 ? -1.0 : 1.0;
}

/// Motion at one degree of freedom of the model, nan where the measured directions do not span it.
double SpecimenPairing::component(const std::string& name, Eigen::Index test) const {
  constexpr double k_rounding = 1e-4;
  const int wanted = model_.structure().find_degree_of_freedom(name);
  double value = 0.0;
  double span = 0.0;
  for (std::size_t k = 0; k < comparison_.terms.size(); ++k) {
    const double measured = modes_.shapes(static_cast<Eigen::Index>(k), test);
    for (const auto& [slot, weight] : comparison_.terms[k]) {
      if (slot != wanted || std::isnan(measured)) continue;
      value += weight * measured;
      span += weight * weight;
    }
  }
  return std::abs(span - 1.0) < k_rounding ? value : k_not_measured;
}

}  // namespace mottle::study
