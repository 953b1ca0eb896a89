#include "updating/methods/curvature.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::updating {
namespace {

/// y_k = g_k' t + c_k (a' t)^2 / 2.
class CurvedModel final : public Model {
 public:
  CurvedModel(Eigen::MatrixXd slope, Eigen::VectorXd curvature, Eigen::VectorXd direction)
      : slope_(std::move(slope)), curvature_(std::move(curvature)), direction_(std::move(direction)) {
    outputs_.resize(static_cast<std::size_t>(slope_.rows()));
  }
  Eigen::Index parameter_count() const override { return slope_.cols(); }
  const std::vector<Quantity>& outputs() const override { return outputs_; }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext&) const override {
    const Eigen::ArrayXd along = samples * direction_;
    Evaluation evaluation;
    evaluation.outputs = samples * slope_.transpose() + 0.5 * (along.square().matrix() * curvature_.transpose());
    return evaluation;
  }

 private:
  Eigen::MatrixXd slope_;
  Eigen::VectorXd curvature_, direction_;
  std::vector<Quantity> outputs_;
};

struct Case {
  Case(const Eigen::MatrixXd& slope, const Eigen::VectorXd& curvature, const Eigen::VectorXd& direction,
       double noise_std)
      : model(slope, curvature, direction), noise(Eigen::VectorXd::Constant(slope.rows(), noise_std * noise_std)) {
    std::vector<Parameter> parameters(static_cast<std::size_t>(slope.cols()));
    std::vector<Distribution> priors;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      parameters[i] = {.name = fmt::format("x{}", i), .unit = "-", .limit = {-1e9, false}};
      priors.emplace_back(DistributionSpec{.kind = DistributionKind::normal, .mean = 0.0, .std = 0.5});
    }
    space = std::make_unique<ParameterSpace>(parameters, JointDistribution(priors));
    Eigen::MatrixXd x(12, slope.cols());
    for (Eigen::Index s = 0; s < x.rows(); ++s) {
      RandomStream stream({.seed = 2, .purpose = StreamPurpose::truth}, static_cast<std::uint32_t>(s));
      for (double& value : x.row(s)) value = 0.3 * standard_normal_quantile(stream.uniform());
    }
    values = model.evaluate(x, {}).outputs;
    for (Eigen::Index s = 0; s < values.rows(); ++s) {
      RandomStream stream({.seed = 2, .purpose = StreamPurpose::test_noise}, static_cast<std::uint32_t>(s));
      for (double& value : values.row(s)) value += noise_std * standard_normal_quantile(stream.uniform());
    }
  }
  UpdatingProblem problem() const { return {.model = model, .space = *space, .tests = {values, noise.cwiseSqrt()}}; }
  PopulationFit fit() const {
    const PopulationFitSettings settings{
        .noise = {noise, std::vector<int>(static_cast<std::size_t>(noise.size()), -1), 0}, .tolerance = 1e-6};
    return fit_population(problem(), values, settings, {}, [](const PopulationFit&) { return true; });
  }

  CurvedModel model;
  Eigen::VectorXd noise;
  std::unique_ptr<ParameterSpace> space;
  Eigen::MatrixXd values;
};

Eigen::VectorXd bias_of(const Case& one, const PopulationFit& fit) {
  std::int64_t evaluations = 0;
  return curvature_bias(one.problem(), fit, {}, evaluations);
}

/// With one output and one parameter all three terms are G H P / (2 C), P = Sigma R / C.
TEST(CurvatureBias, IsThreeTimesTheResponsesForOneParameter) {
  const Case one(Eigen::MatrixXd::Ones(1, 1), Eigen::VectorXd::Constant(1, 0.8), Eigen::VectorXd::Ones(1), 0.2);
  const PopulationFit fit = one.fit();
  const double sigma = fit.effects.covariance(0, 0);
  double score = 0.0;
  double information = 0.0;
  for (const RandomEffectsUnit& unit : fit.units) {
    const double g = unit.design(0, 0);
    const double total = g * g * sigma + 0.04;
    score += 3.0 * g / total * 0.5 * 0.8 * sigma * 0.04 / total;
    information += g * g / total;
  }
  // Second differences of a quadratic: rounding alone, 1e-16 / 0.1^2.
  EXPECT_NEAR(bias_of(one, fit)(0), score / std::sqrt(information), 1e-10);
}

TEST(CurvatureBias, IsNothingWhereOutputsAreLinear) {
  const Case one(Eigen::MatrixXd{{1.0, 0.2}, {0.3, 1.0}, {0.5, 0.5}}, Eigen::VectorXd::Zero(3),
                 Eigen::Vector2d(1.0, 1.0), 0.2);
  EXPECT_LT(bias_of(one, one.fit()).cwiseAbs().maxCoeff(), 1e-10);
}

/// The second parameter is seen by outputs of its own and is not curved: the first has what it has alone.
TEST(CurvatureBias, DoesNotReachAnotherParameterThatIsApart) {
  const Case one(Eigen::MatrixXd{{1.0, 0.0}, {0.0, 1.0}}, Eigen::Vector2d(0.8, 0.0), Eigen::Vector2d(1.0, 0.0), 0.2);
  PopulationFit fit = one.fit();
  fit.effects.covariance = Eigen::Vector2d(0.09, 0.09).asDiagonal();
  const Eigen::VectorXd bias = bias_of(one, fit);
  EXPECT_GT(bias(0), 0.05);
  EXPECT_NEAR(bias(1), 0.0, 1e-10);
}

}  // namespace
}  // namespace mottle::updating
