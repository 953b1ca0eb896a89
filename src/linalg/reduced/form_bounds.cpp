#include "linalg/reduced/form_bounds.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/linalg/reduced/semidefinite.hpp"
#include "mottle/linalg/sparse/sparse_modes.hpp"

namespace mottle::linalg {
namespace {

constexpr double k_infinite = std::numeric_limits<double>::infinity();

/// Ritz values of P^-1 T at both ends of its spectrum, inside it.
FormBounds extreme_ritz_values(const SparseMatrix& term, const SparseMatrix& form, DefiniteFactor& factor,
                               const Eigen::VectorXd& start) {
  constexpr Eigen::Index k_steps = 40;
  constexpr double k_invariant = 1e-10;
  const Eigen::Index size = start.size(), max_steps = std::min(k_steps, size);
  Eigen::MatrixXd basis(size, max_steps), images(size, max_steps);  // P-orthonormal; T times them
  Eigen::Index found = 0;
  Eigen::MatrixXd next = start;
  double scale = 0.0;
  for (; found < max_steps; ++found) {
    const double before = std::sqrt(next.col(0).dot(symmetric_product(form, next).col(0)));
    for (int pass = 0; pass < 2; ++pass) {  // P q_j is not kept: one product more instead
      const Eigen::VectorXd shares = basis.leftCols(found).transpose() * symmetric_product(form, next);
      next -= basis.leftCols(found) * shares;
    }
    const double length = std::sqrt(next.col(0).dot(symmetric_product(form, next).col(0)));
    scale = std::max(scale, before);
    if (!(length > k_invariant * before)) break;
    basis.col(found) = next / length;
    images.col(found) = symmetric_product(term, basis.col(found));
    next = images.col(found);
    factor.solve(next);
    if (next.isZero(0.0)) {
      ++found;
      break;
    }
  }
  if (found == 0) return {};
  const Eigen::MatrixXd projected = basis.leftCols(found).transpose() * images.leftCols(found);
  const Eigen::VectorXd eigenvalues = symmetric_eigenvalues(projected);
  return {eigenvalues(0), eigenvalues(found - 1)};
}

/// The elimination order of some rows within that of all: separators of the structure separate its terms as well.
std::vector<int> order_of(const std::vector<int>& rows, const std::vector<int>& order) {
  std::vector<int> local_row(order.size(), -1), result;
  if (order.empty()) return result;
  for (std::size_t i = 0; i < rows.size(); ++i) local_row[static_cast<std::size_t>(rows[i])] = static_cast<int>(i);
  for (const int row : order) {
    if (local_row[static_cast<std::size_t>(row)] >= 0) result.push_back(local_row[static_cast<std::size_t>(row)]);
  }
  return result;
}

}  // namespace

bool is_semidefinite(const SupportedMatrix& term, const std::vector<int>& order) {
  SparseMatrix matrix = term.local();
  Eigen::VectorXd sizes = Eigen::VectorXd::Zero(matrix.rows());
  for (Eigen::Index j = 0; j < matrix.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator entry(matrix, j); entry; ++entry) {
      sizes(entry.row()) = std::max(sizes(entry.row()), std::abs(entry.value()));
      sizes(j) = std::max(sizes(j), std::abs(entry.value()));
    }
  }
  Eigen::VectorXd added = matrix.diagonal() * k_inertia_tolerance;
  for (Eigen::Index i = 0; i < sizes.size(); ++i) {
    if (sizes(i) == 0.0) {
      added(i) = 1.0;  // a row of zeros that the pattern holds
    } else if (!(matrix.coeff(i, i) > 0.0)) {
      return false;
    }
  }
  SparseMatrix diagonal(matrix.rows(), matrix.cols());
  diagonal.setIdentity();
  diagonal.coeffs() = added.array();
  matrix += diagonal;
  matrix.makeCompressed();
  return make_definite_factor(order_of(term.rows(), order))->factorise(matrix);
}

bool is_semidefinite(const SparseMatrix& lower) {
  return is_semidefinite(SupportedMatrix(lower));
}

FormBounds verified_bounds(const SparseMatrix& term, const SparseMatrix& form, DefiniteFactor& factor,
                           const Eigen::VectorXd& start) {
  constexpr double k_margin = 0.02, k_offset = 1e-3;  // the first step outwards: of the estimate, and of P
  constexpr double k_farther = 4.0;
  constexpr int k_attempts = 4;
  const FormBounds inside = extreme_ritz_values(term, form, factor, start);
  const SupportedMatrix added(term);
  const std::unique_ptr<DefiniteFactor> pivots = make_definite_factor();
  const auto verified = [&](double estimate, double sign) {
    double step = k_margin * std::abs(estimate) + k_offset;
    for (int attempt = 0; attempt < k_attempts; ++attempt, step *= k_farther) {
      const double bound = estimate + sign * step;
      SparseMatrix difference = sign * bound * form;  // bound P - T, or its negative below
      added.add_to(difference, -sign);
      if (pivots->factorise(difference)) return bound;
    }
    return sign * k_infinite;
  };
  return {verified(inside.lower, -1.0), verified(inside.upper, 1.0)};
}

double lower_ratio(const Eigen::Ref<const Eigen::VectorXd>& values, const Eigen::VectorXd& reference,
                   const Eigen::MatrixXd& bounds) {
  constexpr double k_rounding = 1e-13;
  const auto at = [&](double ratio) {
    double sum = ratio;
    for (Eigen::Index t = 0; t < values.size(); ++t) {
      const double moved = ratio * reference(t), change = values(t) - moved;
      if (std::abs(change) <= k_rounding * std::abs(moved)) continue;
      const double bound = bounds(t, change > 0.0 ? 0 : 1);
      if (bound != 0.0) sum += change * bound;  // an infinite one tells nothing, as it should
    }
    return sum;
  };
  double highest = k_infinite;  // above, terms without an upper bound would be missing
  for (Eigen::Index t = 0; t < values.size(); ++t) {
    if (bounds(t, 1) == k_infinite && reference(t) > 0.0) highest = std::min(highest, values(t) / reference(t));
  }
  double best = std::isfinite(highest) ? at(highest) : -k_infinite;
  for (Eigen::Index t = 0; t < values.size(); ++t) {
    if (bounds(t, 1) == k_infinite || reference(t) == 0.0 || (bounds(t, 0) == 0.0 && bounds(t, 1) == 0.0)) continue;
    const double corner = values(t) / reference(t);
    if (corner < highest) best = std::max(best, at(corner));
  }
  return best;
}

double upper_ratio(const Eigen::Ref<const Eigen::VectorXd>& values, const Eigen::VectorXd& reference,
                   const Eigen::MatrixXd& bounds) {
  return -lower_ratio(-values, reference, bounds);
}

}  // namespace mottle::linalg
