#include "mottle/fem/assembly/assembly.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>
#include <utility>

#include "fem/assembly/automatic_constraints.hpp"
#include "fem/assembly/element_store.hpp"
#include "fem/assembly/omitted_equations.hpp"
#include "mottle/core/error.hpp"

namespace mottle::fem {
namespace {

std::vector<FieldRole> field_roles(const FiniteElementModel& model, const std::vector<FieldParameter>& parameters) {
  std::vector<FieldRole> roles(model.fields.size());
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    for (const FieldIndex field : parameters[p].fields) {
      roles[static_cast<std::size_t>(field)] = {static_cast<int>(p), parameters[p].is_factor};
    }
  }
  return roles;
}

/// Lower triangle of which equations meet in an element of the wanted kinds.
template <typename Wanted>
SparseMatrix find_pattern(const ElementStore& store, int size, const Wanted& is_wanted) {
  std::vector<std::vector<std::size_t>> elements_of(static_cast<std::size_t>(size));
  const auto& elements = store.elements();
  for (std::size_t e = 0; e < elements.size(); ++e) {
    if (!is_wanted(elements[e])) continue;
    for (int k = 0; k < elements[e].equation_count; ++k) {
      const int equation = store.equations(elements[e])[k];
      if (equation >= 0) elements_of[static_cast<std::size_t>(equation)].push_back(e);
    }
  }
  std::vector<int> starts(1, 0);
  std::vector<int> rows;
  std::vector<int> last_column(static_cast<std::size_t>(size), -1);
  for (int column = 0; column < size; ++column) {
    const std::size_t first = rows.size();
    rows.push_back(column);  // the diagonal, whatever stands there
    last_column[static_cast<std::size_t>(column)] = column;
    for (const std::size_t e : elements_of[static_cast<std::size_t>(column)]) {
      const int* numbers = store.equations(elements[e]);
      for (int k = 0; k < elements[e].equation_count; ++k) {
        const int row = numbers[k];
        if (row <= column || last_column[static_cast<std::size_t>(row)] == column) continue;
        last_column[static_cast<std::size_t>(row)] = column;
        rows.push_back(row);
      }
    }
    std::sort(rows.begin() + static_cast<std::ptrdiff_t>(first), rows.end());
    starts.push_back(static_cast<int>(rows.size()));
  }
  const std::vector<double> zeros(rows.size(), 0.0);
  return Eigen::Map<const SparseMatrix>(size, size, static_cast<Eigen::Index>(rows.size()), starts.data(), rows.data(),
                                        zeros.data());
}

/// Where the pattern has (row, column), not before `start`. Most often just there: the rows of a node follow each
/// other.
int position_from(int start, const SparseMatrix& pattern, int row, int column) {
  const int* const rows = pattern.innerIndexPtr();
  const int* const first = rows + std::max(start, pattern.outerIndexPtr()[column]);
  if (*first == row) return static_cast<int>(first - rows);
  return static_cast<int>(std::lower_bound(first, rows + pattern.outerIndexPtr()[column + 1], row) - rows);
}

/// Sums by position, of which only those count that something was added to.
class PositionSums {
 public:
  explicit PositionSums(std::size_t size) : sums_(size, 0.0), is_reached_(size, 0) {}

  void add(int position, double value) {
    const auto index = static_cast<std::size_t>(position);
    sums_[index] += value;
    if (is_reached_[index] == 0) reached_.push_back(position);
    is_reached_[index] = 1;
  }

  /// Hands over the sums in ascending positions and begins again from zero.
  void move_to(SeparableMatrix::Term& term) {
    sort_reached();
    term.values.reserve(reached_.size());
    for (const int position : reached_) {
      term.values.push_back(std::exchange(sums_[static_cast<std::size_t>(position)], 0.0));
      is_reached_[static_cast<std::size_t>(position)] = 0;
    }
    term.positions = std::exchange(reached_, {});
  }

 private:
  void sort_reached() {
    constexpr std::size_t k_few = 16;  // up to one in so many positions, sorting is faster than looking at all
    if (reached_.size() < is_reached_.size() / k_few) return std::sort(reached_.begin(), reached_.end());
    reached_.clear();
    for (std::size_t index = 0; index < is_reached_.size(); ++index) {
      if (is_reached_[index] != 0) reached_.push_back(static_cast<int>(index));
    }
  }

  std::vector<double> sums_;
  std::vector<char> is_reached_;
  std::vector<int> reached_;
};

/// Whether a piece of an element is semidefinite by its pivots, see PencilTerms; a sum of such pieces is so as well.
bool is_semidefinite(const StoredPiece& piece, int size) {
  Eigen::MatrixXd matrix(size, size);
  each_entry(size, [&](std::size_t entry, int i, int j) { matrix(i, j) = piece.scale * piece.values[entry]; });
  for (double& diagonal : matrix.diagonal()) {  // one of zero: nothing acts on the row, or what makes it indefinite
    diagonal = diagonal == 0.0 ? std::numeric_limits<double>::min() : diagonal * (1.0 + k_inertia_tolerance);
  }
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(matrix);
  return factor.info() == Eigen::Success;
}

/// Adds up the pieces of one term after the other; each keeps only the positions that it reaches.
void add_terms(const ElementStore& store, ElementPiece::Kind kind, SeparableMatrix& matrix) {
  std::vector<std::vector<std::pair<std::size_t, int>>> pieces_of(store.terms().size());
  const auto& elements = store.elements();
  for (std::size_t e = 0; e < elements.size(); ++e) {
    for (int k = 0; k < elements[e].piece_count; ++k) {
      pieces_of[static_cast<std::size_t>(store.piece(elements[e], k).term)].emplace_back(e, k);
    }
  }
  PositionSums sums(static_cast<std::size_t>(matrix.pattern.nonZeros()));
  const bool varies = std::ranges::any_of(
      store.terms(), [&](const TermName& name) { return name.kind == kind && !name.coefficient.empty(); });
  for (std::size_t t = 0; t < pieces_of.size(); ++t) {
    if (store.terms()[t].kind != kind) continue;
    // Asked for by nobody else: of a constant mass by the eigensolver.
    bool is_definite = kind == ElementPiece::Kind::mass || (varies && kind == ElementPiece::Kind::stiffness);
    for (const auto& [e, k] : pieces_of[t]) {
      const int* numbers = store.equations(elements[e]);
      const StoredPiece& piece = store.piece(elements[e], k);
      is_definite = is_definite && is_semidefinite(piece, elements[e].equation_count);
      int position = -1;  // ascends within a piece, as the element's equations do
      each_entry(elements[e].equation_count, [&](std::size_t entry, int i, int j) {
        if (numbers[i] < 0 || numbers[j] < 0 || piece.values[entry] == 0.0) return;
        position = position_from(position + 1, matrix.pattern, numbers[i], numbers[j]);
        sums.add(position, piece.scale * piece.values[entry]);
      });
    }
    sums.move_to(matrix.terms.emplace_back(SeparableMatrix::Term{store.terms()[t].coefficient, {}, {}, is_definite}));
  }
}

Eigen::SparseMatrix<double, Eigen::RowMajor> expansion_matrix(const EquationMap& map, std::size_t nodes) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int slot = 0; slot < static_cast<int>(6 * nodes); ++slot) {
    const int state = map.state(slot);
    if (state >= 0) entries.emplace_back(slot, state, 1.0);
    if (state > EquationMap::k_dependent) continue;
    for (const auto& term : map.sum(state)) entries.emplace_back(slot, term.equation, term.coefficient);
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> expansion(static_cast<Eigen::Index>(6 * nodes), map.equation_count());
  expansion.setFromTriplets(entries.begin(), entries.end());
  return expansion;
}

void constrain_automatically(const FiniteElementModel& model, ElementStore& store, EquationMap& map,
                             AssembledModel& result) {
  const std::vector<bool> is_constrained =
      find_automatic_constraints(model.settings.automatic_constraints, store, map, model.nodes.size());
  for (std::size_t k = 0; k < is_constrained.size(); ++k) {
    const Equation& equation = map.equations()[k];
    if (is_constrained[k]) result.automatic_constraints.push_back({equation.node, equation.component});
  }
  if (result.automatic_constraints.empty()) return;
  store.constrain(is_constrained);
  map.constrain(is_constrained);
  std::vector<bool> is_omitted;
  for (std::size_t k = 0; k < result.is_omitted.size(); ++k) {
    if (!is_constrained[k]) is_omitted.push_back(result.is_omitted[k]);
  }
  result.is_omitted = std::move(is_omitted);
}

}  // namespace

AssembledModel assemble(const FiniteElementModel& model, const std::vector<FieldParameter>& parameters) {
  EquationMap map(model);
  ElementStore store(model, map, field_roles(model, parameters), parameters.size());
  AssembledModel result;
  result.is_omitted = omitted_equations(model, map);
  constrain_automatically(model, store, map, result);
  require(map.equation_count() > 0, "the model has no free degree of freedom that anything stiffens");
  const auto has_kind = [&store](ElementPiece::Kind kind) {
    return [&store, kind](const StoredElement& element) {
      for (int k = 0; k < element.piece_count; ++k) {
        const auto found = store.terms()[static_cast<std::size_t>(store.piece(element, k).term)].kind;
        if ((found == ElementPiece::Kind::damping) == (kind == ElementPiece::Kind::damping)) return true;
      }
      return false;
    };
  };
  result.stiffness.pattern = find_pattern(store, map.equation_count(), has_kind(ElementPiece::Kind::stiffness));
  result.mass.pattern = result.stiffness.pattern;
  result.damping.pattern = find_pattern(store, map.equation_count(), has_kind(ElementPiece::Kind::damping));
  add_terms(store, ElementPiece::Kind::stiffness, result.stiffness);
  add_terms(store, ElementPiece::Kind::mass, result.mass);
  add_terms(store, ElementPiece::Kind::damping, result.damping);
  result.equations = map.equations();
  result.is_separable = store.is_separable();
  result.dependent_degrees_of_freedom = map.dependent_count();
  result.expansion = expansion_matrix(map, model.nodes.size());
  return result;
}

std::string degree_of_freedom_name(const FiniteElementModel& model, int node, int component) {
  static constexpr const char* k_names[] = {"+X", "+Y", "+Z", "+RX", "+RY", "+RZ"};
  const Node& point = model.nodes[static_cast<std::size_t>(node)];
  return point.is_scalar ? fmt::format("{}", point.id) : fmt::format("{}:{}", point.id, k_names[component]);
}

}  // namespace mottle::fem
