// What a batch promises about its samples: the same bits in any company, and failures that stay where they are.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>

#include "linalg/pencils.hpp"
#include "mottle/linalg/batched/batch_eigen.hpp"

namespace mottle::linalg {
namespace {

using namespace linalg_test;

bool same_bits(const double* a, const double* b, Index count) {
  return std::memcmp(a, b, static_cast<std::size_t>(count) * sizeof(double)) == 0;
}

class BatchIndependence : public AtEveryLevel {};
INSTANTIATE_TEST_SUITE_P(Levels, BatchIndependence, every_level(), level_name);

TEST_P(BatchIndependence, ASampleHasTheSameBitsWhateverTheBatchTheOrderAndTheThreads) {
  std::mt19937_64 random(13);
  for (const Index order : {3, 8, 12, 30}) {
    const Index samples = order <= 8 ? 1000 : 100;
    for (const Mass mass : {Mass::constant_full, Mass::parametric_full}) {
      const Batch batch = random_batch(order, mass, samples, random);
      const BatchModes modes = batch.solve(options(0, true, 1));

      std::vector<Index> shuffled(static_cast<std::size_t>(samples));
      std::iota(shuffled.begin(), shuffled.end(), Index{0});
      std::shuffle(shuffled.begin(), shuffled.end(), random);
      Batch other = batch;
      other.stiffness_coefficients = batch.stiffness_coefficients(Eigen::all, shuffled).eval();
      if (mass == Mass::parametric_full) other.mass_coefficients = batch.mass_coefficients(Eigen::all, shuffled).eval();
      const BatchModes in_other_order = other.solve(options(0, true, 2));

      for (Index position = 0; position < samples; ++position) {
        const Index sample = shuffled[static_cast<std::size_t>(position)];
        const Batch single{batch.family, batch.stiffness_coefficients.col(sample),
                           mass == Mass::parametric_full ? MatrixXd(batch.mass_coefficients.col(sample)) : MatrixXd()};
        const BatchModes alone = single.solve(options());
        for (const auto& [values, vectors] :
             {std::pair{in_other_order.values.col(position).eval(), in_other_order.vectors.col(position).eval()},
              std::pair{alone.values.col(0).eval(), alone.vectors.col(0).eval()}}) {
          ASSERT_TRUE(same_bits(values.data(), modes.values.col(sample).data(), order));
          ASSERT_TRUE(same_bits(vectors.data(), modes.vectors.col(sample).data(), order * order));
        }
      }
    }
  }
}

TEST_P(BatchIndependence, AnEasySampleKeepsItsBitsNextToAHardOne) {
  // Sample 0 is diagonal with negative zeros about it, its neighbour needs every sweep; masked lanes must not move.
  for (const Index order : {3, 6, 14}) {
    std::mt19937_64 random(14);
    PencilFamily family{
        MatrixXd::Identity(order, order), {random_symmetric(order, random)}, MatrixXd::Identity(order, order), {}};
    const MatrixXd alone = MatrixXd::Constant(1, 1, -0.0);
    MatrixXd mixed = MatrixXd::Constant(1, 8, 1.0);
    mixed(0, 3) = -0.0;
    const BatchModes single = solve_batch(family, alone, MatrixXd(), options());
    const BatchModes batch = solve_batch(family, mixed, MatrixXd(), options());
    EXPECT_TRUE(same_bits(single.values.data(), batch.values.col(3).data(), order));
    EXPECT_TRUE(same_bits(single.vectors.data(), batch.vectors.col(3).data(), order * order));
  }
}

TEST_P(BatchIndependence, SamplesThatCannotBeSolvedAreMarkedAndTheirNeighboursUnchanged) {
  std::mt19937_64 random(15);
  for (const Index order : {3, 8, 16}) {
    for (const Mass mass : {Mass::parametric_diagonal, Mass::parametric_full}) {
      const Batch sound = random_batch(order, mass, 24, random);
      Batch broken = sound;
      broken.stiffness_coefficients(1, 2) = std::numeric_limits<double>::quiet_NaN();
      broken.stiffness_coefficients(0, 9) = std::numeric_limits<double>::infinity();
      broken.mass_coefficients(1, 11) = -100.0;
      broken.mass_coefficients(0, 23) = -std::numeric_limits<double>::infinity();
      const BatchModes expected = sound.solve(options()), modes = broken.solve(options());
      for (Index sample = 0; sample < 24; ++sample) {
        const bool is_broken = sample == 2 || sample == 9 || sample == 11 || sample == 23;
        EXPECT_EQ(modes.failed[static_cast<std::size_t>(sample)], is_broken ? 1 : 0) << sample;
        if (is_broken) {
          EXPECT_TRUE(modes.values.col(sample).array().isNaN().all() &&
                      modes.vectors.col(sample).array().isNaN().all());
        } else {
          EXPECT_TRUE(same_bits(modes.values.col(sample).data(), expected.values.col(sample).data(), order));
          EXPECT_TRUE(same_bits(modes.vectors.col(sample).data(), expected.vectors.col(sample).data(), order * order));
        }
      }
    }
  }
}

TEST_P(BatchIndependence, ASingularConstantMassFailsEverySample) {
  MatrixXd mass = MatrixXd::Identity(3, 3);
  mass(2, 2) = 0.0;
  const BatchModes modes = repeated(MatrixXd::Identity(3, 3), mass, 5).solve(options());
  EXPECT_THAT(modes.failed, testing::Each(1));
  EXPECT_TRUE(modes.values.array().isNaN().all());
}

}  // namespace
}  // namespace mottle::linalg
