// Posteriors with many modes and with bent ridges, whose evidence and moments are integrals over one parameter each.
#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "mottle/model/function_model.hpp"
#include "mottle/stats/distributions/joint_distribution.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::test {

using namespace updating;  // of which these are the tests

/// One test of a function of parameters, with what quadrature says of the posterior.
struct ShapedPosterior {
  std::unique_ptr<FunctionModel> model;
  std::unique_ptr<ParameterSpace> space;
  Eigen::VectorXd measured;
  Eigen::VectorXd noise;
  double log_evidence = 0.0;
  Eigen::VectorXd mean;                ///< of the posterior [parameter]
  Eigen::VectorXd standard_deviation;  ///< [parameter]

  UpdatingProblem problem() const {
    return {.model = *model,
            .space = *space,
            .tests = {Eigen::MatrixXd(measured.transpose()), noise},
            .cloud = {.samples = 200}};
  }
};

/// Integrals of w(x), x w(x) and x^2 w(x) by the trapezoidal rule, which is exact to rounding for smooth w that vanish
/// at both ends.
template <typename Weight>
Eigen::Vector3d moments_between(double lower, double upper, const Weight& weight) {
  constexpr int k_steps = 400000;
  const double h = (upper - lower) / k_steps;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 1; i < k_steps; ++i) {
    const double x = lower + h * i;
    sum += h * weight(x) * Eigen::Vector3d(1.0, x, x * x);
  }
  return sum;
}

inline double normal_density(double x, double mean, double std) {
  const double z = (x - mean) / std;
  return std::exp(-0.5 * z * z) / (std * std::sqrt(2.0 * 3.14159265358979323846));
}

inline std::unique_ptr<ParameterSpace> alike_parameters(int count, const Distribution& prior) {
  std::vector<Parameter> parameters;
  std::vector<Distribution> priors;
  for (int i = 0; i < count; ++i) {
    parameters.push_back({.name = fmt::format("x{}", i + 1), .unit = "-", .limit = {.lower = -HUGE_VAL}});
    priors.push_back(prior);
  }
  return std::make_unique<ParameterSpace>(parameters, JointDistribution(priors));
}

/// `count` oscillators alike, beside each other: stiffnesses log-normal of mean 1.5 and standard deviation 0.5, their
/// frequencies sqrt(x) in ascending order measured with noise. All orders of the stiffnesses meet the tests:
/// `count`! modes of the same probability. The frequencies lie tens of standard deviations apart, so that the order
/// never matters within a mode, and Z = count! prod_i int p(x) N(z_i; sqrt x, (noise z_i)^2) dx.
inline ShapedPosterior permuted_modes(int count, double noise) {
  const Distribution prior({.kind = DistributionKind::lognormal, .mean = 1.5, .std = 0.5});
  const double log_variance = std::log(1.0 + 1.0 / 9.0);
  const double log_mean = std::log(1.5) - 0.5 * log_variance;
  ShapedPosterior shape;
  shape.space = alike_parameters(count, prior);
  std::vector<Quantity> outputs;
  shape.measured.resize(count);
  Eigen::Vector3d all = Eigen::Vector3d::Zero();
  for (int i = 0; i < count; ++i) {
    outputs.push_back(named_quantity(fmt::format("f{}", i + 1), "-"));
    const double z = shape.measured(i) = 0.9 * std::pow(1.25, i);
    const Eigen::Vector3d one = moments_between(0.5 * z * z, 1.5 * z * z, [&](double x) {
      return normal_density(std::log(x), log_mean, std::sqrt(log_variance)) / x *
             normal_density(z, std::sqrt(x), noise * z);
    });
    shape.log_evidence += std::log(one(0)) + std::log(i + 1.0);
    all += one / one(0) / count;
  }
  shape.noise = noise * shape.measured;
  shape.mean = Eigen::VectorXd::Constant(count, all(1));
  shape.standard_deviation = Eigen::VectorXd::Constant(count, std::sqrt(all(2) - all(1) * all(1)));
  shape.model = std::make_unique<FunctionModel>(count, outputs, [](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    Eigen::VectorXd sorted = x.cwiseSqrt();
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  });
  return shape;
}

/// The banana of [Haario1999]: x1 and x2 standard normal, x2 + bend (x1^2 - 1) = 0 measured with the noise. Given x1
/// all is normal in x2: p(x1 | z) ~ N(x1) N(0; bend (x1^2 - 1), 1 + noise^2).
inline ShapedPosterior banana(double bend, double noise) {
  ShapedPosterior shape;
  shape.space = alike_parameters(2, Distribution({.kind = DistributionKind::normal, .mean = 0.0, .std = 1.0}));
  shape.measured = Eigen::VectorXd::Zero(1);
  shape.noise = Eigen::VectorXd::Constant(1, noise);
  const double variance = 1.0 + noise * noise;
  const auto weight = [&](double x) {
    return normal_density(x, 0.0, 1.0) * normal_density(0.0, bend * (x * x - 1.0), std::sqrt(variance));
  };
  const auto mean_of_second = [&](double x) { return -bend * (x * x - 1.0) / variance; };
  const Eigen::Vector3d first = moments_between(-12.0, 12.0, weight);
  const Eigen::Vector3d second =
      moments_between(-12.0, 12.0, [&](double x) { return weight(x) * mean_of_second(x); }) / first(0);
  const Eigen::Vector3d squares =
      moments_between(-12.0, 12.0, [&](double x) { return weight(x) * std::pow(mean_of_second(x), 2); }) / first(0);
  shape.log_evidence = std::log(first(0));
  shape.mean = Eigen::Vector2d(0.0, second(0));
  shape.standard_deviation = Eigen::Vector2d(std::sqrt(first(2) / first(0)),
                                             std::sqrt(squares(0) - second(0) * second(0) + noise * noise / variance));
  shape.model = std::make_unique<FunctionModel>(
      2, std::vector<Quantity>{named_quantity("y", "-")}, [bend](const Eigen::VectorXd& x) -> Eigen::VectorXd {
        return Eigen::VectorXd::Constant(1, x(1) + bend * (x(0) * x(0) - 1.0));
      });
  return shape;
}

}  // namespace mottle::test
