// A stiff structure on a soft suspension: what is left of its stiffness in the lowest mode is 10^-11 of the largest
// terms, so that double precision alone leaves five digits.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "linalg/sparse_families.hpp"

namespace mottle::linalg {
namespace {

using Eigen::Index;
using test::Entries;
using test::Family;

constexpr int k_masses = 160, k_modes = 4;

/// A chain whose two halves are parameters, on springs at its ends, which are another one; the halves' masses too if
/// they move.
Family suspended_chain(bool moves_mass = false) {
  Entries soft{{0, 0, 1e4}, {k_masses - 1, k_masses - 1, 1e4}}, halves[2], masses, heavy[2];
  for (int i = 0; i + 1 < k_masses; ++i) test::add_spring(halves[2 * i / k_masses], i, i + 1, 1e12);
  for (int i = 0; i < k_masses; ++i) (moves_mass ? heavy[2 * i / k_masses] : masses).emplace_back(i, i, 1.0);
  Family family;
  family.terms.stiffness_constant = test::matrix_of(k_masses, {});
  family.terms.mass_constant = family.mass = test::matrix_of(k_masses, masses);
  for (const Entries& entries : heavy) {
    if (moves_mass) family.terms.mass.push_back(test::matrix_of(k_masses, entries));
  }
  for (const SparseMatrix& term : family.terms.mass) family.mass += term;
  for (const Entries& entries : {soft, halves[0], halves[1]}) {
    family.terms.stiffness.push_back(test::matrix_of(k_masses, entries));
  }
  family.stiffness = family.terms.stiffness_constant;
  for (const SparseMatrix& term : family.terms.stiffness) family.stiffness += term;
  return family;
}

/// The lowest eigenvalues by Eigen's dense solver in extended precision, assembled in it too.
Eigen::VectorXd exact_values(const Family& family, const Eigen::VectorXd& coefficients) {
  using Long = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  Long stiffness = Long::Zero(k_masses, k_masses);
  for (std::size_t t = 0; t < family.terms.stiffness.size(); ++t) {
    stiffness += static_cast<long double>(coefficients(static_cast<Index>(t))) *
                 Eigen::MatrixXd(family.terms.stiffness[t]).cast<long double>();
  }
  return Eigen::SelfAdjointEigenSolver<Long>(stiffness, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .head(k_modes)
      .cast<double>();
}

TEST(SoftSuspension, TheLowestModeIsWithinItsOwnBound) {
  constexpr double k_tolerance = 1e-5;
  constexpr double k_rounding = 1e-8;  // 2^-64 of the largest term over lambda is 2e-9
  const Family family = suspended_chain();
  const ReducedModel model = test::trained(family, {.modes = k_modes, .tolerance = k_tolerance}, 0.5);
  for (const double variation : {0.1, 0.8}) {  // near samples are iterated, far ones solved by the whole reduced pencil
    const TermCoefficients samples = family.lognormal(6, variation, 2);
    const CertifiedModes found = model.solve(samples, 1);
    for (Index s = 0; s < samples.samples(); ++s) {
      const Eigen::VectorXd exact = exact_values(family, samples.stiffness.col(s));
      for (int k = 0; k < k_modes; ++k) {
        const double error = found.values(k, s) / exact(k) - 1.0;
        EXPECT_GT(error, -k_rounding) << "sample " << s << ", mode " << k;
        EXPECT_LT(error, found.bounds(k, s) + k_rounding) << "sample " << s << ", mode " << k;
      }
      EXPECT_LT(found.bounds(0, s), 10.0 * k_tolerance) << "of the lowest mode, relative to itself";
    }
  }
}

TEST(SoftSuspension, RefinedModesAreWithinTheirBoundsToo) {
  constexpr double k_rounding = 1e-8;
  const Family family = suspended_chain();
  const ReducedModel model = test::trained(family, {.modes = k_modes, .tolerance = 1e-5}, 0.05);
  const TermCoefficients samples = family.lognormal(6, 0.6, 3);
  model.refine(samples, 1, [&](Index s, const RefinedModes& found) {
    if (found.vectors.size() == 0) return;
    const Eigen::VectorXd exact = exact_values(family, samples.stiffness.col(s));
    for (int k = 0; k < k_modes; ++k) {
      const double error = found.values(k) / exact(k) - 1.0;
      EXPECT_GT(error, -k_rounding) << "sample " << s << ", mode " << k;
      EXPECT_LT(error, found.bounds(k) + k_rounding) << "sample " << s << ", mode " << k;
    }
  });
}

TEST(SoftSuspension, TheResolutionOfItsModesIsStated) {
  const Family family = suspended_chain();
  const ReducedModel model(family.terms, family.nominal(), family.stiffness, family.mass, {.modes = k_modes});
  const Eigen::MatrixXd& resolution = model.resolution();
  ASSERT_EQ(resolution.rows(), k_modes);
  // The chain moves as a whole: phi = 1 / sqrt(n) everywhere, |K| sums to 4 k a mass.
  EXPECT_NEAR(resolution(0, 0), 2e4 / k_masses, 1e-2 * resolution(0, 0));
  EXPECT_NEAR(resolution(0, 1), 2.2204e-16 * 4e12, 0.02 * resolution(0, 1));
}

TEST(SoftSuspension, MassesAreDefiniteHoweverManyModesAreFollowed) {
  const Family family = suspended_chain(true);
  const ReducedModel model = test::trained(family, {.modes = 30, .tolerance = 1e-4}, 0.2);
  EXPECT_FALSE(model.has_indefinite_terms());
  EXPECT_LT(model.solve(family.lognormal(20, 0.2, 2), 1).bounds.maxCoeff(), 1e-3);
}

}  // namespace
}  // namespace mottle::linalg
