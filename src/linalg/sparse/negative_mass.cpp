#include "mottle/linalg/sparse/negative_mass.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mottle/linalg/sparse/sparse_modes.hpp"

namespace mottle::linalg {
namespace {

using Kind = NegativeMass::Kind;

/// Of a singular mass (a rigid body about a point away from its centre), files with ten digits leave negative
/// eigenvalues of 1e-9.
constexpr double k_rounding = 1e-8;
/// Of K_ii over the median ratio. The terms of a row without mass may cancel to 1e-16 of those of its neighbours.
constexpr double k_negligible = 1e-5;

/// D of find_negative_mass().
Eigen::VectorXd sizes_of(const SparseMatrix& stiffness, const Eigen::VectorXd& masses) {
  const Eigen::VectorXd k = stiffness.diagonal();
  Eigen::VectorXd sizes = masses.cwiseAbs();
  std::vector<double> ratios;
  for (Eigen::Index i = 0; i < k.size(); ++i) {
    if (k(i) > 0.0 && masses(i) > 0.0) ratios.push_back(k(i) / masses(i));
  }
  if (ratios.empty()) return sizes;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return sizes.cwiseMax(k * (k_negligible / *middle));
}

std::optional<NegativeMass> negative_diagonal(const Eigen::VectorXd& masses, const Eigen::VectorXd& sizes) {
  std::optional<NegativeMass> worst;
  for (Eigen::Index i = 0; i < masses.size(); ++i) {
    if (!(masses(i) < -k_rounding * sizes(i)) || (worst && masses(i) >= worst->value)) continue;
    worst = {Kind::diagonal, static_cast<int>(i), masses(i), masses(i)};
  }
  return worst;
}

bool is_diagonal(const SparseMatrix& lower) {
  for (int j = 0; j < lower.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator entry(lower, j); entry; ++entry) {
      if (entry.row() != j) return false;
    }
  }
  return true;
}

/// Two rows with M_ij^2 > M_ii M_jj: the plainest reason, which the pivots would put into larger numbers.
std::optional<NegativeMass> excessive_coupling(const SparseMatrix& lower, const Eigen::VectorXd& masses,
                                               const Eigen::VectorXd& sizes) {
  const Eigen::VectorXd raised = masses + k_rounding * sizes;
  for (int j = 0; j < lower.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator entry(lower, j); entry; ++entry) {
      const auto i = static_cast<int>(entry.row());
      if (i == j || std::abs(entry.value()) <= std::sqrt(raised(i)) * std::sqrt(raised(j))) continue;
      const int row = masses(i) <= k_rounding * sizes(i) ? i : j;
      return NegativeMass{Kind::coupling, row, entry.value(), masses(row)};
    }
  }
  return {};
}

/// M + 1e-8 D, with ones on the diagonal of rows that have neither mass nor stiffness.
SparseMatrix raised_by(const SparseMatrix& lower, const Eigen::VectorXd& sizes) {
  SparseMatrix diagonal(lower.rows(), lower.cols());
  diagonal.setIdentity();
  diagonal.coeffs() = (sizes.array() > 0.0).select(k_rounding * sizes.array(), 1.0);
  SparseMatrix result = lower + diagonal;
  result.makeCompressed();
  return result;
}

/// The lower triangle among some rows, in their order.
SparseMatrix among(const SparseMatrix& lower, const std::vector<int>& rows) {
  std::vector<int> places(static_cast<std::size_t>(lower.rows()), -1);
  for (std::size_t k = 0; k < rows.size(); ++k) places[static_cast<std::size_t>(rows[k])] = static_cast<int>(k);
  std::vector<Eigen::Triplet<double>> entries;
  for (const int column : rows) {
    for (SparseMatrix::InnerIterator entry(lower, column); entry; ++entry) {
      const int a = places[static_cast<std::size_t>(entry.row())], b = places[static_cast<std::size_t>(column)];
      if (a >= 0) entries.emplace_back(std::max(a, b), std::min(a, b), entry.value());
    }
  }
  const auto size = static_cast<Eigen::Index>(rows.size());
  SparseMatrix result(size, size);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

/// x' M x with x = [-A^-1 b; 1], where elimination failed in the last of these rows: A of the rows before it and b
/// their entries in it are those of the raised matrix.
double pivot_of(const SparseMatrix& lower, const SparseMatrix& raised, const std::vector<int>& rows) {
  const auto before = static_cast<Eigen::Index>(rows.size()) - 1;
  Eigen::MatrixXd direction = Eigen::MatrixXd::Zero(before + 1, 1);
  direction(before) = 1.0;
  if (before > 0) {
    std::vector<int> as_they_are(static_cast<std::size_t>(before));
    std::iota(as_they_are.begin(), as_they_are.end(), 0);
    const auto factor = make_definite_factor(as_they_are);
    if (factor->factorise(among(raised, {rows.begin(), rows.end() - 1}))) {
      Eigen::MatrixXd solved = symmetric_product(among(raised, rows), direction).topRows(before);
      factor->solve(solved);
      direction.topRows(before) = -solved;
    }
  }
  return direction.cwiseProduct(symmetric_product(among(lower, rows), direction)).sum();
}

}  // namespace

std::optional<NegativeMass> find_negative_mass(const SparseMatrix& stiffness, const SparseMatrix& mass,
                                               const std::vector<int>& order) {
  const Eigen::VectorXd masses = mass.diagonal();
  const Eigen::VectorXd sizes = sizes_of(stiffness, masses);
  if (const auto found = negative_diagonal(masses, sizes)) return found;
  const SparseMatrix lean = mass.pruned(0.0, 0.0);
  if (is_diagonal(lean) || !lean.coeffs().allFinite()) return {};
  if (const auto found = excessive_coupling(lean, masses, sizes)) return found;
  const SparseMatrix raised = raised_by(lean, sizes);
  const auto factor = make_definite_factor(order);
  if (factor->factorise(raised)) return {};
  const int row = factor->failed_column();
  std::vector<int> rows = factor->order();
  rows.erase(std::find(rows.begin(), rows.end(), row) + 1, rows.end());
  return NegativeMass{Kind::pivot, row, pivot_of(lean, raised, rows), masses(row)};
}

std::string describe(const NegativeMass& negative, const std::string& row_name) {
  const auto what = [&] {
    switch (negative.kind) {
      case Kind::diagonal:
        return fmt::format("the diagonal entry of row {} is {:.6g}", row_name, negative.value);
      case Kind::coupling:
        return fmt::format("row {} has an entry of {:.6g} beside {:.6g} on the diagonal", row_name, negative.value,
                           negative.diagonal);
      case Kind::pivot:
        break;
    }
    return fmt::format("the pivot of row {} is {:.6g}", row_name, negative.value);
  };
  return "the mass matrix is not positive semidefinite: " + what();
}

}  // namespace mottle::linalg
