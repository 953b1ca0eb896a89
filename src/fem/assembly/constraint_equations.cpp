#include "fem/assembly/constraint_equations.hpp"

#include <Eigen/LU>
#include <Eigen/SparseCore>
#include <cmath>

#include "fem/assembly/rigid_motion.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

using Rigid = Eigen::Matrix<double, 6, 6>;

bool has(Components components, int component) {
  return ((components >> component) & 1) != 0;
}

/// Displacement components of `node` (rows) for a rigid motion given at `origin` (columns: three translations, three
/// rotations, basic).
Rigid rigid_motion_of_node(const FiniteElementModel& model, int node, const Eigen::Vector3d& origin) {
  return fem::rigid_motion(displacement_directions(model, node),
                           model.nodes[static_cast<std::size_t>(node)].position - origin);
}

const Eigen::Vector3d& position(const FiniteElementModel& model, int node) {
  return model.nodes[static_cast<std::size_t>(node)].position;
}

/// row . (components of the independent ones) with what is zero by geometry left out.
void add_terms(DependentDegreeOfFreedom& equation, int node, const Eigen::Ref<const Eigen::RowVectorXd>& row,
               double scale) {
  constexpr double k_nothing = 1e-14;
  for (int c = 0; c < 6; ++c) {
    if (std::abs(row(c)) > k_nothing * scale) equation.terms.push_back({degree_of_freedom(node, c), row(c)});
  }
}

void add_rigid_body(const FiniteElementModel& model, const RigidBody& body,
                    std::vector<DependentDegreeOfFreedom>& equations) {
  const Eigen::Vector3d& origin = position(model, body.independent);
  // Motion of the body in basic coordinates from the independent node's own components.
  const Eigen::Matrix3d own = displacement_directions(model, body.independent);
  Rigid to_basic = Rigid::Zero();
  to_basic.topLeftCorner<3, 3>() = own;
  to_basic.bottomRightCorner<3, 3>() = own;
  for (const int node : body.dependents) {
    const Rigid motion = rigid_motion_of_node(model, node, origin) * to_basic;
    for (int c = 0; c < 6; ++c) {
      if (!has(body.components, c)) continue;
      DependentDegreeOfFreedom equation{degree_of_freedom(node, c), {}, fmt::format("RBE2 {}", body.id)};
      add_terms(equation, body.independent, motion.row(c), motion.row(c).norm());
      equations.push_back(std::move(equation));
    }
  }
}

void add_rigid_bar(const FiniteElementModel& model, const RigidBar& bar,
                   std::vector<DependentDegreeOfFreedom>& equations) {
  const Eigen::Vector3d& origin = position(model, bar.nodes[0]);
  const Rigid motions[2] = {rigid_motion_of_node(model, bar.nodes[0], origin),
                            rigid_motion_of_node(model, bar.nodes[1], origin)};
  Rigid independent = Rigid::Zero();
  std::vector<int> columns;
  for (int end = 0; end < 2; ++end) {
    for (int c = 0; c < 6; ++c) {
      if (!has(bar.independent[static_cast<std::size_t>(end)], c)) continue;
      if (columns.size() < 6) independent.row(static_cast<Eigen::Index>(columns.size())) = motions[end].row(c);
      columns.push_back(degree_of_freedom(bar.nodes[static_cast<std::size_t>(end)], c));
    }
  }
  const Eigen::FullPivLU<Rigid> inverse(independent);
  require(columns.size() == 6 && inverse.isInvertible(),
          "RBAR {}: its {} independent components do not fix the motion of a rigid body; six that do are needed",
          bar.id, columns.size());
  const Rigid motion_of = inverse.inverse();
  for (std::size_t end = 0; end < 2; ++end) {
    for (int c = 0; c < 6; ++c) {
      if (!has(bar.dependent[end], c)) continue;
      DependentDegreeOfFreedom equation{degree_of_freedom(bar.nodes[end], c), {}, fmt::format("RBAR {}", bar.id)};
      const Eigen::RowVectorXd row = motions[end].row(c) * motion_of;
      for (Eigen::Index k = 0; k < 6; ++k) {
        if (std::abs(row(k)) > 1e-14 * row.norm()) {
          equation.terms.push_back({columns[static_cast<std::size_t>(k)], row(k)});
        }
      }
      equations.push_back(std::move(equation));
    }
  }
}

/// The reference moves as the rigid motion that fits the sources best in weighted least squares. Rotations of sources
/// count with the squared mean distance of the sources, so that the fit does not depend on the unit of length.
void add_interpolation(const FiniteElementModel& model, const Interpolation& element,
                       std::vector<DependentDegreeOfFreedom>& equations) {
  const Eigen::Vector3d& origin = position(model, element.reference);
  double total = 0.0;
  double distance = 0.0;
  for (const auto& source : element.sources) {
    total += source.weight;
    distance += source.weight * (position(model, source.node) - origin).norm();
  }
  const double length = total > 0.0 && distance > 0.0 ? distance / total : 1.0;
  Rigid normal = Rigid::Zero();
  for (const auto& source : element.sources) {
    const Rigid motion = rigid_motion_of_node(model, source.node, origin);
    for (int c = 0; c < 6; ++c) {
      if (!has(source.components, c)) continue;
      const double weight = source.weight * (c < 3 ? 1.0 : length * length);
      normal += weight * motion.row(c).transpose() * motion.row(c);
    }
  }
  Rigid scale = Rigid::Identity();
  scale.bottomRightCorner<3, 3>() /= length;
  const Rigid scaled = scale * normal * scale;
  Eigen::FullPivLU<Rigid> inverse(scaled);
  inverse.setThreshold(1e-10);
  require(inverse.isInvertible(),
          "RBE3 {}: its sources do not determine a rigid-body motion; give more of them or more components",
          element.id);
  const Rigid fit = scale * inverse.inverse() * scale;
  const Rigid reference = rigid_motion_of_node(model, element.reference, origin);
  for (int c = 0; c < 6; ++c) {
    if (!has(element.reference_components, c)) continue;
    DependentDegreeOfFreedom equation{degree_of_freedom(element.reference, c), {}, fmt::format("RBE3 {}", element.id)};
    const Eigen::RowVectorXd row = reference.row(c) * fit;
    for (const auto& source : element.sources) {
      const Rigid motion = rigid_motion_of_node(model, source.node, origin);
      for (int k = 0; k < 6; ++k) {
        if (!has(source.components, k)) continue;
        const double weight = source.weight * (k < 3 ? 1.0 : length * length);
        const double coefficient = weight * row.dot(motion.row(k));
        if (std::abs(coefficient) > 1e-14) equation.terms.push_back({degree_of_freedom(source.node, k), coefficient});
      }
    }
    equations.push_back(std::move(equation));
  }
}

/// Solves an RBE3 with UM for those of its unknowns that UM names instead of the reference components.
void exchange_dependents(const Interpolation& element, std::vector<DependentDegreeOfFreedom>& equations,
                         std::size_t first) {
  std::vector<int> wanted;
  for (const auto& [node, components] : element.dependents) {
    for (int c = 0; c < 6; ++c) {
      if (has(components, c)) wanted.push_back(degree_of_freedom(node, c));
    }
  }
  const std::size_t count = equations.size() - first;
  require(wanted.size() == count, "RBE3 {}: UM names {} components, the reference has {}; the numbers must agree",
          element.id, wanted.size(), count);
  // Rows: 0 = -u_dependent + sum of terms. Gauss-Jordan on the wanted columns.
  std::vector<int> columns = wanted;
  const auto column_of = [&columns](int dof) {
    for (std::size_t k = 0; k < columns.size(); ++k) {
      if (columns[k] == dof) return static_cast<Eigen::Index>(k);
    }
    columns.push_back(dof);
    return static_cast<Eigen::Index>(columns.size() - 1);
  };
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t r = 0; r < count; ++r) {
    const auto row = static_cast<int>(r);
    entries.emplace_back(row, static_cast<int>(column_of(equations[first + r].degree_of_freedom)), -1.0);
    for (const auto& term : equations[first + r].terms) {
      entries.emplace_back(row, static_cast<int>(column_of(term.degree_of_freedom)), term.coefficient);
    }
  }
  Eigen::MatrixXd rows =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(columns.size()));
  for (const auto& entry : entries) rows(entry.row(), entry.col()) += entry.value();
  const auto n = static_cast<Eigen::Index>(count);
  const Eigen::FullPivLU<Eigen::MatrixXd> inverse(rows.leftCols(n));
  require(inverse.isInvertible(), "RBE3 {}: the components of UM cannot be the dependent ones", element.id);
  const Eigen::MatrixXd solved = -inverse.solve(rows.rightCols(rows.cols() - n));
  equations.resize(first);
  for (Eigen::Index r = 0; r < n; ++r) {
    DependentDegreeOfFreedom equation{wanted[static_cast<std::size_t>(r)], {}, fmt::format("RBE3 {}", element.id)};
    for (Eigen::Index k = 0; k < solved.cols(); ++k) {
      if (std::abs(solved(r, k)) > 1e-14) {
        equation.terms.push_back({columns[static_cast<std::size_t>(n + k)], solved(r, k)});
      }
    }
    equations.push_back(std::move(equation));
  }
}

void add_multipoint_equation(const FiniteElementModel& model, const MultipointEquation& given,
                             std::vector<DependentDegreeOfFreedom>& equations) {
  const auto& first = given.terms.front();
  const int id = model.nodes[static_cast<std::size_t>(first.node)].id;
  require(first.coefficient != 0.0, "MPC: the first coefficient (grid {}, component {}) is zero; it must not be", id,
          first.component + 1);
  DependentDegreeOfFreedom equation{
      degree_of_freedom(first.node, first.component), {}, fmt::format("MPC of grid {}", id)};
  for (std::size_t k = 1; k < given.terms.size(); ++k) {
    const auto& term = given.terms[k];
    equation.terms.push_back({degree_of_freedom(term.node, term.component), -term.coefficient / first.coefficient});
  }
  equations.push_back(std::move(equation));
}

}  // namespace

Eigen::Matrix3d displacement_directions(const FiniteElementModel& model, int node) {
  const Node& point = model.nodes[static_cast<std::size_t>(node)];
  if (point.displacement_system < 0) return Eigen::Matrix3d::Identity();
  return model.coordinate_systems[static_cast<std::size_t>(point.displacement_system)].directions_at(point.position);
}

std::vector<DependentDegreeOfFreedom> dependent_degrees_of_freedom(const FiniteElementModel& model) {
  std::vector<DependentDegreeOfFreedom> equations;
  for (const RigidBody& body : model.rigid_bodies) add_rigid_body(model, body, equations);
  for (const RigidBar& bar : model.rigid_bars) add_rigid_bar(model, bar, equations);
  for (const Interpolation& element : model.interpolations) {
    const std::size_t first = equations.size();
    add_interpolation(model, element, equations);
    if (!element.dependents.empty()) exchange_dependents(element, equations, first);
  }
  for (const MultipointEquation& given : model.multipoint_equations) add_multipoint_equation(model, given, equations);
  return equations;
}

}  // namespace mottle::fem
