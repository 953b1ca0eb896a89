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

/// Modes of the outputs, counted from 1, ascending.
std::set<int> output_modes(const StructureModel& model) {
  std::set<int> modes;
  for (int mode = 1; mode <= model.highest_mode(); ++mode) {
    if (model.is_output(mode - 1)) modes.insert(mode);
  }
  return modes;
}

/// Measured mode of each reference mode, counted from 0, by the largest sum of MAC; absent: none.
std::map<int, Eigen::Index> assign_by_mac(const Eigen::MatrixXd& mac) {
  const bool is_wide = mac.rows() <= mac.cols();
  const std::vector<int> pairs = optimal_assignment(is_wide ? mac : Eigen::MatrixXd(mac.transpose()));
  std::map<int, Eigen::Index> assigned;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const int reference = is_wide ? static_cast<int>(k) : pairs[k];
    const int test = is_wide ? pairs[k] : static_cast<int>(k);
    if (mac(reference, test) > 0.0) assigned.emplace(reference, test);
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

/// ", 0.98 together with mode 6, which is close in frequency".
std::string together_text(const CloseModes& close) {
  std::vector<std::string> others;
  for (auto mode = close.modes.begin() + 1; mode != close.modes.end(); ++mode)
    others.push_back(fmt::format("{}", *mode + 1));
  return fmt::format(", {:.2f} together with mode {}, which is close in frequency", close.mac, join(others));
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

double total_mac(const StructureModel& model, const MeasuredModes& modes) {
  const Eigen::MatrixXd mac = compare_shapes(model, modes).cosines.cwiseAbs2();
  double total = 0.0;
  for (const auto& [reference, test] : assign_by_mac(mac)) total += mac(reference, test);
  return total;
}

SpecimenPairing::SpecimenPairing(const StructureModel& model, const MeasuredModes& modes, bool by_mac)
    : model_(model), modes_(modes), comparison_(compare_shapes(model, modes)) {
  require(!by_mac || comparison_.seen > 0,
          "{}: none of its {} measured degrees of freedom is in the model, so its modes cannot be paired by shape",
          modes.file, modes.components.size());
  mac_ = comparison_.cosines.cwiseAbs2();
  assigned_ = by_mac ? assign_by_mac(mac_) : assign_by_order(modes.frequencies, output_modes(model));
  if (by_mac) leave_out_unlike();
}

/// Pairs that are too unlike, alone and together with the modes that they have mixed with, are none.
void SpecimenPairing::leave_out_unlike() {
  const Eigen::VectorXd frequencies = natural_frequencies_hz(model_.reference_modes().eigenvalues.cwiseMax(0.0));
  const std::map<int, Eigen::Index> pairs = assigned_;
  const double minimum = model_.selection().minimum_mac;
  const Eigen::MatrixXd own = known_reference();
  for (const auto& [reference, test] : pairs) {
    if (mac_(reference, test) >= minimum) continue;
    CloseModes close = close_modes(reference, pairs, {own, frequencies}, {modes_.shapes, modes_.frequencies});
    if (close.mac < std::max(minimum, k_sure_mac)) {
      assigned_.erase(reference);
    } else {
      mixed_[reference] = std::move(close);
    }
  }
}

/// The reference's shapes, nan where the model has no such component.
Eigen::MatrixXd SpecimenPairing::known_reference() const {
  Eigen::MatrixXd known = comparison_.reference;
  for (std::size_t k = 0; k < comparison_.terms.size(); ++k) {
    if (comparison_.terms[k].empty()) known.row(static_cast<Eigen::Index>(k)).setConstant(k_not_measured);
  }
  return known;
}

std::vector<ComparedShape> SpecimenPairing::compared_shapes() const {
  std::vector<ComparedShape> shapes;
  const Eigen::MatrixXd own = known_reference();
  for (const auto& [reference, test] : assigned_)
    shapes.push_back({reference + 1, modes_.shapes.col(test), own.col(reference)});
  return shapes;
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
    const auto mixed = mixed_.find(reference);
    doubts.push_back(
        fmt::format("MAC {:.2f}{}", mac_(reference, test), mixed == mixed_.end() ? "" : together_text(mixed->second)));
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
  const std::vector<Eigen::Index> rows = comparison_.measured_rows(modes_, test);
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
