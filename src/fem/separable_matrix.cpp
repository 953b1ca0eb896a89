#include "mottle/fem/separable_matrix.hpp"

#include <cmath>

namespace mottle {
namespace {

void add_term(SparseMatrix& sum, const SeparableMatrix::Term& term, double coefficient) {
  double* values = sum.valuePtr();
  for (std::size_t k = 0; k < term.positions.size(); ++k) values[term.positions[k]] += coefficient * term.values[k];
}

}  // namespace

SparseMatrix SeparableMatrix::at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  SparseMatrix sum = pattern;
  for (const Term& term : terms) {
    double coefficient = 1.0;
    for (const ParameterPower& factor : term.coefficient) {
      coefficient *= std::pow(parameters(factor.parameter), factor.power);
    }
    add_term(sum, term, coefficient);
  }
  return sum;
}

SparseMatrix SeparableMatrix::derivative(const Eigen::Ref<const Eigen::VectorXd>& parameters, int parameter) const {
  SparseMatrix sum = pattern;
  for (const Term& term : terms) {
    double coefficient = 0.0;
    double others = 1.0;
    for (const ParameterPower& factor : term.coefficient) {
      const double x = parameters(factor.parameter);
      if (factor.parameter == parameter) {
        coefficient = factor.power * std::pow(x, factor.power - 1);
      } else {
        others *= std::pow(x, factor.power);
      }
    }
    if (coefficient != 0.0) add_term(sum, term, coefficient * others);
  }
  return sum;
}

}  // namespace mottle
