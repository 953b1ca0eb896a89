#include "mottle/fem/assembly/separable_matrix.hpp"

#include <algorithm>
#include <cmath>

namespace mottle::fem {
namespace {

void add_term(SparseMatrix& sum, const SeparableMatrix::Term& term, double coefficient) {
  double* values = sum.valuePtr();
  for (std::size_t k = 0; k < term.positions.size(); ++k) values[term.positions[k]] += coefficient * term.values[k];
}

double coefficient_of(const SeparableMatrix::Term& term, const Eigen::Ref<const Eigen::VectorXd>& parameters) {
  double coefficient = 1.0;
  for (const ParameterPower& factor : term.coefficient) {
    coefficient *= std::pow(parameters(factor.parameter), factor.power);
  }
  return coefficient;
}

void split(const SeparableMatrix& sum, SparseMatrix& constant, std::vector<SparseMatrix>& terms,
           std::vector<bool>& is_semidefinite) {
  constant = SparseMatrix(sum.pattern.rows(), sum.pattern.cols());
  is_semidefinite.assign(1, true);
  for (const SeparableMatrix::Term& term : sum.terms) {
    if (term.coefficient.empty()) {
      constant = sum.matrix_of(term);
      is_semidefinite[0] = term.is_semidefinite;
    } else {
      is_semidefinite.push_back(term.is_semidefinite);
      terms.push_back(sum.matrix_of(term));
    }
  }
}

Eigen::MatrixXd coefficients(const SeparableMatrix& sum, const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  const auto varies = [](const SeparableMatrix::Term& term) { return !term.coefficient.empty(); };
  Eigen::MatrixXd result(std::count_if(sum.terms.begin(), sum.terms.end(), varies), samples.rows());
  for (Eigen::Index s = 0; s < samples.rows(); ++s) {
    const Eigen::VectorXd parameters = samples.row(s).transpose();
    Eigen::Index t = 0;
    for (const SeparableMatrix::Term& term : sum.terms) {
      if (varies(term)) result(t++, s) = coefficient_of(term, parameters);
    }
  }
  return result;
}

}  // namespace

SparseMatrix SeparableMatrix::at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  SparseMatrix sum = pattern;
  for (const Term& term : terms) add_term(sum, term, coefficient_of(term, parameters));
  return sum;
}

SparseMatrix SeparableMatrix::matrix_of(const Term& term) const {
  SparseMatrix matrix(pattern.rows(), pattern.cols());
  matrix.reserve(static_cast<Eigen::Index>(term.positions.size()));
  std::size_t k = 0;
  for (Eigen::Index column = 0; column < pattern.cols(); ++column) {
    matrix.startVec(column);
    for (; k < term.positions.size() && term.positions[k] < pattern.outerIndexPtr()[column + 1]; ++k) {
      matrix.insertBackByOuterInner(column, pattern.innerIndexPtr()[term.positions[k]]) = term.values[k];
    }
  }
  matrix.finalize();
  return matrix;
}

bool SeparableMatrix::is_semidefinite_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  return std::ranges::all_of(terms, [&](const Term& term) {
    const double coefficient = coefficient_of(term, parameters);
    return coefficient == 0.0 || (coefficient > 0.0 && term.is_semidefinite);
  });
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

PencilTerms pencil_terms(const SeparableMatrix& stiffness, const SeparableMatrix& mass) {
  PencilTerms terms;
  split(stiffness, terms.stiffness_constant, terms.stiffness, terms.is_stiffness_semidefinite);
  split(mass, terms.mass_constant, terms.mass, terms.is_mass_semidefinite);
  return terms;
}

TermCoefficients term_coefficients(const SeparableMatrix& stiffness, const SeparableMatrix& mass,
                                   const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  return {coefficients(stiffness, samples), coefficients(mass, samples)};
}

}  // namespace mottle::fem
