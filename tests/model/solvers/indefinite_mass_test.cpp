// Samples whose mass matrix is indefinite fail with row and value, however they are solved.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "core/message_of.hpp"
#include "fem/models.hpp"
#include "model/structures.hpp"
#include "mottle/core/error.hpp"
#include "mottle/model/solvers/exact_solver.hpp"
#include "mottle/model/solvers/reduced_solver.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/model/structures/finite_element_structure.hpp"
#include "mottle/model/structures/matrix_structure.hpp"

namespace mottle::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::one_each;
using ::testing::HasSubstr;

constexpr Index k_size = 540, k_last = 40;

SymmetricMatrix sparse(SparseMatrix lower) {
  SymmetricMatrix matrix;
  matrix.lower = std::move(lower);
  return matrix;
}

/// A chain held at one end, of unit masses; m moves mass from its last 40 rows to the others: 1 - 0.8 m stay there.
StructureModel chain_of_matrices(bool reduces, double mean = 0.6, double trained_to = 1.6) {
  std::vector<Eigen::Triplet<double>> springs, masses, moved;
  for (int i = 0; i < static_cast<int>(k_size); ++i) {
    springs.emplace_back(i, i, i + 1 < static_cast<int>(k_size) ? 2.0 : 1.0);
    if (i > 0) springs.emplace_back(i, i - 1, -1.0);
    masses.emplace_back(i, i, 1.0);
    const bool is_last = i >= static_cast<int>(k_size - k_last);
    moved.emplace_back(i, i, is_last ? -0.8 : 0.2);
  }
  const auto matrix = [](const std::vector<Eigen::Triplet<double>>& entries) {
    SparseMatrix result(k_size, k_size);
    result.setFromTriplets(entries.begin(), entries.end());
    return sparse(result);
  };
  MatrixSystem system{.stiffness = matrix(springs), .mass = matrix(masses), .parts = {}};
  system.parts.push_back({.name = "moved", .mass = matrix(moved)});
  MatrixModel model = bind_parameters(system, {{"m", {"M:moved"}}}, VectorXd::Constant(1, mean));
  std::optional<ReductionSettings> reduction;
  if (reduces) reduction = {.prior = {model.reference, VectorXd::LinSpaced(60, 0.1, trained_to)}};
  return {make_sparse_solver(std::make_unique<MatrixStructure>(std::move(model.pencil), model.reference),
                             std::move(reduction)),
          {.frequencies = {1, 2, 3}},
          model.reference};
}

class IndefiniteMass : public testing::TestWithParam<bool> {};

// 1 - 0.8 m is negative above m = 1.25.
TEST_P(IndefiniteMass, FailsTheSamplesThatHaveItAndNoOthers) {
  const VectorXd samples = VectorXd::LinSpaced(46, 0.1, 1.6);
  const Evaluation found = chain_of_matrices(GetParam()).evaluate(samples, {});
  for (const FailedRun& failure : found.failures) {
    EXPECT_GT(samples(failure.sample), 1.25);
    EXPECT_EQ(failure.reason,
              fmt::format("the mass matrix is not positive semidefinite: the diagonal entry of row 501 is {:.6g}",
                          1.0 - 0.8 * samples(failure.sample)));
  }
  EXPECT_EQ(static_cast<Index>(found.failures.size()), (samples.array() > 1.25).count());
  EXPECT_EQ((found.outputs.array().isNaN().rowwise().any()).count(), (samples.array() > 1.25).count());
}

TEST(IndefiniteMass, BeyondTheTrainingFailsItsOwnSamplesAlone) {
  // The basis is trained further on samples that it does not serve: those without modes must not end the run.
  const VectorXd samples = VectorXd::LinSpaced(120, 0.7, 1.6);
  const Evaluation found = chain_of_matrices(true, 0.15, 0.2).evaluate(samples, {});
  EXPECT_EQ(static_cast<Index>(found.failures.size()), (samples.array() > 1.25).count());
  EXPECT_EQ((found.outputs.array().isNaN().rowwise().any()).count(), (samples.array() > 1.25).count());
}

TEST_P(IndefiniteMass, AtItsEdgeIsSemidefiniteAndAllowed) {
  EXPECT_TRUE(chain_of_matrices(GetParam()).evaluate(VectorXd::Constant(5, 1.25), {}).failures.empty());
}

INSTANTIATE_TEST_SUITE_P(Solvers, IndefiniteMass, testing::Bool(),
                         [](const auto& solver) { return solver.param ? "Reduced" : "Exact"; });

TEST(IndefiniteMass, OfTheReferenceIsRefused) {
  EXPECT_THAT(test::message_of<InvalidInput>([] { chain_of_matrices(false, 1.5); }),
              HasSubstr("not positive semidefinite: the diagonal entry of row 501 is -0.2"));
}

// Of few masses the rows have names: m1 = 1 - x by a parameter that may be negative.
TEST(IndefiniteMass, OfAFewMassesFailsTheSample) {
  const StructureModel model(separate(test::three_mass_system(), one_each({"mass:m2"})), {.frequencies = {1}},
                             VectorXd::Ones(1));
  const Evaluation found = model.evaluate(Eigen::Vector3d(1.0, -0.25, 2.0), {});
  ASSERT_EQ(found.failures.size(), 1U);
  EXPECT_EQ(found.failures[0].sample, 1);
  EXPECT_EQ(found.failures[0].reason,
            "the mass matrix is not positive semidefinite: the diagonal entry of row m2 is -0.25");
}

/// Ground - spring - 1 - spring - 2 - spring - ground with masses of 2 and `second`; 2 is omitted where asked for.
FiniteElementModel scalar_chain(double second, bool omits) {
  test::ModelMaker maker;
  for (const int id : {1, 2}) maker.scalar_point(id);
  maker.spring(1, 0, 0, -1, 0, 300.0);
  maker.spring(2, 0, 0, 1, 0, 500.0);
  maker.spring(3, 1, 0, -1, 0, 200.0);
  maker.mass(11, 0, 0, 2.0);
  maker.mass(12, 1, 0, second);
  if (omits) maker.model.omitted_set.emplace_back(1, Components{1});
  return maker.model;
}

// By static reduction M^ = 2 + second (5 / 7)^2 stays positive down to second = -3.92.
TEST(IndefiniteMass, IsNotHiddenByAReductionThatIsDefinite) {
  const auto model = [](double second, bool omits) {
    auto structure = std::make_unique<FiniteElementStructure>(scalar_chain(second, omits), one_each({"CMASS2:12:M"}),
                                                              VectorXd::Ones(1));
    const VectorXd reference = structure->reference();
    return StructureModel(std::make_unique<ExactSolver>(std::move(structure)), {.frequencies = {1}}, reference);
  };
  for (const bool omits : {false, true}) {
    const Evaluation found = model(1.0, omits).evaluate(Eigen::Vector3d(0.5, -0.1, 0.0), {});
    ASSERT_EQ(found.failures.size(), 1U) << omits;
    EXPECT_EQ(found.failures[0].sample, 1);
    EXPECT_THAT(found.failures[0].reason, HasSubstr("not positive semidefinite: the diagonal entry of row 2 is -0.1"));
    EXPECT_THAT(test::message_of<InvalidInput>([&] { model(-0.1, omits); }), HasSubstr("row 2 is -0.1"));
  }
}

}  // namespace
}  // namespace mottle::model
