#include "model/parameter_pencils.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "mottle/linalg/batched/dense_modes.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/linalg/reduced/semidefinite.hpp"
#include "mottle/model/solvers/exact_solver.hpp"
#include "mottle/model/structures/dense_structure.hpp"
#include "mottle/model/structures/sparse_structure.hpp"

namespace mottle::model {
namespace {

constexpr double k_epsilon = std::numeric_limits<double>::epsilon();

bool is_dense_semidefinite(const Eigen::MatrixXd& matrix) {
  const double size = matrix.cwiseAbs().maxCoeff();
  return symmetric_eigenvalues(matrix)(0) >= -4.0 * static_cast<double>(matrix.rows()) * k_epsilon * size;
}

/// Of a few masses: full matrices, linear in the parameters.
class DenseParameterPencils final : public ParameterPencils {
 public:
  explicit DenseParameterPencils(const DenseStructure& structure) {
    take(structure.matrices().stiffness, structure.parameter_count(), "the stiffness", stiffness_, powers_of_stiffness);
    take(structure.matrices().mass, structure.parameter_count(), "the mass", mass_, powers_of_mass);
  }

  PencilEigenvalues solve(const Eigen::VectorXd& stiffness, const Eigen::VectorXd& mass, int modes) const override {
    const Eigen::MatrixXd m = sum(mass_, mass);
    const auto solved = solve_modes(sum(stiffness_, stiffness), m, 0);
    const Eigen::VectorXd masses = symmetric_eigenvalues(m);
    // Backward error of the Cholesky reduction, with the condition of the masses.
    const double error = 32.0 * static_cast<double>(m.rows()) * k_epsilon * masses(masses.size() - 1) / masses(0) *
                         solved.values.cwiseAbs().maxCoeff();
    return {solved.values.head(modes), Eigen::VectorXd::Constant(modes, error)};
  }

 private:
  void take(const AffineMatrix& matrix, Eigen::Index parameters, const char* name, std::vector<Eigen::MatrixXd>& terms,
            Eigen::MatrixXi& powers) {
    powers = Eigen::MatrixXi::Zero(static_cast<Eigen::Index>(matrix.terms.size()) + 1, parameters);
    terms.push_back(matrix.constant);
    for (std::size_t t = 0; t < matrix.terms.size(); ++t) {
      terms.push_back(matrix.terms[t].matrix);
      powers(static_cast<Eigen::Index>(t) + 1, matrix.terms[t].parameter) = 1;
    }
    if (terms.front().isZero(0.0)) {  // it would only hide a power that all terms have in common
      terms.erase(terms.begin());
      powers = powers.bottomRows(powers.rows() - 1).eval();
    }
    if (!std::ranges::all_of(terms, is_dense_semidefinite)) indefinite = name;
  }

  static Eigen::MatrixXd sum(const std::vector<Eigen::MatrixXd>& terms, const Eigen::VectorXd& coefficients) {
    Eigen::MatrixXd total = coefficients(0) * terms[0];
    for (std::size_t t = 1; t < terms.size(); ++t) total += coefficients(static_cast<Eigen::Index>(t)) * terms[t];
    return total;
  }

  std::vector<Eigen::MatrixXd> stiffness_, mass_;
};

/// Of a finite-element model or of matrices from files.
class SparseParameterPencils final : public ParameterPencils {
 public:
  explicit SparseParameterPencils(const SparseStructure& structure)
      : stiffness_(structure.stiffness_terms()), mass_(structure.mass_terms()) {
    const PencilTerms terms = pencil_terms(stiffness_, mass_);
    powers_of_stiffness = powers_of(stiffness_, structure.parameter_count());
    powers_of_mass = powers_of(mass_, structure.parameter_count());
    const auto check = [&](const SparseMatrix& constant, const std::vector<SparseMatrix>& others,
                           const std::vector<bool>& known, const char* name) {
      if (constant.nonZeros() > 0 && !known[0] && !is_semidefinite(constant)) indefinite = name;
      for (std::size_t t = 0; t < others.size(); ++t) {
        if (!known[t + 1] && !is_semidefinite(others[t])) indefinite = name;
      }
    };
    check(terms.stiffness_constant, terms.stiffness, terms.is_stiffness_semidefinite, "the stiffness");
    check(terms.mass_constant, terms.mass, terms.is_mass_semidefinite, "the mass");
  }

  PencilEigenvalues solve(const Eigen::VectorXd& stiffness, const Eigen::VectorXd& mass, int modes) const override {
    constexpr double k_solver_error = 1e-9;  // ten times the tolerance that the solver is given
    constexpr double k_rounding = 1e-14;     // of the entries' sums over elements
    const SparseStructure::Matrices matrices{sum(stiffness_, stiffness), sum(mass_, mass)};
    const SparseModes solved = pool_.solve(
        matrices,
        {.modes = modes, .counts_below = true, .is_mass_semidefinite = indefinite.empty() && mass.minCoeff() >= 0.0});
    if (!solved.failure.empty() || solved.values.size() < modes || !solved.is_complete()) {
      const Eigen::VectorXd none = Eigen::VectorXd::Constant(modes, std::numeric_limits<double>::quiet_NaN());
      return {none, none};
    }
    const Eigen::VectorXd values = solved.values.head(modes);
    const Eigen::MatrixXd shapes = solved.vectors.leftCols(modes);
    const Eigen::VectorXd terms = sums_of_terms(matrices.stiffness, shapes) +
                                  values.cwiseAbs().cwiseProduct(sums_of_terms(matrices.mass, shapes));
    return {values, k_solver_error * values.cwiseAbs() + k_rounding * terms};
  }

 private:
  static Eigen::MatrixXi powers_of(const SeparableMatrix& matrix, Eigen::Index parameters) {
    Eigen::MatrixXi powers = Eigen::MatrixXi::Zero(static_cast<Eigen::Index>(matrix.terms.size()), parameters);
    for (std::size_t t = 0; t < matrix.terms.size(); ++t) {
      for (const auto& factor : matrix.terms[t].coefficient) {
        powers(static_cast<Eigen::Index>(t), factor.parameter) = factor.power;
      }
    }
    return powers;
  }

  static SparseMatrix sum(const SeparableMatrix& matrix, const Eigen::VectorXd& coefficients) {
    SparseMatrix total = matrix.pattern;
    for (std::size_t t = 0; t < matrix.terms.size(); ++t) {
      const SeparableMatrix::Term& term = matrix.terms[t];
      const double coefficient = coefficients(static_cast<Eigen::Index>(t));
      for (std::size_t k = 0; k < term.positions.size(); ++k) {
        total.valuePtr()[term.positions[k]] += coefficient * term.values[k];
      }
    }
    return total;
  }

  const SeparableMatrix& stiffness_;
  const SeparableMatrix& mass_;
  mutable SparseModeSolverPool pool_;  // changes no number
};

}  // namespace

std::unique_ptr<const ParameterPencils> make_parameter_pencils(const Structure& structure) {
  if (const auto* dense = dynamic_cast<const DenseStructure*>(&structure))
    return std::make_unique<DenseParameterPencils>(*dense);
  const auto* sparse = dynamic_cast<const SparseStructure*>(&structure);
  if (sparse == nullptr || !sparse->is_separable()) return nullptr;
  return std::make_unique<SparseParameterPencils>(*sparse);
}

}  // namespace mottle::model
