#include "fem/assembly/element_store.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mottle::fem {
namespace {

/// Turns triples of degrees of freedom from basic axes into their nodes' displacement systems.
void turn_into_node_axes(const FiniteElementModel& model, ElementPieces& element) {
  bool has_local_axes = false;
  for (const int slot : element.degrees_of_freedom) {
    has_local_axes |= model.nodes[static_cast<std::size_t>(slot / 6)].displacement_system >= 0;
  }
  if (!has_local_axes || !element.is_basic) return;
  const auto size = static_cast<Eigen::Index>(element.degrees_of_freedom.size());
  Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index k = 0; k < size; k += 3) {
    turn.block<3, 3>(k, k) =
        displacement_directions(model, element.degrees_of_freedom[static_cast<std::size_t>(k)] / 6);
  }
  for (ElementPiece& piece : element.pieces) piece.matrix = turn.transpose() * piece.matrix * turn;
}

/// T' M T, in which a row that is rounding alone, as of an element that moves with a rigid body, is zero: what is left
/// of it would make a semidefinite matrix indefinite. The diagonal alone does not tell: pieces such as a product of
/// inertia have none; beside one that is rounding, other entries of a semidefinite matrix may be its root.
Eigen::MatrixXd transformed(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& transform) {
  constexpr double k_rounding = 1e-14;  // of the sum of a product's sizes
  constexpr double k_beside = 1e-7;
  Eigen::MatrixXd result = transform.transpose() * matrix * transform;
  const Eigen::MatrixXd sizes = transform.cwiseAbs().transpose() * matrix.cwiseAbs() * transform.cwiseAbs();
  const Eigen::VectorXd roots = sizes.diagonal().cwiseSqrt();
  for (Eigen::Index i = 0; i < result.rows(); ++i) {
    if (std::abs(result(i, i)) > k_rounding * sizes(i, i)) continue;
    const Eigen::ArrayXd scales = sizes.row(i).transpose().cwiseMax(roots(i) * roots);
    if ((result.row(i).transpose().array().abs() > k_beside * scales).any()) continue;
    result.row(i).setZero();
    result.col(i).setZero();
  }
  return result;
}

/// Equations of an element and how its degrees of freedom follow from them.
struct ElementEquations {
  std::vector<int> equations;  ///< ascending
  Eigen::MatrixXd transform;   ///< [element dof x equation]
  std::vector<int> rows;       ///< element dof of each equation where the transform only selects; else empty
};

ElementEquations find_equations(const EquationMap& map, const std::vector<int>& slots) {
  ElementEquations result;
  bool is_selection = true;
  for (const int slot : slots) {
    const int state = map.state(slot);
    if (state >= 0) result.equations.push_back(state);
    if (state <= EquationMap::k_dependent) {
      is_selection = false;
      for (const auto& term : map.sum(state)) result.equations.push_back(term.equation);
    }
  }
  std::sort(result.equations.begin(), result.equations.end());
  const auto last = std::unique(result.equations.begin(), result.equations.end());
  is_selection = is_selection && last == result.equations.end();
  result.equations.erase(last, result.equations.end());
  const auto column = [&](int equation) {
    return std::lower_bound(result.equations.begin(), result.equations.end(), equation) - result.equations.begin();
  };
  if (is_selection) {
    result.rows.resize(result.equations.size());
    for (std::size_t k = 0; k < slots.size(); ++k) {
      const int state = map.state(slots[k]);
      if (state >= 0) result.rows[static_cast<std::size_t>(column(state))] = static_cast<int>(k);
    }
    return result;
  }
  result.transform = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(slots.size()),
                                           static_cast<Eigen::Index>(result.equations.size()));
  for (std::size_t k = 0; k < slots.size(); ++k) {
    const int state = map.state(slots[k]);
    const auto row = static_cast<Eigen::Index>(k);
    if (state >= 0) result.transform(row, column(state)) += 1.0;
    if (state > EquationMap::k_dependent) continue;
    for (const auto& term : map.sum(state)) result.transform(row, column(term.equation)) += term.coefficient;
  }
  return result;
}

}  // namespace

ElementStore::ElementStore(const FiniteElementModel& model, const EquationMap& map, std::vector<FieldRole> roles,
                           std::size_t parameter_count)
    : roles_(std::move(roles)), is_separable_(parameter_count, true) {
  visit_elements(model, PieceSelection::all, [&](ElementPieces& element) { store(model, map, element); });
}

void ElementStore::store(const FiniteElementModel& model, const EquationMap& map, ElementPieces& element) {
  turn_into_node_axes(model, element);
  const ElementEquations found = find_equations(map, element.degrees_of_freedom);
  if (found.equations.empty()) return;
  elements_.push_back({equations_.size(), static_cast<int>(found.equations.size()), pieces_.size(),
                       static_cast<int>(element.pieces.size())});
  equations_.insert(equations_.end(), found.equations.begin(), found.equations.end());
  for (const ElementPiece& piece : element.pieces) {
    StoredPiece stored = describe(model, piece);
    if (found.rows.empty()) {
      const Eigen::MatrixXd matrix = transformed(piece.matrix, found.transform);
      stored.values = store_values(found.equations.size(), [&](std::size_t i, std::size_t j) {
        return matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      });
    } else {
      stored.values = store_values(found.equations.size(), [&](std::size_t i, std::size_t j) {
        return piece.matrix(found.rows[i], found.rows[j]);
      });
    }
    pieces_.push_back(stored);
  }
}

/// All of a piece but its values.
StoredPiece ElementStore::describe(const FiniteElementModel& model, const ElementPiece& piece) {
  TermName name{piece.kind, {}};
  StoredPiece stored{.scale = piece.factor, .at_card_values = piece.factor};
  for (const FieldPower& factor : piece.coefficient) {
    const double value = std::pow(model.value(factor.field), factor.power);
    stored.at_card_values *= value;
    const FieldRole role = roles_[static_cast<std::size_t>(factor.field)];
    if (role.parameter < 0 || role.is_factor) stored.scale *= value;
    if (role.parameter < 0) continue;
    const auto known = std::find_if(name.coefficient.begin(), name.coefficient.end(),
                                    [&](const ParameterPower& power) { return power.parameter == role.parameter; });
    if (known == name.coefficient.end()) {
      name.coefficient.push_back({role.parameter, factor.power});
    } else {
      known->power += factor.power;
    }
  }
  std::sort(name.coefficient.begin(), name.coefficient.end());
  for (const FieldIndex field : piece.matrix_fields) {
    const int parameter = field < 0 ? -1 : roles_[static_cast<std::size_t>(field)].parameter;
    if (parameter >= 0) is_separable_[static_cast<std::size_t>(parameter)] = false;
  }
  stored.term = term_index(std::move(name));
  return stored;
}

/// The symmetric part of the matrix with entry(i, j).
template <typename Entry>
const double* ElementStore::store_values(std::size_t size, const Entry& entry) {
  double* const values = new_values(size * (size + 1) / 2);
  double* next = values;
  for (std::size_t j = 0; j < size; ++j) {
    for (std::size_t i = j; i < size; ++i) *next++ = 0.5 * (entry(i, j) + entry(j, i));
  }
  return values;
}

double* ElementStore::new_values(std::size_t count) {
  constexpr std::size_t k_chunk = 1 << 16;
  if (count > unused_values_) {
    unused_values_ = std::max(k_chunk, count);
    next_value_ = values_.emplace_back(std::make_unique_for_overwrite<double[]>(unused_values_)).get();
  }
  unused_values_ -= count;
  return std::exchange(next_value_, next_value_ + count);
}

int ElementStore::term_index(TermName name) {
  const auto [found, is_new] = index_of_term_.emplace(name, static_cast<int>(terms_.size()));
  if (is_new) terms_.push_back(std::move(name));
  return found->second;
}

void ElementStore::constrain(const std::vector<bool>& is_constrained) {
  std::vector<int> renumbered(is_constrained.size(), -1);
  int next = 0;
  for (std::size_t k = 0; k < is_constrained.size(); ++k) {
    if (!is_constrained[k]) renumbered[k] = next++;
  }
  for (int& equation : equations_) equation = renumbered[static_cast<std::size_t>(equation)];
}

}  // namespace mottle::fem
