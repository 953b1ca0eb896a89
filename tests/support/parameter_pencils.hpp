// Structures of a few equations whose parameters stand in stiffness and mass by powers, for tests of proven ranges.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "mottle/core/random.hpp"
#include "mottle/model/eigenvalue_bounds.hpp"
#include "mottle/model/solvers/exact_solver.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/model/structures/matrix_structure.hpp"

namespace mottle::test {

using namespace model;  // of which these are the tests

inline SparseMatrix lower_triangle(const Eigen::MatrixXd& matrix) {
  SparseMatrix sparse(matrix.rows(), matrix.cols());
  for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
    for (Eigen::Index i = j; i < matrix.rows(); ++i) sparse.insert(i, j) = matrix(i, j);
  }
  sparse.makeCompressed();
  return sparse;
}

/// One product of powers of the parameters with its matrix.
struct PowerTerm {
  std::vector<ParameterPower> coefficient;
  Eigen::MatrixXd matrix;
};

/// Eigenvalues of the lowest modes of K(x), M(x), sums of such terms.
inline std::unique_ptr<StructureModel> model_of(const std::vector<PowerTerm>& stiffness,
                                                const std::vector<PowerTerm>& mass, const Eigen::VectorXd& reference,
                                                std::vector<int> modes) {
  std::vector<ScaledMatrix> k, m;
  for (const PowerTerm& term : stiffness) k.push_back({term.coefficient, lower_triangle(term.matrix)});
  for (const PowerTerm& term : mass) m.push_back({term.coefficient, lower_triangle(term.matrix)});
  auto structure = std::make_unique<MatrixStructure>(make_pencil(k, m, {}), reference);
  return std::make_unique<StructureModel>(std::make_unique<ExactSolver>(std::move(structure)),
                                          OutputSelection{.eigenvalues = std::move(modes)}, reference);
}

/// A structure of random positive semidefinite terms with powers from -1 to 3, and a box of its parameters.
struct RandomPencil {
  RandomPencil(std::uint64_t seed, std::uint32_t number)
      : stream({.seed = seed, .purpose = StreamPurpose::truth}, number) {
    order = 1 + static_cast<int>(3.0 * stream.uniform());
    parameters = 1 + static_cast<int>(3.0 * stream.uniform());
    box.lower.resize(parameters);
    box.upper.resize(parameters);
    for (int i = 0; i < parameters; ++i) {
      box.lower(i) = 0.5 + stream.uniform();
      box.upper(i) = box.lower(i) * (1.0 + 0.5 * stream.uniform() * stream.uniform());
    }
    model = model_of(terms(1.0), terms(0.5), box.middle(), {1});
  }

  Eigen::VectorXd inside() {
    Eigen::VectorXd x(parameters);
    for (int i = 0; i < parameters; ++i) x(i) = box.lower(i) + stream.uniform() * (box.upper(i) - box.lower(i));
    return x;
  }

  RandomStream stream;
  int order = 1, parameters = 1;
  ParameterBox box;
  std::unique_ptr<StructureModel> model;

 private:
  /// A definite constant, and terms of rank one.
  std::vector<PowerTerm> terms(double share) {
    std::vector<PowerTerm> terms{{{}, (0.2 + stream.uniform()) * Eigen::MatrixXd::Identity(order, order)}};
    for (int t = 0; t < 2 * parameters; ++t) {
      if (stream.uniform() > share) continue;
      std::vector<ParameterPower> coefficient;
      for (int i = 0; i < parameters; ++i) {
        const int power = static_cast<int>(5.0 * stream.uniform()) - 1;
        if (power != 0 && stream.uniform() < 0.7) coefficient.push_back({i, power});
      }
      Eigen::VectorXd y(order);
      for (double& entry : y) entry = 2.0 * stream.uniform() - 1.0;
      terms.push_back({coefficient, Eigen::MatrixXd(y * y.transpose())});
    }
    return terms;
  }
};

}  // namespace mottle::test
