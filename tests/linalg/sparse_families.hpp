// Families of sparse pencils that need no formula, and their modes by Eigen's dense solver.
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <random>
#include <vector>

#include "mottle/linalg/reduced/reduced_model.hpp"

namespace mottle::test {

using namespace linalg;  // of which these are the tests

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Entries = std::vector<Eigen::Triplet<double>>;

inline SparseMatrix matrix_of(int size, const Entries& entries) {
  SparseMatrix matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  matrix.makeCompressed();
  return matrix;
}

inline void add_spring(Entries& entries, int a, int b, double stiffness) {
  entries.emplace_back(a, a, stiffness);
  entries.emplace_back(b, b, stiffness);
  entries.emplace_back(std::max(a, b), std::min(a, b), -stiffness);
}

struct GridOptions {
  int length = 16;
  int width = 9;
  int patches = 4;  ///< strips along the length, each with a stiffness of its own
  bool is_free = false;
  bool moves_mass = false;  ///< the strips' masses are parameters too
  double coupling = 0.0;    ///< of an indefinite term: two patches couple with either sign
};

/// Masses in a rectangular grid, springs between neighbours, one edge held.
struct Family {
  PencilTerms terms;
  SparseMatrix stiffness, mass;  ///< at coefficients of one

  Index size() const { return terms.stiffness_constant.rows(); }
  TermCoefficients nominal() const { return constant(1, 1.0); }
  TermCoefficients constant(Index samples, double value) const {
    return {MatrixXd::Constant(static_cast<Index>(terms.stiffness.size()), samples, value),
            MatrixXd::Constant(static_cast<Index>(terms.mass.size()), samples, value)};
  }
  TermCoefficients lognormal(Index samples, double variation, unsigned seed) const {
    std::mt19937_64 random(seed);
    std::lognormal_distribution<double> distribution(0.0, variation);
    TermCoefficients result = constant(samples, 1.0);
    for (double& value : result.stiffness.reshaped()) value = distribution(random);
    for (double& value : result.mass.reshaped()) value = distribution(random);
    return result;
  }
};

inline Family grid(const GridOptions& options) {
  const int size = options.length * options.width;
  const auto number = [&](int i, int j) { return i * options.width + j; };
  const auto patch = [&](int i) { return static_cast<std::size_t>(i * options.patches / options.length); };
  const auto patches = static_cast<std::size_t>(options.patches);
  std::vector<Entries> springs(patches), masses(patches);
  Entries constant_springs, constant_masses, couplings;
  for (int i = 0; i < options.length; ++i) {
    for (int j = 0; j < options.width; ++j) {
      const int own = number(i, j);
      if (i + 1 < options.length) add_spring(springs[patch(i)], own, number(i + 1, j), 1.0);
      if (j + 1 < options.width) add_spring(springs[patch(i)], own, number(i, j + 1), 0.7);
      if (i == 0 && !options.is_free) constant_springs.emplace_back(own, own, 1.0);
      (options.moves_mass ? masses[patch(i)] : constant_masses).emplace_back(own, own, 1.0);
      if (options.coupling != 0.0 && i > 0) couplings.emplace_back(own, number(i - 1, j), options.coupling);
    }
  }
  Family family;
  family.terms.stiffness_constant = matrix_of(size, constant_springs);
  family.terms.mass_constant = matrix_of(size, constant_masses);
  for (const Entries& entries : springs) family.terms.stiffness.push_back(matrix_of(size, entries));
  if (options.coupling != 0.0) family.terms.stiffness.push_back(matrix_of(size, couplings));
  if (options.moves_mass) {
    for (const Entries& entries : masses) family.terms.mass.push_back(matrix_of(size, entries));
  }
  family.stiffness = family.terms.stiffness_constant;
  family.mass = family.terms.mass_constant;
  for (const SparseMatrix& term : family.terms.stiffness) family.stiffness += term;
  for (const SparseMatrix& term : family.terms.mass) family.mass += term;
  return family;
}

inline ReducedModel trained(const Family& family, const ReducedModelOptions& options, double variation) {
  ReducedModel model(family.terms, family.nominal(), family.stiffness, family.mass, options);
  model.train(family.lognormal(200, variation, 1), 1);
  return model;
}

struct Exact {
  VectorXd values;
  MatrixXd vectors;
};

/// By Eigen's dense solver of the full pencil.
inline Exact exact_modes(const Family& family, const TermCoefficients& samples, Index sample, int modes) {
  const auto sum = [&](SparseMatrix matrix, const std::vector<SparseMatrix>& terms, const MatrixXd& coefficients) {
    for (std::size_t t = 0; t < terms.size(); ++t) {
      matrix += coefficients(static_cast<Index>(t), sample) * terms[t];
    }
    return MatrixXd(matrix);
  };
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(
      sum(family.terms.stiffness_constant, family.terms.stiffness, samples.stiffness),
      sum(family.terms.mass_constant, family.terms.mass, samples.mass));
  return {solver.eigenvalues().head(modes), solver.eigenvectors().leftCols(modes)};
}

/// Two bars side by side without a link: their modes cross wherever their stiffnesses say.
inline Family two_bars(int length) {
  Family family;
  family.terms.stiffness_constant = SparseMatrix(2 * length, 2 * length);
  Entries masses;
  for (int bar = 0; bar < 2; ++bar) {
    Entries springs;
    springs.emplace_back(bar * length, bar * length, 1.0);
    for (int i = 0; i < length; ++i) {
      const int own = bar * length + i;
      if (i + 1 < length) add_spring(springs, own, own + 1, 1.0);
      masses.emplace_back(own, own, bar == 0 ? 1.0 : 1.02);
    }
    family.terms.stiffness.push_back(matrix_of(2 * length, springs));
  }
  family.terms.mass_constant = matrix_of(2 * length, masses);
  family.stiffness = family.terms.stiffness[0] + family.terms.stiffness[1];
  family.mass = family.terms.mass_constant;
  return family;
}

}  // namespace mottle::test
