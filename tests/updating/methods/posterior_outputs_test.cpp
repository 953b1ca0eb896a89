// Outputs, further tests and leave-one-out of a posterior against the closed form of a linear normal model.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "mottle/updating/estimate/posterior.hpp"
#include "mottle/updating/methods/bayes.hpp"
#include "support/linear_model.hpp"

namespace mottle::updating {
namespace {

constexpr PhysicalLimit k_free{.lower = -1e9, .excludes_lower = false};

/// y = a + G x with x ~ N((1, 2), diag(0.2, 0.5)^2), six specimens.
struct SampledLinear {
  SampledLinear() : model(Eigen::Vector3d(1.0, 0.0, 2.0), slope()) {
    const Distribution first({.kind = DistributionKind::normal, .mean = 1.0, .std = 0.2});
    const Distribution second({.kind = DistributionKind::normal, .mean = 2.0, .std = 0.5});
    space = std::make_unique<ParameterSpace>(
        std::vector<Parameter>{{"a", "-", -50.0, 50.0, k_free}, {"b", "-", -50.0, 50.0, k_free}},
        JointDistribution({first, second}));
    tests.values.resize(6, 3);
    tests.values << 3.05, 2.9, 3.72, 2.94, 3.25, 3.66, 3.12, std::nan(""), 3.75, 2.98, 3.1, 3.69, 3.02, 2.8, 3.74, 2.9,
        3.05, 3.68;
    tests.repeatability_std = Eigen::Vector3d(0.1, 0.2, 0.05);
  }
  static Eigen::MatrixXd slope() {
    Eigen::MatrixXd g(3, 2);
    g << 1.0, 0.5, -1.0, 2.0, 0.3, 0.7;
    return g;
  }
  UpdatingResult update() const {
    const UpdatingProblem problem{.model = model, .space = *space, .tests = tests, .cloud = {.samples = 100}};
    return BayesUpdater({}).update(problem, {});
  }
  test::LinearModel model;
  std::unique_ptr<ParameterSpace> space;
  TestData tests;
};

/// All entries of `tests` as one normal vector, specimen by specimen.
struct JointNormal {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;

  explicit JointNormal(const TestData& tests) {
    const Eigen::MatrixXd g = SampledLinear::slope();
    const Eigen::MatrixXd shared = g * Eigen::Vector2d(0.04, 0.25).asDiagonal() * g.transpose() +
                                   Eigen::MatrixXd(tests.model_error_variance().asDiagonal());
    const Eigen::Index n = tests.values.rows();
    mean = (Eigen::Vector3d(1.0, 0.0, 2.0) + g * Eigen::Vector2d(1.0, 2.0)).replicate(n, 1);
    covariance = shared.replicate(n, n);
    covariance.diagonal() += tests.repeatability_std.cwiseAbs2().replicate(n, 1);
  }

  /// ln density of the measured entries.
  double log_density(const Eigen::MatrixXd& values) const {
    std::vector<Eigen::Index> known;
    const Eigen::VectorXd all = values.transpose().reshaped();
    for (Eigen::Index i = 0; i < all.size(); ++i) {
      if (!std::isnan(all(i))) known.push_back(i);
    }
    const Eigen::VectorXd apart = all(known) - mean(known);
    const Eigen::MatrixXd c = covariance(known, known);
    return -0.5 * (apart.dot(c.inverse() * apart) + std::log(c.determinant()) +
                   static_cast<double>(known.size()) * std::log(2.0 * std::numbers::pi));
  }
};

TEST(PosteriorOutputs, LeaveSpecimensOutAsTheClosedForm) {
  const SampledLinear linear;
  const UpdatingResult result = linear.update();
  ASSERT_TRUE(result.posterior->leave_one_out);
  const LeaveOneOut& found = *result.posterior->leave_one_out;
  const JointNormal joint(linear.tests);
  double sum = 0.0;
  for (Eigen::Index i = 0; i < 6; ++i) {
    Eigen::MatrixXd others = linear.tests.values;
    others.row(i).setConstant(std::numeric_limits<double>::quiet_NaN());
    const double exact = joint.log_density(linear.tests.values) - joint.log_density(others);
    sum += exact;
    // The density's relative error over 8,000 draws is that of a mean of weights, of variance about 1: 1 % each.
    EXPECT_NEAR(found.pointwise(i), exact, 0.06) << i;
    EXPECT_LT(found.pareto_k(i), k_unreliable_pareto_k);
  }
  EXPECT_NEAR(found.elpd, sum, 0.12);
  EXPECT_NEAR(result.posterior->waic->elpd, found.elpd, 0.5);  // of the same quantity, to second order
  EXPECT_EQ(result.posterior->not_left_out, "");
}

TEST(PosteriorOutputs, AddUpOverSpecimensToTheLikelihood) {
  const UpdatingResult result = SampledLinear().update();
  const SampledPosterior& posterior = *result.posterior;
  const Eigen::VectorXd sum = posterior.specimen_log_likelihood.rowwise().sum();
  EXPECT_LT((sum - posterior.log_likelihood).cwiseAbs().maxCoeff(), 1e-9);
}

/// A further specimen given the tests: the joint normal of seven specimens, conditioned on six.
TEST(PosteriorOutputs, HaveFurtherTestsOfTheClosedForm) {
  SampledLinear linear;
  linear.tests.model_error_std = Eigen::Vector3d(0.3, 0.0, 0.1);
  linear.tests.values(2, 1) = 2.95;  // all measured
  const UpdatingResult result = linear.update();
  TestData seven = linear.tests;
  seven.values.conservativeResize(7, 3);
  const JointNormal joint(seven);
  const Eigen::MatrixXd gain =
      joint.covariance.bottomLeftCorner(3, 18) * joint.covariance.topLeftCorner(18, 18).inverse();
  const Eigen::VectorXd mean =
      joint.mean.tail(3) + gain * (linear.tests.values.transpose().reshaped() - joint.mean.head(18));
  const Eigen::MatrixXd covariance =
      joint.covariance.bottomRightCorner(3, 3) - gain * joint.covariance.topRightCorner(18, 3);
  const Eigen::MatrixXd& further = result.posterior->replicates;
  const Eigen::MatrixXd apart = further.rowwise() - further.colwise().mean();
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double deviation = std::sqrt(covariance(k, k));
    EXPECT_NEAR(further.col(k).mean(), mean(k), 0.08 * deviation);  // 4 errors of 2,500 effective draws
    EXPECT_NEAR(std::sqrt(apart.col(k).squaredNorm() / static_cast<double>(apart.rows())), deviation, 0.06 * deviation);
  }
}

TEST(PosteriorOutputs, SayWhyNoSpecimenIsLeftOut) {
  SampledLinear linear;
  linear.tests.model_error_std = Eigen::Vector3d(0.3, 0.0, 0.1);
  UpdatingResult result = linear.update();
  EXPECT_FALSE(result.posterior->leave_one_out);
  EXPECT_NE(result.posterior->not_left_out.find("shared by all specimens"), std::string::npos);
  linear = SampledLinear();
  linear.tests.values.conservativeResize(1, 3);
  result = linear.update();
  EXPECT_FALSE(result.posterior->waic);
  EXPECT_NE(result.posterior->not_left_out.find("two specimens"), std::string::npos);
}

TEST(PosteriorOutputs, NameASpecimenThatCannotBeLeftOut) {
  SampledLinear linear;
  linear.tests.values.row(3) << 3.9, 1.4, 4.2;  // many standard deviations from the others
  const UpdatingResult result = linear.update();
  EXPECT_GT(result.posterior->leave_one_out->pareto_k(3), k_unreliable_pareto_k);
  bool is_named = false;
  for (const std::string& note : result.notes) {
    is_named =
        is_named || (note.find("Pareto k above 0.7") != std::string::npos && note.find(" 4 (") != std::string::npos);
  }
  EXPECT_TRUE(is_named);
}

}  // namespace
}  // namespace mottle::updating
