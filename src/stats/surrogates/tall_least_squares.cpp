#include "stats/surrogates/tall_least_squares.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::stats {

Eigen::MatrixXd tall_triangular_factor(Eigen::Index rows, Eigen::Index columns, const FillRows& fill) {
  // Long enough to make the stacked factor a small fraction of the work, short enough for the second-level cache.
  const Eigen::Index block_rows = std::max<Eigen::Index>(4 * columns, 1024);
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(columns, columns);
  Eigen::MatrixXd stacked;
  Eigen::HouseholderQR<Eigen::MatrixXd> qr;
  for (Eigen::Index begin = 0; begin < rows; begin += block_rows) {
    const Eigen::Index count = std::min(block_rows, rows - begin);
    stacked.resize(columns + count, columns);
    stacked.topRows(columns) = factor;
    fill(begin, stacked.bottomRows(count));
    qr.compute(stacked);
    factor = qr.matrixQR().topRows(columns).triangularView<Eigen::Upper>();
  }
  return factor;
}

namespace {

/// `factor` with columns scaled to length 1 (scales in `length`). Throws where they are dependent.
Eigen::MatrixXd independent_unit_columns(const Eigen::MatrixXd& factor, Eigen::Index rows, Eigen::VectorXd& length,
                                         const std::function<std::string(Eigen::Index)>& term_name) {
  length = factor.colwise().norm();
  for (Eigen::Index i = 0; i < length.size(); ++i) {
    require(length[i] > 0.0, "{} does not vary over the {} samples", term_name(i), rows);
  }
  Eigen::MatrixXd scaled = factor * length.cwiseInverse().asDiagonal();
  const PivotedQr pivoted(scaled);
  const Eigen::VectorXd pivots = pivoted.diagonal();
  const double tolerance = static_cast<double>(rows) * std::numeric_limits<double>::epsilon();
  for (Eigen::Index i = 0; i < length.size(); ++i) {
    require(std::abs(pivots(i)) > tolerance,
            "{} depends linearly on the others over the {} samples; leave one of them out",
            term_name(pivoted.column(i)), rows);
  }
  return scaled;
}

/// Largest singular value. Squared, the largest is as accurate as ever; the smallest, lost so, is had from the inverse.
double spectral_norm(const Eigen::MatrixXd& matrix) {
  return std::sqrt(symmetric_eigenvalues(matrix.transpose() * matrix).maxCoeff());
}

}  // namespace

TallLeastSquares solve_tall_least_squares(Eigen::Index rows, Eigen::Index terms, Eigen::Index outputs,
                                          const FillRows& fill,
                                          const std::function<std::string(Eigen::Index)>& term_name) {
  require(rows >= terms + 2, "{} samples cannot support {} terms and a constant; need at least {}", rows, terms,
          terms + 2);
  // With R = [r11 r1T r1Y; 0 RT RTY; 0 0 RY] of [1 | T | Y]: RT B = RTY, and the columns of RY hold the residuals.
  const Eigen::MatrixXd factor = tall_triangular_factor(rows, 1 + terms + outputs, fill);
  const auto term_factor = factor.block(1, 1, terms, terms);

  TallLeastSquares solution;
  solution.term_mean = factor.row(0).segment(1, terms).transpose() / factor(0, 0);
  solution.output_mean = factor.row(0).tail(outputs).transpose() / factor(0, 0);
  solution.residual_squares = factor.bottomRightCorner(outputs, outputs).colwise().squaredNorm();
  solution.total_squares = factor.bottomRightCorner(terms + outputs, outputs).colwise().squaredNorm();
  if (terms == 0) return solution;

  Eigen::VectorXd length;
  const Eigen::MatrixXd scaled = independent_unit_columns(term_factor, rows, length, term_name);
  const auto triangle = scaled.triangularView<Eigen::Upper>();
  solution.coefficients =
      length.cwiseInverse().asDiagonal() * triangle.solve(factor.block(1, 1 + terms, terms, outputs));
  const Eigen::MatrixXd inverse = triangle.solve(Eigen::MatrixXd::Identity(terms, terms));
  solution.inverse_factor = length.cwiseInverse().asDiagonal() * inverse;
  solution.condition = spectral_norm(scaled.triangularView<Eigen::Upper>()) * spectral_norm(inverse);
  return solution;
}

}  // namespace mottle::stats
