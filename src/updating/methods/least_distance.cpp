#include "updating/methods/least_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::updating {
namespace {

/// Least squares over the columns in `used`; the others are zero.
Eigen::VectorXd solve_used(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right,
                           const std::vector<Eigen::Index>& used) {
  Eigen::VectorXd solution = Eigen::VectorXd::Zero(matrix.cols());
  const Eigen::MatrixXd columns = matrix(Eigen::all, used);
  const Eigen::VectorXd solved = LeastNormSolver(columns).solve(right);
  solution(used) = solved;
  return solution;
}

/// Moves u towards the unconstrained solution until an entry reaches zero, and takes that entry out.
void step_to_border(const Eigen::VectorXd& free, Eigen::VectorXd& u, std::vector<Eigen::Index>& used) {
  double part = 1.0;
  Eigen::Index first = used.front();
  for (const Eigen::Index j : used) {
    if (free(j) > 0.0 || u(j) / (u(j) - free(j)) > part) continue;
    part = u(j) / (u(j) - free(j));
    first = j;
  }
  for (const Eigen::Index j : used) u(j) += part * (free(j) - u(j));
  std::erase_if(used, [&](Eigen::Index j) {
    const bool is_out = j == first || (free(j) <= 0.0 && u(j) <= 0.0);
    if (is_out) u(j) = 0.0;
    return is_out;
  });
}

}  // namespace

Eigen::VectorXd non_negative_least_squares(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right) {
  const double scale = matrix.cwiseAbs().maxCoeff() * std::max(right.norm(), 1e-300);
  const double tolerance = 1e-14 * static_cast<double>(matrix.rows() + matrix.cols()) * scale;
  Eigen::VectorXd u = Eigen::VectorXd::Zero(matrix.cols());
  std::vector<Eigen::Index> used;
  const Eigen::Index max_rounds = 10 * matrix.cols() + 50;
  std::vector<bool> is_refused(static_cast<std::size_t>(matrix.cols()), false);
  for (Eigen::Index round = 0; round < max_rounds; ++round) {
    Eigen::VectorXd descent = matrix.transpose() * (right - matrix * u);
    for (const Eigen::Index j : used) descent(j) = -1.0;
    for (Eigen::Index j = 0; j < descent.size(); ++j) {
      if (is_refused[static_cast<std::size_t>(j)]) descent(j) = -1.0;
    }
    Eigen::Index steepest = 0;
    if (descent.maxCoeff(&steepest) <= tolerance) break;
    used.push_back(steepest);
    Eigen::VectorXd free = solve_used(matrix, right, used);
    if (free(steepest) <= 0.0) {  // by rounding: the column depends on those that are used
      used.pop_back();
      is_refused[static_cast<std::size_t>(steepest)] = true;
      continue;
    }
    is_refused.assign(is_refused.size(), false);
    while (!used.empty() && free(used).minCoeff() <= 0.0) {
      step_to_border(free, u, used);
      free = used.empty() ? Eigen::VectorXd(Eigen::VectorXd::Zero(u.size())) : solve_used(matrix, right, used);
    }
    u = free;
  }
  return u;
}

LeastDistance least_distance(const Eigen::Ref<const Eigen::MatrixXd>& matrix,
                             const Eigen::Ref<const Eigen::VectorXd>& right) {
  require(matrix.rows() == right.size() && matrix.cols() > 0, "{} rows of a polyhedron but {} right-hand sides",
          matrix.rows(), right.size());
  LeastDistance result{true, Eigen::VectorXd::Zero(matrix.cols()), Eigen::VectorXd::Zero(matrix.rows())};
  if (matrix.rows() == 0 || right.maxCoeff() <= 0.0) return result;
  const double size = right.cwiseAbs().maxCoeff();  // near and far polyhedra lose no digits
  Eigen::MatrixXd stacked(matrix.cols() + 1, matrix.rows());
  stacked.topRows(matrix.cols()) = matrix.transpose();
  stacked.bottomRows(1) = right.transpose() / size;
  const Eigen::VectorXd target = Eigen::VectorXd::Unit(matrix.cols() + 1, matrix.cols());
  const Eigen::VectorXd u = non_negative_least_squares(stacked, target);
  const Eigen::VectorXd rest = target - stacked * u;
  const double gap = rest(matrix.cols());
  constexpr double k_empty = 1e-13;  // the nearest point would be some million times as far as the right-hand sides
  result.is_feasible = rest.squaredNorm() > k_empty && gap > k_empty;
  if (!result.is_feasible) return result;
  result.pressure = size * u / gap;
  result.point = matrix.transpose() * result.pressure;
  return result;
}

}  // namespace mottle::updating
