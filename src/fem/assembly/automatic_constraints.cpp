#include "fem/assembly/automatic_constraints.hpp"

#include <algorithm>
#include <array>

#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::fem {
namespace {

/// Stiffness of each node's translations and rotations among themselves, at the card's values.
std::vector<std::array<Eigen::Matrix3d, 2>> nodal_stiffness(const ElementStore& store, const EquationMap& map,
                                                            std::size_t nodes) {
  std::vector<std::array<Eigen::Matrix3d, 2>> blocks(nodes, {Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero()});
  const std::vector<Equation>& equations = map.equations();
  for (const StoredElement& element : store.elements()) {
    const int* numbers = store.equations(element);
    for (int k = 0; k < element.piece_count; ++k) {
      const StoredPiece& piece = store.piece(element, k);
      if (store.terms()[static_cast<std::size_t>(piece.term)].kind != ElementPiece::Kind::stiffness) continue;
      each_entry(element.equation_count, [&](std::size_t position, int i, int j) {
        const Equation& row = equations[static_cast<std::size_t>(numbers[i])];
        const Equation& column = equations[static_cast<std::size_t>(numbers[j])];
        if (row.node != column.node || row.component / 3 != column.component / 3) return;
        Eigen::Matrix3d& block =
            blocks[static_cast<std::size_t>(row.node)][static_cast<std::size_t>(row.component / 3)];
        const double value = piece.at_card_values * piece.values[position];
        block(row.component % 3, column.component % 3) += value;
        if (i != j) block(column.component % 3, row.component % 3) += value;
      });
    }
  }
  return blocks;
}

/// Components of a 3 x 3 block without stiffness: for each soft direction the component nearest to it.
std::array<bool, 3> soft_components(const Eigen::Matrix3d& stiffness, const std::array<bool, 3>& is_free) {
  constexpr double k_soft = 1e-8;  // Nastran's EPZERO
  std::array<bool, 3> is_soft = {false, false, false};
  std::vector<int> rows;
  for (int c = 0; c < 3; ++c) {
    if (is_free[static_cast<std::size_t>(c)]) rows.push_back(c);
  }
  while (!rows.empty()) {
    const Eigen::MatrixXd block = stiffness(rows, rows);
    const SymmetricEigen solver(block);
    const double largest = std::max(solver.eigenvalues().cwiseAbs().maxCoeff(), stiffness.cwiseAbs().maxCoeff());
    if (solver.eigenvalues()(0) > k_soft * largest) break;
    Eigen::Index nearest = 0;
    solver.eigenvectors().col(0).cwiseAbs().maxCoeff(&nearest);
    is_soft[static_cast<std::size_t>(rows[static_cast<std::size_t>(nearest)])] = true;
    rows.erase(rows.begin() + nearest);
  }
  return is_soft;
}

std::vector<bool> soft_equations(const ElementStore& store, const EquationMap& map, std::size_t nodes) {
  const auto blocks = nodal_stiffness(store, map, nodes);
  std::vector<bool> is_constrained(static_cast<std::size_t>(map.equation_count()), false);
  for (std::size_t node = 0; node < nodes; ++node) {
    for (int triple = 0; triple < 2; ++triple) {
      std::array<bool, 3> is_free = {};
      const int first = degree_of_freedom(static_cast<int>(node), 3 * triple);
      for (int c = 0; c < 3; ++c) is_free[static_cast<std::size_t>(c)] = map.state(first + c) >= 0;
      const auto is_soft = soft_components(blocks[node][static_cast<std::size_t>(triple)], is_free);
      for (int c = 0; c < 3; ++c) {
        if (is_soft[static_cast<std::size_t>(c)]) is_constrained[static_cast<std::size_t>(map.state(first + c))] = true;
      }
    }
  }
  return is_constrained;
}

/// Equations whose rows of stiffness and mass hold nothing but zeros, whatever the parameters are.
std::vector<bool> null_equations(const ElementStore& store, const EquationMap& map) {
  std::vector<bool> is_null(static_cast<std::size_t>(map.equation_count()), true);
  for (const StoredElement& element : store.elements()) {
    const int* numbers = store.equations(element);
    for (int k = 0; k < element.piece_count; ++k) {
      const StoredPiece& piece = store.piece(element, k);
      const bool is_damping = store.terms()[static_cast<std::size_t>(piece.term)].kind == ElementPiece::Kind::damping;
      if (is_damping || piece.scale == 0.0) continue;
      each_entry(element.equation_count, [&](std::size_t position, int i, int j) {
        if (piece.values[position] == 0.0) return;
        is_null[static_cast<std::size_t>(numbers[i])] = false;
        is_null[static_cast<std::size_t>(numbers[j])] = false;
      });
    }
  }
  return is_null;
}

}  // namespace

std::vector<bool> find_automatic_constraints(AutomaticConstraints wanted, const ElementStore& store,
                                             const EquationMap& map, std::size_t nodes) {
  switch (wanted) {
    case AutomaticConstraints::soft:
      return soft_equations(store, map, nodes);
    case AutomaticConstraints::null:
      return null_equations(store, map);
    case AutomaticConstraints::none:
      break;
  }
  return std::vector<bool>(static_cast<std::size_t>(map.equation_count()), false);
}

}  // namespace mottle::fem
