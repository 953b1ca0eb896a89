#include "mottle/model/structures/matrix_structure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/linalg/reduced/semidefinite.hpp"

namespace mottle::model {
namespace {

SparseMatrix pattern_of(const std::vector<const std::vector<ScaledMatrix>*>& sums) {
  SparseMatrix pattern;
  for (const std::vector<ScaledMatrix>* sum : sums) {
    for (const ScaledMatrix& term : *sum) {
      SparseMatrix ones = term.lower;
      ones.coeffs().setOnes();
      pattern = pattern.rows() == 0 ? ones : SparseMatrix(pattern + ones);
    }
  }
  pattern.makeCompressed();
  pattern.coeffs().setZero();
  return pattern;
}

SeparableMatrix in_pattern(const SparseMatrix& pattern, const std::vector<ScaledMatrix>& sum) {
  SeparableMatrix result{pattern, {}};
  std::map<std::vector<ParameterPower>, SparseMatrix> terms;
  for (const ScaledMatrix& term : sum) {
    const auto [entry, is_new] = terms.try_emplace(term.coefficient, term.lower);
    if (!is_new) entry->second = SparseMatrix(entry->second + term.lower);
  }
  for (const auto& [coefficient, matrix] : terms) {
    SeparableMatrix::Term term{coefficient, {}, {}};
    for (int j = 0; j < matrix.outerSize(); ++j) {
      const int* begin = pattern.innerIndexPtr() + pattern.outerIndexPtr()[j];
      const int* end = pattern.innerIndexPtr() + pattern.outerIndexPtr()[j + 1];
      for (SparseMatrix::InnerIterator entry(matrix, j); entry; ++entry) {
        if (entry.value() == 0.0) continue;
        begin = std::lower_bound(begin, end, static_cast<int>(entry.row()));
        term.positions.push_back(static_cast<int>(begin - pattern.innerIndexPtr()));
        term.values.push_back(entry.value());
      }
    }
    if (!term.positions.empty()) result.terms.push_back(std::move(term));
  }
  return result;
}

}  // namespace

SeparablePencil make_pencil(const std::vector<ScaledMatrix>& stiffness, const std::vector<ScaledMatrix>& mass,
                            std::vector<std::string> names) {
  const SparseMatrix pattern = pattern_of({&stiffness, &mass});
  return {in_pattern(pattern, stiffness), in_pattern(pattern, mass), std::move(names)};
}

MatrixStructure::MatrixStructure(SeparablePencil pencil, Eigen::VectorXd reference)
    : pencil_(std::move(pencil)), reference_(std::move(reference)) {
  for (SeparableMatrix::Term& term : pencil_.mass.terms) {
    term.is_semidefinite = term.is_semidefinite || is_semidefinite(pencil_.mass.matrix_of(term));
  }
  for (int row = 0; row < static_cast<int>(mode_count()); ++row) {
    const auto [entry, is_new] = numbers_.try_emplace(equation_name(row), static_cast<int>(layers_.size()));
    if (is_new) layers_.emplace_back();
    layers_[static_cast<std::size_t>(entry->second)].push_back(row);
  }
}

std::string MatrixStructure::equation_name(int row) const {
  return pencil_.names.empty() ? std::to_string(row + 1) : pencil_.names[static_cast<std::size_t>(row)];
}

int MatrixStructure::find_degree_of_freedom(const std::string& name) const {
  const auto found = numbers_.find(name);
  return found == numbers_.end() ? -1 : found->second;
}

std::string MatrixStructure::unknown_degree_of_freedom(const std::string& name) const {
  if (pencil_.names.empty()) {
    return fmt::format(
        "'{}' is not known here: the matrices' rows have no names, only numbers from 1 to {}; give the "
        "names of the degrees of freedom",
        name, mode_count());
  }
  constexpr std::size_t k_listed = 8;
  std::vector<std::string> known;
  for (const auto& [each, number] : numbers_) known.push_back(each);
  const std::string nearest = nearest_name(name, known);
  const bool is_cut = known.size() > k_listed;
  if (is_cut) known.resize(k_listed);
  return fmt::format(
      "the matrices have no row '{}'{} They have {}{}; a degree of freedom that the solver fixed or made "
      "dependent has none",
      name, nearest.empty() ? "." : fmt::format("; did you mean '{}'?", nearest), join(known), is_cut ? ", ..." : "");
}

ObservationMatrix MatrixStructure::observation(const std::vector<int>& degrees_of_freedom) const {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < degrees_of_freedom.size(); ++k) {
    const std::vector<int>& rows = layers_[static_cast<std::size_t>(degrees_of_freedom[k])];
    for (const int row : rows) entries.emplace_back(static_cast<int>(k), row, 1.0 / static_cast<double>(rows.size()));
  }
  ObservationMatrix mean(static_cast<Eigen::Index>(degrees_of_freedom.size()), mode_count());
  mean.setFromTriplets(entries.begin(), entries.end());
  return mean;
}

double MatrixStructure::total_mass(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  const SparseMatrix mass = pencil_.mass.at(parameters);
  for (const char* axis : {":+X", ":+Y", ":+Z"}) {
    Eigen::VectorXd motion = Eigen::VectorXd::Zero(mass.rows());
    for (std::size_t row = 0; row < pencil_.names.size(); ++row) {
      if (pencil_.names[row].ends_with(axis)) motion(static_cast<Eigen::Index>(row)) = 1.0;
    }
    if (motion.any()) return motion.dot(symmetric_product(mass, motion).col(0));
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::vector<std::string> MatrixStructure::description(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  std::vector<std::string> lines;
  lines.push_back(fmt::format("model: matrices of {} equations, {}, {} entries; {} terms of K, {} of M", mode_count(),
                              pencil_.names.empty() ? "without names" : fmt::format("{} names", numbers_.size()),
                              pencil_.stiffness.pattern.nonZeros(), pencil_.stiffness.terms.size(),
                              pencil_.mass.terms.size()));
  const double mass = total_mass(parameters);
  if (std::isfinite(mass)) {
    lines.push_back(fmt::format("mass of the degrees of freedom that are not fixed: {:.6g}", mass));
  }
  return lines;
}

}  // namespace mottle::model
