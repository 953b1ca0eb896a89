// All elements' pieces in terms of equations, ready to be added up: the middle of the assembly.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "fem/assembly/equation_map.hpp"
#include "fem/elements/element_pieces.hpp"
#include "mottle/layers.hpp"

namespace mottle::fem {

/// What a field means to the parameters.
struct FieldRole {
  int parameter = -1;  ///< -1: a constant
  bool is_factor = false;
};

/// One element after its degrees of freedom became equations; its matrices are packed lower triangles, by columns.
struct StoredElement {
  std::size_t first_equation = 0;  ///< into ElementStore::equations; ascending numbers
  int equation_count = 0;
  std::size_t first_piece = 0;  ///< into ElementStore::pieces
  int piece_count = 0;
};

struct StoredPiece {
  int term = 0;                    ///< into ElementStore::terms
  double scale = 1.0;              ///< turns the values into the term's part: all that is constant in the coefficient
  double at_card_values = 1.0;     ///< turns the values into the matrix of the deck as it stands
  const double* values = nullptr;  ///< owned by the ElementStore
};

/// Calls add(packed position, i, j) for the lower triangle of an element's values, i and j its local rows.
template <typename Add>
void each_entry(int size, const Add& add) {
  std::size_t position = 0;
  for (int j = 0; j < size; ++j) {
    for (int i = j; i < size; ++i) add(position++, i, j);
  }
}

/// A term of one of the three matrices.
struct TermName {
  ElementPiece::Kind kind = ElementPiece::Kind::stiffness;
  std::vector<ParameterPower> coefficient;

  auto operator<=>(const TermName&) const = default;
};

class ElementStore {
 public:
  ElementStore(const FiniteElementModel& model, const EquationMap& map, std::vector<FieldRole> roles,
               std::size_t parameter_count);

  const std::vector<StoredElement>& elements() const { return elements_; }
  const std::vector<TermName>& terms() const { return terms_; }
  const std::vector<bool>& is_separable() const { return is_separable_; }
  const int* equations(const StoredElement& element) const { return equations_.data() + element.first_equation; }
  const StoredPiece& piece(const StoredElement& element, int k) const {
    return pieces_[element.first_piece + static_cast<std::size_t>(k)];
  }

  /// Applies EquationMap::constrain to what is stored: constrained equations become -1.
  void constrain(const std::vector<bool>& is_constrained);

 private:
  void store(const FiniteElementModel& model, const EquationMap& map, ElementPieces& element);
  StoredPiece describe(const FiniteElementModel& model, const ElementPiece& piece);
  int term_index(TermName name);
  template <typename Entry>
  const double* store_values(std::size_t size, const Entry& entry);
  double* new_values(std::size_t count);

  std::vector<FieldRole> roles_;
  std::vector<bool> is_separable_;
  std::vector<StoredElement> elements_;
  std::vector<int> equations_;
  std::vector<StoredPiece> pieces_;
  std::vector<std::unique_ptr<double[]>> values_;  // in chunks: one array would be copied each time that it grows
  double* next_value_ = nullptr;                   // of the last chunk
  std::size_t unused_values_ = 0;
  std::vector<TermName> terms_;
  std::map<TermName, int> index_of_term_;
};

}  // namespace mottle::fem
