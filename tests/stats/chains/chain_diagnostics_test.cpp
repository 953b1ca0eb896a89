#include "mottle/stats/chains/chain_diagnostics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace mottle::stats {
namespace {

/// Four chains x_t = memory x_(t-1) + u_t - 1/2 with u_t of the generator s <- 16807 s mod (2^31 - 1), whose numbers
/// are the same in every program.
Eigen::MatrixXd chains(Eigen::Index draws, double memory) {
  constexpr double k_modulus = 2147483647.0;
  Eigen::MatrixXd values(draws, 4);
  for (Eigen::Index c = 0; c < 4; ++c) {
    double state = 1000.0 * static_cast<double>(c + 1);
    double x = 0.0;
    for (Eigen::Index t = 0; t < draws; ++t) {
      state = std::fmod(16807.0 * state, k_modulus);
      x = memory * x + (state / k_modulus - 0.5);
      values(t, c) = x;
    }
  }
  return values;
}

/// What the R package posterior 1.4.0 says of the same chains (rhat, ess_bulk, ess_tail).
struct Published {
  double r_hat, bulk, tail;
};

/// Both programs differ in how they sum alone.
void expect_published(const Eigen::MatrixXd& draws, const Published& published) {
  constexpr double k_rounding = 1e-9;
  EXPECT_NEAR(rank_normalised_r_hat(draws), published.r_hat, k_rounding);
  EXPECT_NEAR(bulk_effective_sample_size(draws), published.bulk, k_rounding * published.bulk);
  EXPECT_NEAR(tail_effective_sample_size(draws), published.tail, k_rounding * published.tail);
}

TEST(ChainDiagnostics, AgreeWithAnotherProgramForPositivelyCorrelatedDraws) {
  expect_published(chains(201, 0.6), {1.00540055867834, 157.49857378482122, 309.03798668333957});
}

TEST(ChainDiagnostics, AgreeWithAnotherProgramForNegativelyCorrelatedDraws) {
  expect_published(chains(200, -0.5), {0.999234182801842, 2315.416084990849868, 759.855667031254029});
}

TEST(ChainDiagnostics, AgreeWithAnotherProgramForAChainThatIsElsewhere) {
  Eigen::MatrixXd draws = chains(200, 0.3);
  draws.col(3).array() += 0.4;
  expect_published(draws, {1.16420878738601, 20.20001420586724, 28.08667500252864});
}

TEST(ChainDiagnostics, AgreeWithAnotherProgramForAWiderChain) {
  Eigen::MatrixXd draws = chains(200, 0.3);
  draws.col(3) *= 3.0;
  expect_published(draws, {1.21952729220247, 346.82438326992786, 28.08667500252864});
}

TEST(ChainDiagnostics, ShareRanksAmongEqualDraws) {
  const Eigen::MatrixXd draws = (4.0 * chains(200, 0.3)).array().floor() / 4.0;
  EXPECT_NEAR(rank_normalised_r_hat(draws), 0.999886498489239, 1e-9);
  EXPECT_NEAR(bulk_effective_sample_size(draws), 314.692021168486974, 1e-6);
  EXPECT_TRUE(std::isnan(tail_effective_sample_size(draws)));  // all draws are below their 95 % quantile or on it
}

TEST(ChainDiagnostics, SayNothingOfDrawsThatTellNothing) {
  Eigen::MatrixXd broken = chains(100, 0.3);
  broken(7, 1) = std::numeric_limits<double>::infinity();
  for (const Eigen::MatrixXd& draws : {Eigen::MatrixXd(chains(3, 0.3)), Eigen::MatrixXd(Eigen::MatrixXd::Ones(100, 4)),
                                       broken, Eigen::MatrixXd(0, 0)}) {
    EXPECT_TRUE(std::isnan(rank_normalised_r_hat(draws)));
    EXPECT_TRUE(std::isnan(bulk_effective_sample_size(draws)));
    EXPECT_TRUE(std::isnan(tail_effective_sample_size(draws)));
  }
}

}  // namespace
}  // namespace mottle::stats
