#include "mottle/fem/assembly/field_energies.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "fem/assembly/constraint_equations.hpp"
#include "fem/elements/element_pieces.hpp"

namespace mottle::fem {
namespace {

/// Displacements in basic axes, by threes, of the same rows as in the nodes' own.
Eigen::MatrixXd in_basic_axes(const FiniteElementModel& model, const Eigen::MatrixXd& displacements) {
  Eigen::MatrixXd basic = displacements;
  for (std::size_t node = 0; node < model.nodes.size(); ++node) {
    if (model.nodes[node].displacement_system < 0) continue;
    const Eigen::Matrix3d axes = displacement_directions(model, static_cast<int>(node));
    for (Eigen::Index row = degree_of_freedom(static_cast<int>(node), 0), end = row + 6; row < end; row += 3) {
      basic.middleRows<3>(row) = (axes * displacements.middleRows<3>(row)).eval();
    }
  }
  return basic;
}

/// u' A u / 2 of each piece of an element, at the card's values [piece x mode].
class PieceEnergies {
 public:
  PieceEnergies(const FiniteElementModel& model, const Eigen::MatrixXd& displacements)
      : own_(displacements), basic_(in_basic_axes(model, displacements)) {}

  Eigen::MatrixXd of(const FiniteElementModel& model, const ElementPieces& element) const {
    const Eigen::MatrixXd motion = (element.is_basic ? basic_ : own_)(element.degrees_of_freedom, Eigen::all);
    Eigen::MatrixXd energies(static_cast<Eigen::Index>(element.pieces.size()), motion.cols());
    for (Eigen::Index k = 0; k < energies.rows(); ++k) {
      const ElementPiece& piece = element.pieces[static_cast<std::size_t>(k)];
      double factor = 0.5 * piece.factor;
      for (const FieldPower& power : piece.coefficient) factor *= std::pow(model.value(power.field), power.power);
      energies.row(k) = factor * motion.cwiseProduct(piece.matrix * motion).colwise().sum();
    }
    return energies;
  }

 private:
  Eigen::MatrixXd own_, basic_;
};

/// Stiffness and mass pieces summed [2 x mode].
Eigen::MatrixXd sums_by_kind(const ElementPieces& element, const Eigen::MatrixXd& energies) {
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(2, energies.cols());
  for (Eigen::Index k = 0; k < energies.rows(); ++k) {
    const ElementPiece::Kind kind = element.pieces[static_cast<std::size_t>(k)].kind;
    if (kind != ElementPiece::Kind::damping) sums.row(kind == ElementPiece::Kind::mass ? 1 : 0) += energies.row(k);
  }
  return sums;
}

/// Fields that an element uses, sorted by what depends on them.
struct UsedFields {
  std::set<FieldIndex> any = {}, stiffness = {}, mass = {};
  std::set<FieldIndex> matrix = {};  ///< on which a matrix of the element depends otherwise than by a power
};

UsedFields fields_of(const ElementPieces& element) {
  UsedFields used;
  for (const ElementPiece& piece : element.pieces) {
    std::set<FieldIndex> here;
    for (const FieldPower& power : piece.coefficient) here.insert(power.field);
    for (const FieldIndex field : piece.matrix_fields) {
      if (field == k_no_field) continue;
      here.insert(field);
      used.matrix.insert(field);
    }
    used.any.insert(here.begin(), here.end());
    if (piece.kind == ElementPiece::Kind::stiffness) used.stiffness.insert(here.begin(), here.end());
    if (piece.kind == ElementPiece::Kind::mass) used.mass.insert(here.begin(), here.end());
  }
  return used;
}

/// Groups of matrix fields no two of which an element uses, in whatever way: all of a group are moved at once.
class FieldGroups {
 public:
  explicit FieldGroups(std::size_t fields) : meets_(fields), is_there_(fields, false) {}

  void add(const UsedFields& used) {
    for (const FieldIndex field : used.matrix) {
      is_there_[static_cast<std::size_t>(field)] = true;
      for (const FieldIndex other : used.any) {
        meets_[static_cast<std::size_t>(field)].insert(other);
        meets_[static_cast<std::size_t>(other)].insert(field);
      }
    }
  }

  std::vector<std::vector<FieldIndex>> groups() const {
    std::vector<std::vector<FieldIndex>> groups;
    for (std::size_t field = 0; field < meets_.size(); ++field) {
      if (!is_there_[field]) continue;
      const auto fits = [&](const std::vector<FieldIndex>& group) {
        return std::ranges::none_of(group, [&](FieldIndex other) { return meets_[field].contains(other); });
      };
      const auto group = std::ranges::find_if(groups, fits);
      if (group == groups.end()) {
        groups.push_back({static_cast<FieldIndex>(field)});
      } else {
        group->push_back(static_cast<FieldIndex>(field));
      }
    }
    return groups;
  }

 private:
  std::vector<std::set<FieldIndex>> meets_;
  std::vector<bool> is_there_;
};

void add_element(const FiniteElementModel& model, const ElementPieces& element, const Eigen::MatrixXd& energies,
                 FieldEnergies& found) {
  const UsedFields used = fields_of(element);
  const Eigen::MatrixXd sums = sums_by_kind(element, energies);
  found.total_strain += sums.row(0);
  found.total_kinetic += sums.row(1);
  for (const FieldIndex field : used.any) ++found.elements(field);
  for (const FieldIndex field : used.stiffness) found.strain.row(field) += sums.row(0);
  for (const FieldIndex field : used.mass) found.kinetic.row(field) += sums.row(1);
  for (Eigen::Index k = 0; k < energies.rows(); ++k) {
    const ElementPiece& piece = element.pieces[static_cast<std::size_t>(k)];
    if (piece.kind == ElementPiece::Kind::damping) continue;
    Eigen::MatrixXd& derivative =
        piece.kind == ElementPiece::Kind::mass ? found.kinetic_derivative : found.strain_derivative;
    for (const FieldPower& power : piece.coefficient) {
      if (used.matrix.contains(power.field) || model.value(power.field) == 0.0) continue;
      derivative.row(power.field) += power.power * energies.row(k);
    }
  }
}

/// Adds `weight` times the energies of the elements that use a field of the group, all of its fields scaled.
void add_moved(const FiniteElementModel& model, const PieceEnergies& pieces, const std::vector<FieldIndex>& group,
               double scale, double weight, FieldEnergies& found) {
  FiniteElementModel moved = model;
  for (const FieldIndex field : group) moved.fields[static_cast<std::size_t>(field)].value *= scale;
  visit_elements(moved, PieceSelection::all, [&](ElementPieces& element) {
    const UsedFields used = fields_of(element);
    for (const FieldIndex field : group) {
      if (!used.matrix.contains(field)) continue;
      const Eigen::MatrixXd sums = sums_by_kind(element, pieces.of(moved, element));
      found.strain_derivative.row(field) += weight * sums.row(0);
      found.kinetic_derivative.row(field) += weight * sums.row(1);
    }
  });
}

}  // namespace

FieldEnergies field_energies(const FiniteElementModel& model, const Eigen::MatrixXd& displacements) {
  constexpr double k_step = 1e-4;  // error of h^2 = 1e-8 relative, rounding of eps / h = 2e-12
  const auto fields = static_cast<Eigen::Index>(model.fields.size());
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(fields, displacements.cols());
  const Eigen::RowVectorXd zero = Eigen::RowVectorXd::Zero(displacements.cols());
  FieldEnergies found{Eigen::VectorXi::Zero(fields), none, none, none, none, zero, zero};
  const PieceEnergies pieces(model, displacements);
  FieldGroups groups(model.fields.size());
  visit_elements(model, PieceSelection::all, [&](ElementPieces& element) {
    groups.add(fields_of(element));
    add_element(model, element, pieces.of(model, element), found);
  });
  for (const std::vector<FieldIndex>& group : groups.groups()) {
    add_moved(model, pieces, group, 1.0 + k_step, 0.5 / k_step, found);
    add_moved(model, pieces, group, 1.0 - k_step, -0.5 / k_step, found);
  }
  return found;
}

}  // namespace mottle::fem
