// Families of pencils for the tests of linalg, and a fixture that runs a test at each register width.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "mottle/linalg/batched/batch_eigen.hpp"
#include "mottle/linalg/sparse/symmetric_factor.hpp"

namespace mottle::linalg_test {

using namespace linalg;

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Lower triangle of a dense symmetric matrix without its zeros, compressed.
inline SparseMatrix lower_of(const MatrixXd& dense) {
  SparseMatrix sparse = MatrixXd(dense.triangularView<Eigen::Lower>()).sparseView();
  sparse.makeCompressed();
  return sparse;
}

inline MatrixXd random_symmetric(Index order, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  MatrixXd matrix(order, order);
  for (double& entry : matrix.reshaped()) entry = normal(random);
  return matrix + matrix.transpose();
}

/// Positive definite with condition number of about 10.
inline MatrixXd random_definite(Index order, std::mt19937_64& random) {
  const MatrixXd matrix = random_symmetric(order, random) / std::sqrt(static_cast<double>(order));
  return matrix * matrix / 4.0 + 0.5 * MatrixXd::Identity(order, order);
}

inline MatrixXd uniform(Index rows, Index columns, double low, double high, std::mt19937_64& random) {
  std::uniform_real_distribution<double> distribution(low, high);
  MatrixXd matrix(rows, columns);
  for (double& entry : matrix.reshaped()) entry = distribution(random);
  return matrix;
}

/// Chain of n unit masses and unit springs, first mass tied to the ground.
inline MatrixXd fixed_free_chain(Index order) {
  MatrixXd stiffness = MatrixXd::Zero(order, order);
  for (Index i = 0; i < order; ++i) {
    stiffness(i, i) = i + 1 < order ? 2.0 : 1.0;
    if (i > 0) stiffness(i, i - 1) = stiffness(i - 1, i) = -1.0;
  }
  return stiffness;
}

enum class Mass { identity, constant_diagonal, constant_full, parametric_diagonal, parametric_full };

inline PencilFamily random_family(Index order, int terms, Mass mass, std::mt19937_64& random) {
  PencilFamily family{random_definite(order, random), {}, MatrixXd::Identity(order, order), {}};
  for (int i = 0; i < terms; ++i) family.stiffness_terms.push_back(random_definite(order, random));
  const auto diagonal = [&] { return MatrixXd(uniform(order, 1, 0.5, 2.0, random).col(0).asDiagonal()); };
  if (mass == Mass::constant_diagonal || mass == Mass::parametric_diagonal) family.mass_constant = diagonal();
  if (mass == Mass::constant_full || mass == Mass::parametric_full)
    family.mass_constant = random_definite(order, random);
  if (mass == Mass::parametric_diagonal) family.mass_terms = {diagonal(), diagonal()};
  if (mass == Mass::parametric_full) family.mass_terms = {random_definite(order, random), diagonal()};
  return family;
}

inline MatrixXd combined(const MatrixXd& constant, const std::vector<MatrixXd>& terms, const VectorXd& coefficients) {
  MatrixXd sum = constant;
  for (std::size_t i = 0; i < terms.size(); ++i) sum += coefficients(static_cast<Index>(i)) * terms[i];
  return sum;
}

struct Batch {
  PencilFamily family;
  MatrixXd stiffness_coefficients;
  MatrixXd mass_coefficients;

  MatrixXd stiffness(Index sample) const {
    return combined(family.stiffness_constant, family.stiffness_terms, stiffness_coefficients.col(sample));
  }
  MatrixXd mass(Index sample) const {
    if (family.mass_terms.empty()) return family.mass_constant;
    return combined(family.mass_constant, family.mass_terms, mass_coefficients.col(sample));
  }
  BatchModes solve(const BatchEigenOptions& options = {}) const {
    return solve_batch(family, stiffness_coefficients, mass_coefficients, options);
  }
};

inline Batch random_batch(Index order, Mass mass, Index samples, std::mt19937_64& random) {
  Batch batch{random_family(order, 5, mass, random), uniform(5, samples, 0.2, 2.0, random), {}};
  batch.mass_coefficients = uniform(static_cast<Index>(batch.family.mass_terms.size()), samples, 0.2, 2.0, random);
  return batch;
}

/// The same pencil in every sample, without terms.
inline Batch repeated(const MatrixXd& stiffness, const MatrixXd& mass, Index samples) {
  return {{stiffness, {}, mass, {}}, MatrixXd(0, samples), MatrixXd(0, samples)};
}

/// Every test of the kernels runs at each register width that this processor has.
class AtEveryLevel : public testing::TestWithParam<SimdLevel> {
 protected:
  void SetUp() override {
    if (!is_simd_level_available(GetParam())) GTEST_SKIP() << "this processor lacks the level";
  }
  BatchEigenOptions options(int modes = 0, bool vectors = true, int threads = 1) const {
    return {.modes = modes, .vectors = vectors, .threads = threads, .simd = GetParam()};
  }
};

inline std::string level_name(const testing::TestParamInfo<SimdLevel>& level) {
  return std::array{"automatic", "plain", "avx2", "avx512"}[static_cast<std::size_t>(level.param)];
}

inline auto every_level() {
  return testing::Values(SimdLevel::plain, SimdLevel::avx2, SimdLevel::avx512);
}

}  // namespace mottle::linalg_test
