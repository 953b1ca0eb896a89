// Least-squares regression of a model's outputs on its inputs over a cloud of samples: linear, or with all squares
// and interactions. Its slope is the sensitivity that the updating methods use.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::stats {

/// y(x) = intercept + sensitivity (x - centre) and how well it holds.
struct LinearRegression {
  Eigen::VectorXd intercept;       ///< [output], value at the centre: the mean of Y
  Eigen::VectorXd centre;          ///< [input], the mean of X
  Eigen::MatrixXd sensitivity;     ///< [output x input], G = dy/dx
  Eigen::MatrixXd standard_error;  ///< [output x input], of the sensitivity
  Eigen::VectorXd r_squared;       ///< [output], 1 - residual / total sum of squares; 1 for an output without scatter
  Eigen::VectorXd residual_std;    ///< [output], residual sum of squares / (n - inputs - 1), square root
  double condition = 0.0;          ///< of the centred X with columns scaled to one length
  Eigen::VectorXd leverage;        ///< [sample], diagonal of the hat matrix; sums to inputs + 1
};

/// Linear regression Y = 1 a' + X B + E, G = B'.
///
/// Least squares by Householder QR of the centred columns, taken block of rows by block of rows; the normal equations,
/// which square the condition number, are never formed.
///
/// @param inputs   X [sample x input], at least inputs + 2 rows, no nan
/// @param outputs  Y [sample x output], the same rows
/// @throws InvalidInput  row counts differ, too few samples, an entry not finite, or inputs that do not vary or depend
///                       linearly on one another (names a column that may go, by index from 0)
/// Source: [Mares2006], Eqs. 13-18; [Demmel2012] for QR by blocks of rows.
LinearRegression linear_regression(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                                   const Eigen::Ref<const Eigen::MatrixXd>& outputs);

/// y_o(x) = constant_o + sensitivity_o d + d' hessian_o d / 2, d = x - centre.
struct QuadraticRegression {
  Eigen::VectorXd centre;                ///< [input], the mean of X
  Eigen::VectorXd constant;              ///< [output], value at the centre
  Eigen::MatrixXd sensitivity;           ///< [output x input], slope at the centre
  Eigen::MatrixXd standard_error;        ///< [output x input], of the sensitivity
  std::vector<Eigen::MatrixXd> hessian;  ///< one [input x input] an output
  Eigen::VectorXd r_squared;             ///< [output], as in LinearRegression
  Eigen::VectorXd residual_std;          ///< [output], as in LinearRegression with the number of terms for inputs
  double condition = 0.0;                ///< of the centred columns of all terms, scaled to one length

  /// The fitted outputs at x [input].
  Eigen::VectorXd predict(const Eigen::Ref<const Eigen::VectorXd>& x) const;
  /// The fitted slope at x: sensitivity_o + hessian_o (x - centre), [output x input].
  Eigen::MatrixXd sensitivity_at(const Eigen::Ref<const Eigen::VectorXd>& x) const;
};

/// Regression with all linear, square and interaction terms, centred at the mean of X and scaled inside.
///
/// @param inputs   X [sample x input], at least terms + 2 rows, terms = inputs (inputs + 3) / 2
/// @param outputs  Y [sample x output]
/// @throws InvalidInput  as linear_regression; a dependent term is named by its columns
/// Source: [Mares2006], section 3.2, the extension it names; [Box2007], ch. 7.
QuadraticRegression quadratic_regression(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                                         const Eigen::Ref<const Eigen::MatrixXd>& outputs);

}  // namespace mottle::stats
