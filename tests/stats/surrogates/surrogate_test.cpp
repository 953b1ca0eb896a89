#include "mottle/stats/surrogates/surrogate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mottle/core/error.hpp"
#include "mottle/stats/sampling/sampling.hpp"

namespace mottle::stats {
namespace {

constexpr SurrogateKind k_kinds[] = {SurrogateKind::quadratic, SurrogateKind::kriging, SurrogateKind::chaos};

Eigen::MatrixXd points(Eigen::Index count, std::uint32_t iteration, double half = 1.0) {
  const StreamKey key{.purpose = StreamPurpose::surrogate_runs, .iteration = iteration};
  const Eigen::MatrixXd unit = uniform_design(SamplingDesign::latin_hypercube, count, 3, key);
  // Units of a stiffness, a thickness and an angle.
  const Eigen::MatrixXd cube = half * (2.0 * unit.array() - 1.0);
  return (cube * Eigen::Vector3d(2e9, 1e-4, std::numbers::pi).asDiagonal()).rowwise() +
         Eigen::RowVector3d(7e10, 1e-2, 0.0);
}

Eigen::VectorXd quadratic(const Eigen::MatrixXd& x) {
  const Eigen::ArrayXd a = (x.col(0).array() - 7e10) / 2e9;
  const Eigen::ArrayXd b = (x.col(1).array() - 1e-2) / 1e-4;
  const Eigen::ArrayXd c = x.col(2).array();
  return 3.0 + a - 2.0 * b + 0.5 * a * b - 0.25 * c.square() + 0.1 * c * a;
}

/// Ishigami's function: curved in every variable, two of them in product.
Eigen::VectorXd ishigami(const Eigen::MatrixXd& x) {
  const Eigen::ArrayXd a = (x.col(0).array() - 7e10) / 2e9 * std::numbers::pi;
  const Eigen::ArrayXd b = (x.col(1).array() - 1e-2) / 1e-4 * std::numbers::pi;
  const Eigen::ArrayXd c = x.col(2).array();
  return a.sin() + 7.0 * b.sin().square() + 0.1 * c.pow(4) * a.sin();
}

double standard_deviation(const Eigen::VectorXd& values) {
  return std::sqrt((values.array() - values.mean()).square().mean());
}

TEST(Surrogate, QuadraticAndChaosAreExactForAQuadraticInsideAndOutsideTheRuns) {
  for (const SurrogateKind kind : {SurrogateKind::quadratic, SurrogateKind::chaos}) {
    const Eigen::MatrixXd x = points(40, 0);
    const Surrogate surrogate(kind, x, quadratic(x));
    const Eigen::MatrixXd others = points(50, 1, 1.2);
    EXPECT_LT((surrogate(others).col(0) - quadratic(others)).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT(surrogate.left_out_residuals().cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(Surrogate, KrigingGoesThroughItsRuns) {
  const Eigen::MatrixXd x = points(60, 0);
  const Surrogate surrogate(SurrogateKind::kriging, x, ishigami(x));
  EXPECT_LT((surrogate(x).col(0) - ishigami(x)).cwiseAbs().maxCoeff(), 1e-4);
}

/// The error stated by leaving runs out is the one made at points that no fit has seen.
TEST(Surrogate, ErrorOfLeftOutRunsIsTheErrorElsewhere) {
  for (const SurrogateKind kind : k_kinds) {
    const Eigen::MatrixXd x = points(100, 0);
    const Eigen::MatrixXd others = points(1000, 1);
    const Surrogate surrogate(kind, x, ishigami(x));
    const double stated = std::sqrt(surrogate.left_out_residuals().squaredNorm() / 100.0);
    const double made = std::sqrt((surrogate(others).col(0) - ishigami(others)).squaredNorm() / 1000.0);
    EXPECT_GT(stated, 0.6 * made);
    EXPECT_LT(stated, 2.0 * made);
    if (kind != SurrogateKind::quadratic) {
      EXPECT_LT(made, 0.4 * standard_deviation(ishigami(others)));
    }
  }
}

TEST(Surrogate, OutputsAreFittedEachByItself) {
  const Eigen::MatrixXd x = points(60, 0);
  Eigen::MatrixXd y(60, 2);
  y << quadratic(x), 1e6 * ishigami(x);
  const Eigen::MatrixXd both = Surrogate(SurrogateKind::kriging, x, y)(x.topRows(5));
  const Eigen::MatrixXd alone = Surrogate(SurrogateKind::kriging, x, quadratic(x))(x.topRows(5));
  EXPECT_LT((both.col(0) - alone).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Surrogate, TooFewRunsAreRefusedWithTheirNumber) {
  EXPECT_EQ(Surrogate::min_runs(SurrogateKind::quadratic, 3), 12);  // ten terms, nine tenths of the runs
  const Eigen::MatrixXd x = points(11, 0);
  try {
    const Surrogate surrogate(SurrogateKind::quadratic, x, quadratic(x));
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "a surrogate of 3 parameters needs at least 12 runs, 11 are there");
  }
}

}  // namespace
}  // namespace mottle::stats
