// Analytic derivatives of the modal model against differences, and batches against single evaluations.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "model/structures.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/model/structures/affine_matrices.hpp"

namespace mottle::model {
namespace {

/// Three masses with parameters k1, m2, k6 and a factor on k2 and k5, all outputs but damping.
StructureModel three_masses(ModeTracking tracking) {
  const std::vector<ParameterTargets> parameters{{"k1", {"spring:k1"}, false},
                                                 {"m2", {"mass:m2"}, false},
                                                 {"k6", {"spring:k6"}, false},
                                                 {"joint", {"spring:k2", "spring:k5"}, true}};
  return {separate(test::three_mass_system(), parameters),
          {.frequencies = {1, 2, 3},
           .shape_modes = {3, 1},
           .shape_degrees_of_freedom = {"m1", "m2", "m3"},
           .tracking = tracking},
          Eigen::Vector4d(1.1, 0.9, 3.0, 1.2)};
}

Eigen::MatrixXd differences(const Model& model, const Eigen::VectorXd& x, double step) {
  Eigen::MatrixXd result(model.outputs().size(), x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    Eigen::MatrixXd ends = x.transpose().replicate(2, 1);
    ends(0, i) -= step;
    ends(1, i) += step;
    const Eigen::MatrixXd y = model.evaluate(ends, {}).outputs;
    result.col(i) = (y.row(1) - y.row(0)).transpose() / (2.0 * step);
  }
  return result;
}

// Central differences with h = 1e-5: truncation of order h^2 = 1e-10, rounding 1e-15 / h = 1e-10.
constexpr double k_step = 1e-5;
constexpr double k_difference_error = 1e-8;

TEST(ModalJacobian, IsThatOfCentralDifferences) {
  const StructureModel model = three_masses(ModeTracking::order);
  for (const Eigen::Vector4d& x : {Eigen::Vector4d(1.1, 0.9, 3.0, 1.2), Eigen::Vector4d(2.0, 1.5, 2.0, 0.7)}) {
    EXPECT_LT((model.jacobian(x) - differences(model, x, k_step)).cwiseAbs().maxCoeff(), k_difference_error);
  }
}

// At k6 = 0.4 the third shape of the reference is no longer that of the third frequency.
TEST(ModalJacobian, FollowsTrackedModes) {
  const StructureModel model = three_masses(ModeTracking::mac);
  const Eigen::Vector4d x(1.1, 0.9, 0.4, 1.2);
  ASSERT_GT(model.evaluate(x.transpose(), {}).outputs(1), model.evaluate(x.transpose(), {}).outputs(2));
  EXPECT_LT((model.jacobian(x) - differences(model, x, k_step)).cwiseAbs().maxCoeff(), k_difference_error);
}

// f = sqrt(k / m) / (2 pi): df/dk = f / (2 k), df/dm = -f / (2 m); phi = m^(-1/2): dphi/dm = -phi / (2 m).
TEST(ModalJacobian, HasTheClosedFormOfOneMass) {
  const MassSpringSystem system{.masses = {{"m", 1.0}}, .springs = {{"k", k_ground, 0, 1.0}}, .dampers = {}};
  const StructureModel model(separate(system, test::one_each({"spring:k", "mass:m"})),
                             {.frequencies = {1}, .shape_modes = {1}, .shape_degrees_of_freedom = {"m"}},
                             Eigen::Vector2d::Ones());
  const Eigen::Vector2d x(9.0, 4.0);
  const Eigen::RowVectorXd y = model.evaluate(x.transpose(), {}).outputs.row(0);
  const Eigen::Matrix2d expected = (Eigen::Matrix2d() << y(0) / 18.0, -y(0) / 8.0, 0.0, -y(1) / 8.0).finished();
  EXPECT_LT((model.jacobian(x) - expected).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(ModalJacobian, IsNotANumberForADampingRatio) {
  const MassSpringSystem system{
      .masses = {{"m", 1.0}}, .springs = {{"k", k_ground, 0, 1.0}}, .dampers = {{"c", k_ground, 0, 0.1}}};
  const StructureModel model(separate(system, test::one_each({"spring:k"})), {.frequencies = {1}, .damping = {1}},
                             Eigen::VectorXd::Ones(1));
  const Eigen::MatrixXd jacobian = model.jacobian(Eigen::VectorXd::Ones(1));
  EXPECT_TRUE(std::isfinite(jacobian(0, 0)));
  EXPECT_TRUE(std::isnan(jacobian(1, 0)));
}

// All springs 1 N/m: lambda = 1, 4, 4 (K = 4 I - ones), so the second and third frequency have no derivative of
// their own, whereas d lambda_1 / d k1 = phi_1(m1)^2 = 1/3.
TEST(ModalJacobian, IsNotANumberForRepeatedFrequencies) {
  MassSpringSystem system = test::three_mass_system();
  system.springs[5].value = 1.0;
  const StructureModel model(separate(system, test::one_each({"spring:k1"})), {.frequencies = {1, 2, 3}},
                             Eigen::VectorXd::Ones(1));
  const Eigen::MatrixXd jacobian = model.jacobian(Eigen::VectorXd::Ones(1));
  EXPECT_NEAR(jacobian(0, 0), 1.0 / 3.0 / (4.0 * std::numbers::pi), 1e-14);
  EXPECT_TRUE(std::isnan(jacobian(1, 0)) && std::isnan(jacobian(2, 0)));
}

// A free mass: f = sqrt(k) / (2 pi) has no derivative at k = 0.
TEST(ModalJacobian, IsNotANumberForAFrequencyOfZero) {
  const StructureModel model(separate(test::two_mass_system(0.0, 0.0, 1.0), test::one_each({"spring:k1"})),
                             {.frequencies = {1}}, Eigen::VectorXd::Ones(1));
  EXPECT_FALSE(std::isfinite(model.jacobian(Eigen::VectorXd::Zero(1))(0, 0)));
}

/// More samples than one chunk of any thread, some of them impossible.
Eigen::MatrixXd many_samples() {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0.2, 3.0);
  Eigen::MatrixXd samples(1200, 4);
  for (double& value : samples.reshaped()) value = uniform(random);
  for (Eigen::Index s = 0; s < samples.rows(); s += 97) samples(s, 1) = -1.0;
  return samples;
}

TEST(ModalBatch, GivesTheBitsOfOneByOne) {
  const StructureModel model = three_masses(ModeTracking::mac);
  const Eigen::MatrixXd samples = many_samples();
  const Eigen::MatrixXd batch = model.evaluate(samples, {}).outputs;
  for (Eigen::Index s = 0; s < samples.rows(); ++s) {
    ASSERT_TRUE(test::have_same_bits(batch.row(s), model.evaluate(samples.row(s), {}).outputs)) << s;
  }
}

TEST(ModalBatch, GivesTheSameBitsAtAnyThreadCount) {
  const StructureModel model = three_masses(ModeTracking::mac);
  const Eigen::MatrixXd samples = many_samples();
  const Evaluation one = model.evaluate(samples, {.threads = 1});
  for (const int threads : {2, 3}) {
    const Evaluation more = model.evaluate(samples, {.threads = threads});
    EXPECT_TRUE(test::have_same_bits(one.outputs, more.outputs)) << threads;
    ASSERT_EQ(one.failures.size(), more.failures.size());
    for (std::size_t i = 0; i < one.failures.size(); ++i) EXPECT_EQ(one.failures[i].sample, more.failures[i].sample);
  }
}

TEST(ModalBatch, ListsFailuresInTheOrderOfSamples) {
  const Evaluation evaluation = three_masses(ModeTracking::order).evaluate(many_samples(), {.threads = 3});
  ASSERT_EQ(evaluation.failures.size(), 13U);  // samples 0, 97, ..., 1164
  for (std::size_t i = 0; i < 13; ++i) EXPECT_EQ(evaluation.failures[i].sample, 97 * static_cast<int>(i));
}

}  // namespace
}  // namespace mottle::model
