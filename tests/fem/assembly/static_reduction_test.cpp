// Static reduction against condensation by hand and by dense algebra.
#include "mottle/fem/assembly/static_reduction.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "core/message_of.hpp"
#include "fem/models.hpp"

namespace mottle::fem {
namespace {

using test::message_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A cantilever of beams with rotations and consistent masses; the tip carries a heavy body.
FiniteElementModel cantilever(int parts) {
  test::ModelMaker maker;
  maker.model.settings.coupled_mass = true;
  const int metal = maker.material(1, 7e10, 0.3, 2700.0);
  const int section = maker.beam_property(1, metal, 4e-4, 2e-8, 5e-9, 1e-8);
  for (int k = 0; k <= parts; ++k) maker.node(100 + k, {0.1 * k, 0, 0});
  for (int k = 0; k < parts; ++k) maker.beam(k + 1, k, k + 1, section);
  maker.point_mass(50, parts, 0.3);
  maker.model.fixed.emplace_back(0, k_all_components);
  return maker.model;
}

Eigen::MatrixXd full(const SparseMatrix& lower) {
  const Eigen::MatrixXd dense = lower;
  return dense.selfadjointView<Eigen::Lower>();
}

std::string row_name(int row) {
  return fmt::format("row {}", row);
}

/// lambda of T' K T and T' M T by dense algebra, with T as in the textbook.
Eigen::VectorXd condensed(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& mass,
                          const std::vector<bool>& is_omitted) {
  std::vector<int> kept, omitted;
  for (std::size_t k = 0; k < is_omitted.size(); ++k) (is_omitted[k] ? omitted : kept).push_back(static_cast<int>(k));
  Eigen::MatrixXd motion = Eigen::MatrixXd::Zero(stiffness.rows(), static_cast<Eigen::Index>(kept.size()));
  for (std::size_t k = 0; k < kept.size(); ++k) motion(kept[k], static_cast<Eigen::Index>(k)) = 1.0;
  const Eigen::MatrixXd inner = stiffness(omitted, omitted);
  motion(omitted, Eigen::all) = -inner.ldlt().solve(Eigen::MatrixXd(stiffness(omitted, kept)));
  const Eigen::MatrixXd k_reduced = motion.transpose() * stiffness * motion;
  const Eigen::MatrixXd m_reduced = motion.transpose() * mass * motion;
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(k_reduced, m_reduced).eigenvalues();
}

// The rounding of a condensation with K of condition 1e8 is below 1e-8.
TEST(StaticReduction, HasTheEigenvaluesOfTheCondensedMatrices) {
  FiniteElementModel model = cantilever(6);
  for (int node = 1; node <= 6; node += 2) model.analysis_set.emplace_back(node, Components{0b000111});
  const AssembledModel assembled = assemble(model, {});
  SparseMatrix stiffness = assembled.stiffness.at(Eigen::VectorXd());
  SparseMatrix mass = assembled.mass.at(Eigen::VectorXd());
  const Eigen::VectorXd expected = condensed(full(stiffness), full(mass), assembled.is_omitted);
  reduce_statically(stiffness, mass, assembled.is_omitted, row_name);
  // M^ is singular: the eigenvalues of M^ x = mu K x are 1 / lambda and zeros.
  const Eigen::VectorXd inverse =
      Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(full(mass), full(stiffness)).eigenvalues();
  ASSERT_EQ(expected.size(), 9);
  for (Eigen::Index k = 0; k < expected.size(); ++k) {
    EXPECT_NEAR(expected(k) * inverse(inverse.size() - 1 - k), 1.0, 1e-7) << k;
  }
  EXPECT_LT(inverse.head(inverse.size() - 9).cwiseAbs().maxCoeff(), 1e-12 * inverse.maxCoeff());
}

TEST(StaticReduction, LeavesBothMatricesInOnePattern) {
  FiniteElementModel model = cantilever(4);
  model.omitted_set.emplace_back(2, k_all_components);
  const AssembledModel assembled = assemble(model, {});
  SparseMatrix stiffness = assembled.stiffness.at(Eigen::VectorXd());
  SparseMatrix mass = assembled.mass.at(Eigen::VectorXd());
  const Eigen::MatrixXd before = full(stiffness);
  reduce_statically(stiffness, mass, assembled.is_omitted, row_name);
  EXPECT_EQ(full(stiffness), before);
  ASSERT_EQ(stiffness.nonZeros(), mass.nonZeros());
  for (Eigen::Index k = 0; k < mass.nonZeros(); ++k) {
    ASSERT_EQ(stiffness.innerIndexPtr()[k], mass.innerIndexPtr()[k]);
  }
}

TEST(StaticReduction, OmitsAllThatTheAnalysisSetDoesNotName) {
  test::ModelMaker maker;
  for (const int id : {1, 2, 3}) maker.scalar_point(id);
  maker.spring(1, 0, 0, 1, 0, 5.0);
  maker.spring(2, 1, 0, 2, 0, 5.0);
  maker.model.analysis_set.emplace_back(1, Components{1});
  EXPECT_THAT(assemble(maker.model, {}).is_omitted, ElementsAre(true, false, true));
  maker.model.analysis_set.clear();
  maker.model.omitted_set.emplace_back(1, Components{1});
  EXPECT_THAT(assemble(maker.model, {}).is_omitted, ElementsAre(false, true, false));
}

TEST(StaticReduction, KeepsItsPlaceWhenOthersAreConstrainedAutomatically) {
  test::ModelMaker maker;
  for (const int id : {1, 2, 3}) maker.scalar_point(id);
  maker.spring(1, 1, 0, 2, 0, 5.0);  // the first point has no stiffness
  maker.model.omitted_set.emplace_back(2, Components{1});
  EXPECT_THAT(assemble(maker.model, {}).is_omitted, ElementsAre(false, true));
}

TEST(StaticReduction, RefusesDegreesOfFreedomOfOtherSets) {
  FiniteElementModel model = cantilever(2);
  model.analysis_set.emplace_back(0, Components{1});
  EXPECT_THAT(message_of<InvalidInput>([&] { assemble(model, {}); }), HasSubstr("ASET: 100:+X is fixed by SPC"));
  model.analysis_set = {{2, Components{1}}};
  model.omitted_set = {{2, Components{1}}};
  EXPECT_THAT(message_of<InvalidInput>([&] { assemble(model, {}); }), HasSubstr("102:+X is in ASET and in OMIT"));
  model.omitted_set.clear();
  model.rigid_bodies.push_back({.id = 9, .independent = 1, .components = 1, .dependents = {2}});
  EXPECT_THAT(message_of<InvalidInput>([&] { assemble(model, {}); }), HasSubstr("ASET: 102:+X is dependent on others"));
}

TEST(StaticReduction, RefusesAMechanismAmongTheOmitted) {
  FiniteElementModel model = cantilever(3);
  model.fixed.clear();
  model.analysis_set = {{0, Components{0b000111}}};  // turns freely about the first node
  const AssembledModel assembled = assemble(model, {});
  SparseMatrix stiffness = assembled.stiffness.at(Eigen::VectorXd());
  SparseMatrix mass = assembled.mass.at(Eigen::VectorXd());
  EXPECT_THAT(message_of<InvalidInput>([&] { reduce_statically(stiffness, mass, assembled.is_omitted, row_name); }),
              HasSubstr("the omitted degrees of freedom can move where all others are held"));
}

}  // namespace
}  // namespace mottle::fem
