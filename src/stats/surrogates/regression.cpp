#include "mottle/stats/surrogates/regression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "mottle/core/error.hpp"
#include "stats/surrogates/tall_least_squares.hpp"

namespace mottle::stats {

namespace {

void require_regression_data(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                             const Eigen::Ref<const Eigen::MatrixXd>& outputs, Eigen::Index terms) {
  require(inputs.rows() == outputs.rows(), "regression: {} rows of inputs but {} rows of outputs", inputs.rows(),
          outputs.rows());
  require(inputs.cols() >= 1 && outputs.cols() >= 1, "regression: {} inputs and {} outputs, need at least 1 of each",
          inputs.cols(), outputs.cols());
  require(inputs.rows() >= terms + 2, "regression: {} samples cannot support {} terms and a constant; need at least {}",
          inputs.rows(), terms, terms + 2);
  require(inputs.allFinite(), "regression: an input is not finite");
  require(outputs.allFinite(), "regression: an output is not finite");
}

/// Columns less their means; what is mere rounding of a constant column becomes exactly zero.
Eigen::MatrixXd centred_columns(const Eigen::Ref<const Eigen::MatrixXd>& values, const Eigen::VectorXd& mean) {
  Eigen::MatrixXd centred = values.rowwise() - mean.transpose();
  for (Eigen::Index j = 0; j < values.cols(); ++j) {
    const double rounding = 16.0 * std::numeric_limits<double>::epsilon() * values.col(j).cwiseAbs().maxCoeff();
    if (centred.col(j).cwiseAbs().maxCoeff() <= rounding) centred.col(j).setZero();
  }
  return centred;
}

Eigen::VectorXd r_squared_of(const TallLeastSquares& fit) {
  return (fit.total_squares.array() > 0.0)
      .select(1.0 - fit.residual_squares.array() / fit.total_squares.array().max(std::numeric_limits<double>::min()),
              1.0);
}

Eigen::VectorXd residual_std_of(const TallLeastSquares& fit, Eigen::Index rows, Eigen::Index terms) {
  return (fit.residual_squares / static_cast<double>(rows - terms - 1)).cwiseSqrt();
}

}  // namespace

LinearRegression linear_regression(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                                   const Eigen::Ref<const Eigen::MatrixXd>& outputs) {
  const Eigen::Index samples = inputs.rows();
  const Eigen::Index input_count = inputs.cols();
  require_regression_data(inputs, outputs, input_count);
  LinearRegression result;
  result.centre = inputs.colwise().mean();
  result.intercept = outputs.colwise().mean();
  const Eigen::MatrixXd x = centred_columns(inputs, result.centre);
  const Eigen::MatrixXd y = centred_columns(outputs, result.intercept);
  const TallLeastSquares fit = solve_tall_least_squares(
      samples, input_count, outputs.cols(),
      [&](Eigen::Index begin, Eigen::Ref<Eigen::MatrixXd> block) {
        block.col(0).setOnes();
        block.middleCols(1, input_count) = x.middleRows(begin, block.rows());
        block.rightCols(y.cols()) = y.middleRows(begin, block.rows());
      },
      [](Eigen::Index input) { return fmt::format("regression: input column {} (from 0)", input); });
  result.sensitivity = fit.coefficients.transpose();
  result.residual_std = residual_std_of(fit, samples, input_count);
  result.standard_error = result.residual_std * fit.inverse_factor.rowwise().norm().transpose();
  result.r_squared = r_squared_of(fit);
  result.condition = fit.condition;
  const Eigen::MatrixXd orthonormal = x * fit.inverse_factor.triangularView<Eigen::Upper>();
  result.leverage = orthonormal.rowwise().squaredNorm().array() + 1.0 / static_cast<double>(samples);
  return result;
}

namespace {

/// Linear terms first, then for each input i its square and its products with the inputs after it.
struct QuadraticTerms {
  Eigen::Index inputs;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> pairs;

  explicit QuadraticTerms(Eigen::Index input_count) : inputs(input_count) {
    for (Eigen::Index i = 0; i < input_count; ++i) {
      for (Eigen::Index j = i; j < input_count; ++j) pairs.emplace_back(i, j);
    }
  }
  Eigen::Index count() const { return inputs + static_cast<Eigen::Index>(pairs.size()); }
  std::string name(Eigen::Index term) const {
    if (term < inputs) return fmt::format("regression: input column {} (from 0)", term);
    const auto& [i, j] = pairs[static_cast<std::size_t>(term - inputs)];
    return fmt::format("regression: the product of input columns {} and {} (from 0)", i, j);
  }
  void fill(const Eigen::Ref<const Eigen::MatrixXd>& x, Eigen::Ref<Eigen::MatrixXd> block) const {
    block.leftCols(inputs) = x;
    Eigen::Index column = inputs;
    for (const auto& [i, j] : pairs) block.col(column++) = x.col(i).cwiseProduct(x.col(j));
  }
  /// Second derivatives of one output from its coefficients [term].
  Eigen::MatrixXd hessian(const Eigen::Ref<const Eigen::VectorXd>& coefficients) const {
    Eigen::MatrixXd second(inputs, inputs);
    Eigen::Index term = inputs;
    for (const auto& [i, j] : pairs) {
      second(i, j) = coefficients[term++] * (i == j ? 2.0 : 1.0);
      second(j, i) = second(i, j);
    }
    return second;
  }
};

}  // namespace

QuadraticRegression quadratic_regression(const Eigen::Ref<const Eigen::MatrixXd>& inputs,
                                         const Eigen::Ref<const Eigen::MatrixXd>& outputs) {
  const QuadraticTerms terms(inputs.cols());
  require_regression_data(inputs, outputs, terms.count());
  QuadraticRegression result;
  result.centre = inputs.colwise().mean();
  const Eigen::VectorXd output_mean = outputs.colwise().mean();
  Eigen::MatrixXd x = centred_columns(inputs, result.centre);
  const Eigen::MatrixXd y = centred_columns(outputs, output_mean);
  // Inputs of very different size (Pa and mm) would make squares that no tolerance could compare.
  const Eigen::VectorXd scale = x.cwiseAbs().colwise().maxCoeff().transpose().unaryExpr(
      [](double largest) { return largest > 0.0 ? largest : 1.0; });
  x *= scale.cwiseInverse().asDiagonal();
  const TallLeastSquares fit = solve_tall_least_squares(
      inputs.rows(), terms.count(), outputs.cols(),
      [&](Eigen::Index begin, Eigen::Ref<Eigen::MatrixXd> block) {
        block.col(0).setOnes();
        terms.fill(x.middleRows(begin, block.rows()), block.middleCols(1, terms.count()));
        block.rightCols(y.cols()) = y.middleRows(begin, block.rows());
      },
      [&](Eigen::Index term) { return terms.name(term); });

  result.constant = output_mean + fit.output_mean - fit.coefficients.transpose() * fit.term_mean;
  result.residual_std = residual_std_of(fit, inputs.rows(), terms.count());
  result.r_squared = r_squared_of(fit);
  result.condition = fit.condition;
  const Eigen::VectorXd unscale = scale.cwiseInverse();
  result.sensitivity = fit.coefficients.topRows(inputs.cols()).transpose() * unscale.asDiagonal();
  const Eigen::VectorXd error_factor = fit.inverse_factor.topRows(inputs.cols()).rowwise().norm().cwiseProduct(unscale);
  result.standard_error = result.residual_std * error_factor.transpose();
  for (Eigen::Index o = 0; o < outputs.cols(); ++o) {
    result.hessian.push_back(unscale.asDiagonal() * terms.hessian(fit.coefficients.col(o)) * unscale.asDiagonal());
  }
  return result;
}

Eigen::VectorXd QuadraticRegression::predict(const Eigen::Ref<const Eigen::VectorXd>& x) const {
  require(x.size() == centre.size(), "x: {} inputs, the regression has {}", x.size(), centre.size());
  const Eigen::VectorXd step = x - centre;
  Eigen::VectorXd outputs = constant + sensitivity * step;
  for (Eigen::Index o = 0; o < outputs.size(); ++o) {
    outputs[o] += 0.5 * step.dot(hessian[static_cast<std::size_t>(o)] * step);
  }
  return outputs;
}

Eigen::MatrixXd QuadraticRegression::sensitivity_at(const Eigen::Ref<const Eigen::VectorXd>& x) const {
  require(x.size() == centre.size(), "x: {} inputs, the regression has {}", x.size(), centre.size());
  Eigen::MatrixXd slope = sensitivity;
  for (Eigen::Index o = 0; o < slope.rows(); ++o) {
    slope.row(o) += (hessian[static_cast<std::size_t>(o)] * (x - centre)).transpose();
  }
  return slope;
}

}  // namespace mottle::stats
