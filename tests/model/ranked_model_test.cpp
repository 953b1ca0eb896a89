// Batches that ranks share have the bits that they have without ranks, however many there are.
#include "mottle/model/ranked_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "core/message_of.hpp"
#include "core/temporary_folder.hpp"
#include "fem/models.hpp"
#include "model/structures.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/parallel.hpp"
#include "mottle/model/function_model.hpp"
#include "mottle/model/journal.hpp"
#include "mottle/model/solvers/reduced_solver.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/model/structures/affine_matrices.hpp"
#include "mottle/model/structures/finite_element_structure.hpp"
#include "support/thread_ranks.hpp"

namespace mottle::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using test::have_same_bits;
using test::ThreadJob;

constexpr int k_beams = 90;  // 540 equations

/// A cantilever of two metals.
FiniteElementModel beam_of_two_metals() {
  test::ModelMaker maker;
  maker.model.settings.coupled_mass = true;
  const int metals[] = {maker.material(1, 7e10, 0.3, 2700.0), maker.material(2, 7e10, 0.3, 2700.0)};
  const int sections[] = {maker.beam_property(1, metals[0], 4e-4, 2e-8, 2.1e-8, 1e-8),
                          maker.beam_property(2, metals[1], 4e-4, 2e-8, 1.8e-8, 1e-8)};
  for (int k = 0; k <= k_beams; ++k) maker.node(100 + k, {1.2 * k / k_beams, 0, 0});
  for (int k = 0; k < k_beams; ++k) maker.beam(k + 1, k, k + 1, sections[2 * k / k_beams]);
  maker.model.fixed.emplace_back(0, k_all_components);
  return maker.model;
}

MatrixXd factors(Index samples, double half_width, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> distribution(1.0 - half_width, 1.0 + half_width);
  MatrixXd x(samples, 2);
  for (double& value : x.reshaped()) value = distribution(random);
  return x;
}

StructureModel beam_model(bool reduces, bool has_statics = false) {
  const std::vector<ParameterTargets> parameters{{"E1", {"MAT1:1:E"}, true}, {"E2", {"MAT1:2:E"}, true}};
  auto structure = std::make_unique<FiniteElementStructure>(beam_of_two_metals(), parameters, Eigen::VectorXd::Ones(2));
  std::optional<ReductionSettings> reduction;
  if (reduces) reduction = {.prior = {Eigen::VectorXd::Ones(2), factors(200, 0.1, 1)}};
  OutputSelection outputs{.frequencies = {1, 2, 3, 4}, .shape_modes = {1}, .shape_degrees_of_freedom = {"150:+Y"}};
  if (has_statics) {
    outputs.static_loads = {{.forces = {{"190:+Z", 1.0}}, .degrees_of_freedom = {"150:+Z"}}};
  }
  const Eigen::VectorXd reference = structure->reference();
  return {make_sparse_solver(std::move(structure), std::move(reduction)), std::move(outputs), reference};
}

/// Samples of which one has no number, one no modes.
MatrixXd with_faults(MatrixXd x) {
  x(3, 1) = std::numeric_limits<double>::quiet_NaN();
  x(7, 0) = -1.0;
  return x;
}

/// Checks a batch's evaluation on every rank, for several numbers of ranks, against the one without ranks.
template <typename MakeModel>
void expect_same_by_ranks(const MakeModel& make, const MatrixXd& x) {
  const Evaluation alone = make().evaluate(x, {.threads = 2});
  for (const int count : {1, 2, 3}) {
    std::atomic<int> same{0};
    ThreadJob(count).run([&](Ranks& ranks) {
      const auto model = make();
      const Evaluation shared = RankedModel(model, &ranks).evaluate(x, {});
      ASSERT_EQ(shared.failures.size(), alone.failures.size());
      for (std::size_t i = 0; i < alone.failures.size(); ++i) {
        EXPECT_EQ(shared.failures[i].sample, alone.failures[i].sample);
        EXPECT_EQ(shared.failures[i].reason, alone.failures[i].reason);
      }
      EXPECT_EQ(shared.use.reduced, alone.use.reduced);
      EXPECT_EQ(shared.use.refined, alone.use.refined);
      EXPECT_EQ(shared.use.exact, alone.use.exact);
      EXPECT_EQ(shared.use.frequency_error, alone.use.frequency_error);
      same += have_same_bits(shared.outputs, alone.outputs) ? 1 : 0;
    });
    EXPECT_EQ(same, count);
  }
}

TEST(RankedModel, ExactSolutionsAreTheSame) {
  expect_same_by_ranks([] { return beam_model(false); }, with_faults(factors(12, 0.1, 2)));
}

TEST(RankedModel, ReducedSolutionsAreTheSame) {
  expect_same_by_ranks([] { return beam_model(true); }, with_faults(factors(200, 0.1, 3)));
}

// Some are certified at once, others refined, the reduced model is trained further on what the batch holds.
TEST(RankedModel, ReducedSolutionsOutsideThePriorAreTheSame) {
  MatrixXd x = factors(200, 0.1, 4);
  x.topRows(40).array() += 0.5;
  x.row(50) << 9.0, 0.2;
  const SolverUse use = beam_model(true).evaluate(x, {}).use;
  ASSERT_GT(use.reduced, 40);
  ASSERT_GT(use.refined + use.exact, 0);
  expect_same_by_ranks([] { return beam_model(true); }, x);
}

// Modes by the reduced model and static solutions of one sample may come from two ranks.
TEST(RankedModel, StaticSolutionsBesideReducedOnesAreTheSame) {
  expect_same_by_ranks([] { return beam_model(true, true); }, with_faults(factors(130, 0.1, 7)));
}

TEST(RankedModel, DenseSolutionsAreTheSame) {
  // 150 masses in a row: a batch of 2000 samples takes some tenths of a second.
  MassSpringSystem system;
  for (int i = 0; i < 150; ++i) {
    system.masses.push_back({fmt::format("m{}", i), 1.0});
    system.springs.push_back({fmt::format("k{}", i), i == 0 ? k_ground : i - 1, i, 100.0});
  }
  const auto make = [&] {
    return StructureModel(separate(system, test::one_each({"spring:k0", "spring:k1"})), {.frequencies = {1, 2, 3}},
                          Eigen::Vector2d(100.0, 100.0));
  };
  expect_same_by_ranks(make, 100.0 * factors(2000, 0.2, 5));
}

TEST(RankedModel, OtherSamplesOnARankAreAnError) {
  const auto evaluate = [] {
    ThreadJob(2).run([](Ranks& ranks) {
      const FunctionModel model(2, {named_quantity("sum", "-")}, [](const Eigen::VectorXd& x) -> Eigen::VectorXd {
        return Eigen::VectorXd::Constant(1, x.sum());
      });
      (void)RankedModel(model, &ranks).evaluate(factors(3, 0.1, ranks.is_first() ? 1 : 2), {});
    });
  };
  EXPECT_THAT(test::message_of<SystemFailure>(evaluate), testing::HasSubstr("the samples of a batch"));
}

TEST(RankedJournal, TheFirstRanksAnswersServeAll) {
  const test::TemporaryFolder folder;
  const MatrixXd x = factors(5, 0.3, 6);
  std::atomic<int> calls{0};
  const auto run = [&](bool resume) {
    ThreadJob(3).run([&](Ranks& ranks) {
      const FunctionModel model(2, {named_quantity("product", "-")}, [&](const Eigen::VectorXd& y) -> Eigen::VectorXd {
        ++calls;
        return Eigen::VectorXd::Constant(1, y.prod());
      });
      const std::filesystem::path file = ranks.is_first() ? folder / "journal" : std::filesystem::path();
      const JournalledModel journalled(model, file, {1, 2}, resume, &ranks);
      EXPECT_TRUE(have_same_bits(journalled.evaluate(x, {}).outputs, x.rowwise().prod()));
    });
  };
  run(false);
  EXPECT_GT(calls, 0);
  calls = 0;
  run(true);
  EXPECT_EQ(calls, 0);
}

TEST(RankedJournal, OtherFilesOnARankAreAnError) {
  const auto evaluate = [] {
    ThreadJob(2).run([](Ranks& ranks) {
      const FunctionModel model(2, {named_quantity("sum", "-")}, [](const Eigen::VectorXd& y) -> Eigen::VectorXd {
        return Eigen::VectorXd::Constant(1, y.sum());
      });
      const JournalledModel journalled(model, {}, {1, static_cast<std::uint64_t>(ranks.rank())}, false, &ranks);
      (void)journalled.evaluate(factors(3, 0.1, 1), {});
    });
  };
  EXPECT_THAT(test::message_of<SystemFailure>(evaluate), testing::HasSubstr("the study's files"));
}

}  // namespace
}  // namespace mottle::model
