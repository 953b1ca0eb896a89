// Least squares with many rows and few columns from one triangular factor; knows nothing of what the terms mean.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

#include "mottle/layers.hpp"

namespace mottle::stats {

/// Writes rows begin .. begin + block.rows() of a tall matrix into `block`.
using FillRows = std::function<void(Eigen::Index begin, Eigen::Ref<Eigen::MatrixXd> block)>;

/// Triangular factor R of A = QR for a tall A that is only ever seen a block of rows at a time.
/// Source: [Demmel2012], the sequential case.
Eigen::MatrixXd tall_triangular_factor(Eigen::Index rows, Eigen::Index columns, const FillRows& fill);

/// Solution of min ||Y - 1 a' - T B||.
struct TallLeastSquares {
  Eigen::VectorXd term_mean;         ///< [term], of T as given
  Eigen::VectorXd output_mean;       ///< [output], of Y as given
  Eigen::MatrixXd coefficients;      ///< B [term x output]
  Eigen::MatrixXd inverse_factor;    ///< R^-1 of the centred T: (T'T)^-1 = inverse_factor inverse_factor'
  Eigen::VectorXd residual_squares;  ///< [output]
  Eigen::VectorXd total_squares;     ///< [output], about the mean
  double condition = 0.0;            ///< of the centred T with columns scaled to one length
};

/// Solves from the rows [1 | T | Y]. T and Y should come roughly centred: the column of ones removes what is left.
///
/// @param rows, terms, outputs  sizes; rows >= terms + 2
/// @param fill                  writes rows of [1 | T | Y]
/// @param term_name             what to call term i in an error
/// @throws InvalidInput         a term that does not vary or depends on the others, by its name
TallLeastSquares solve_tall_least_squares(Eigen::Index rows, Eigen::Index terms, Eigen::Index outputs,
                                          const FillRows& fill,
                                          const std::function<std::string(Eigen::Index)>& term_name);

}  // namespace mottle::stats
