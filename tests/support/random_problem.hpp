// Sound updating problems drawn at random: chains of masses with few specimens, singular populations, gaps and scales.
#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "mottle/model/parameters/parameter_space.hpp"
#include "mottle/model/structure_model.hpp"
#include "mottle/model/structures/affine_matrices.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::test {

using namespace updating;  // of which these are the tests

/// Problem `number`: 2 to 6 specimens of a chain of 1 to 7 masses whose 1 to 6 springs are to be found from 1 to 7
/// frequencies. Everything about it follows from its number.
class RandomProblem {
 public:
  enum class Scatter { independent, correlated, one_direction, two_directions, some_without, nearly_none, none };
  enum class Noise { none, known, as_large_as_scatter, unknown };

  explicit RandomProblem(std::uint32_t number) : stream_({.seed = 20141, .purpose = StreamPurpose::truth}, number) {
    parameters_ = 1 + below(6);
    outputs_ = 1 + below(7);
    specimens_ = 2 + below(5);
    scatter_ = static_cast<Scatter>(below(7));
    noise_ = static_cast<Noise>(below(4));
    make_space();
    make_model();
    make_tests();
    if (below(5) == 0) {
      groups_.resize(static_cast<std::size_t>(parameters_));
      std::iota(groups_.begin(), groups_.end(), 0);
    }
  }

  UpdatingProblem problem() const {
    return {.model = *model_,
            .derivatives = model_.get(),
            .space = *space_,
            .tests = tests_,
            .cloud = {.samples = 50},
            .iterations = 30,
            .covariance_groups = groups_};
  }

  std::string description() const {
    static const std::vector<std::string> scatters{"independent",  "correlated",  "one direction", "two directions",
                                                   "some without", "nearly none", "none"};
    static const std::vector<std::string> noises{"none", "known", "as large as scatter", "unknown"};
    return fmt::format("{} specimens, {} parameters, {} outputs, scatter {}, noise {}, {} missing, {} scales, {}",
                       specimens_, parameters_, outputs_, scatters[static_cast<std::size_t>(scatter_)],
                       noises[static_cast<std::size_t>(noise_)], tests_.values.array().isNaN().count(), scaled_,
                       groups_.empty() ? "full covariance" : "diagonal covariance");
  }

 private:
  Eigen::Index below(Eigen::Index count) {
    return std::min(static_cast<Eigen::Index>(stream_.uniform() * static_cast<double>(count)), count - 1);
  }
  double between(double low, double high) { return low + (high - low) * stream_.uniform(); }
  double normal() { return standard_normal_quantile(stream_.uniform()); }

  void make_space() {
    std::vector<Parameter> parameters;
    std::vector<Distribution> marginals;
    truth_.resize(parameters_);
    for (Eigen::Index i = 0; i < parameters_; ++i) {
      truth_(i) = between(0.8, 1.3);
      const double mean = truth_(i) * between(0.75, 1.4);
      Parameter parameter{fmt::format("k{}", i + 1), "N/m", 0.2, 5.0};
      const Eigen::Index kind = below(5);  // identity in three of five
      if (kind == 1) parameter.transform = {ParameterTransform::Kind::log};
      if (kind == 2) parameter.transform = {ParameterTransform::Kind::logit, 0.2, 5.0};
      scaled_ += kind == 1 || kind == 2 ? 1 : 0;
      parameters.push_back(parameter);
      marginals.emplace_back(DistributionSpec{.kind = DistributionKind::normal, .mean = mean, .std = 0.2 * mean});
    }
    space_ = std::make_unique<ParameterSpace>(parameters, JointDistribution(marginals));
  }

  /// A chain of springs between unequal masses, each with a spring to ground. Parameters are the first springs to
  /// ground and then those of the chain: no two of them move the frequencies alike.
  void make_model() {
    const Eigen::Index masses = std::max(outputs_, (parameters_ + 2) / 2);
    MassSpringSystem system;
    for (Eigen::Index m = 0; m < masses; ++m) {
      system.masses.push_back({fmt::format("m{}", m + 1), 1.0 + 0.13 * static_cast<double>(m)});
    }
    std::vector<std::string> springs;
    for (Eigen::Index m = 0; m < masses; ++m) {
      const auto at = static_cast<int>(m);
      springs.push_back(fmt::format("g{}", m + 1));
      system.springs.push_back({springs.back(), k_ground, at, 1.0});
      if (m == 0) continue;
      springs.push_back(fmt::format("c{}", m));
      system.springs.push_back({springs.back(), at - 1, at, 1.0});
    }
    std::vector<ParameterTargets> targets;
    for (Eigen::Index i = 0; i < parameters_; ++i) {
      targets.push_back({fmt::format("k{}", i + 1), {"spring:" + springs[static_cast<std::size_t>(i)]}});
    }
    OutputSelection selection;
    for (Eigen::Index k = 1; k <= outputs_; ++k) selection.frequencies.push_back(static_cast<int>(k));
    model_ = std::make_unique<StructureModel>(separate(system, targets), selection, space_->prior().mean());
  }

  Eigen::MatrixXd specimens() {
    const Eigen::Index directions = scatter_ == Scatter::one_direction    ? 1
                                    : scatter_ == Scatter::two_directions ? 2
                                                                          : parameters_;
    Eigen::MatrixXd root = Eigen::MatrixXd::Identity(parameters_, parameters_);
    if (scatter_ == Scatter::correlated || directions < parameters_) {
      root = Eigen::MatrixXd::NullaryExpr(parameters_, directions, [&] { return normal(); });
    }
    double standard_deviation = between(0.02, 0.12);
    if (scatter_ == Scatter::nearly_none) standard_deviation = 1e-7;
    if (scatter_ == Scatter::none) standard_deviation = 0.0;
    root = (standard_deviation * root.rowwise().norm().cwiseInverse().asDiagonal() * root).eval();
    if (scatter_ == Scatter::some_without) root.row(below(parameters_)).setZero();
    Eigen::MatrixXd x(specimens_, parameters_);
    for (Eigen::Index s = 0; s < specimens_; ++s) {
      const Eigen::VectorXd z = Eigen::VectorXd::NullaryExpr(root.cols(), [&] { return normal(); });
      x.row(s) = truth_.cwiseProduct(Eigen::VectorXd::Ones(parameters_) + root * z).cwiseMax(0.3).transpose();
    }
    return x;
  }

  void make_tests() {
    Eigen::MatrixXd values = model_->evaluate(specimens(), {}).outputs;
    Eigen::VectorXd level = Eigen::VectorXd::Zero(outputs_);
    if (noise_ == Noise::known || noise_ == Noise::unknown) level = 0.002 * values.row(0).transpose();
    if (noise_ == Noise::as_large_as_scatter) level = 0.03 * values.row(0).transpose();
    for (Eigen::Index s = 0; s < specimens_; ++s) {
      for (Eigen::Index k = 0; k < outputs_; ++k) values(s, k) += level(k) * normal();
    }
    // Without noise, repeated numbers to the last digit: what identical specimens give.
    tests_ = {values, noise_ == Noise::unknown ? Eigen::VectorXd(Eigen::VectorXd::Zero(outputs_)) : level};
    if (below(3) == 0) leave_gaps();
  }

  void leave_gaps() {
    for (Eigen::Index s = 0; s < specimens_; ++s) {
      for (Eigen::Index k = 0; k < outputs_; ++k) {
        const bool is_left = stream_.uniform() < 0.2;
        const auto known = !tests_.values.array().isNaN();
        // An output of a single specimen has no scatter, a specimen without any output is none.
        if (!is_left || known.col(k).count() <= 2 || known.row(s).count() <= 1) continue;
        tests_.values(s, k) = std::numeric_limits<double>::quiet_NaN();
      }
    }
  }

  RandomStream stream_;
  Eigen::Index parameters_ = 1;
  Eigen::Index outputs_ = 1;
  Eigen::Index specimens_ = 2;
  Scatter scatter_ = Scatter::independent;
  Noise noise_ = Noise::none;
  int scaled_ = 0;
  Eigen::VectorXd truth_;
  std::unique_ptr<ParameterSpace> space_;
  std::unique_ptr<StructureModel> model_;
  TestData tests_;
  std::vector<int> groups_;
};

}  // namespace mottle::test
