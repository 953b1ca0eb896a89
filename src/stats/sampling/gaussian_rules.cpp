#include "mottle/stats/sampling/gaussian_rules.hpp"

#include <Eigen/Core>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::stats {

GaussianRule hermite_rule(int points) {
  require(points >= 1, "a quadrature rule needs at least 1 point, found {}", points);
  Eigen::VectorXd off(points - 1);
  for (Eigen::Index k = 0; k < off.size(); ++k) off(k) = std::sqrt(static_cast<double>(k + 1));
  const SymmetricEigen solver(Eigen::VectorXd::Zero(points), off);
  return {solver.eigenvalues(), solver.eigenvectors().row(0).transpose().cwiseAbs2()};
}

GaussianRule tensor_hermite_rule(Eigen::Index dimension, int points) {
  constexpr double k_max_points = 1e6;
  require(dimension >= 1 && std::pow(points, static_cast<double>(dimension)) <= k_max_points,
          "a Gauss-Hermite rule of {} points in {} variables has too many points", points, dimension);
  const GaussianRule line = hermite_rule(points);
  GaussianRule rule{Eigen::MatrixXd::Zero(1, dimension), Eigen::VectorXd::Ones(1)};
  for (Eigen::Index j = 0; j < dimension; ++j) {
    const Eigen::Index before = rule.weights.size();
    GaussianRule next{rule.points.replicate(points, 1), Eigen::VectorXd(before * points)};
    for (Eigen::Index k = 0; k < points; ++k) {
      next.points.col(j).segment(k * before, before).setConstant(line.points(k, 0));
      next.weights.segment(k * before, before) = line.weights(k) * rule.weights;
    }
    rule = std::move(next);
  }
  return rule;
}

GaussianRule fifth_degree_rule(Eigen::Index dimension) {
  require(dimension >= 1, "a quadrature rule needs at least 1 variable");
  const auto q = static_cast<double>(dimension);
  const double arm = std::sqrt(3.0);
  GaussianRule rule{Eigen::MatrixXd::Zero(2 * dimension * dimension + 1, dimension),
                    Eigen::VectorXd::Constant(2 * dimension * dimension + 1, 1.0 / 36.0)};
  rule.weights(0) = (q * q - 7.0 * q + 18.0) / 18.0;
  Eigen::Index row = 1;
  for (Eigen::Index i = 0; i < dimension; ++i) {
    for (const double sign : {-1.0, 1.0}) {
      rule.weights(row) = (4.0 - q) / 18.0;
      rule.points(row++, i) = sign * arm;
    }
  }
  for (Eigen::Index i = 0; i < dimension; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      for (const double first : {-1.0, 1.0}) {
        for (const double second : {-1.0, 1.0}) {
          rule.points(row, i) = first * arm;
          rule.points(row++, j) = second * arm;
        }
      }
    }
  }
  return rule;
}

GaussianRule standardised_rule(const Eigen::Ref<const Eigen::MatrixXd>& uniforms) {
  require(uniforms.rows() > uniforms.cols(), "{} points are too few for {} variables, at least {} are needed",
          uniforms.rows(), uniforms.cols(), uniforms.cols() + 1);
  Eigen::MatrixXd points = uniforms.unaryExpr([](double uniform) { return standard_normal_quantile(uniform); });
  points.rowwise() -= points.colwise().mean().eval();
  const auto count = static_cast<double>(points.rows());
  const CholeskyFactor factor(points.transpose() * points / count);
  require(factor.is_positive_definite(), "{} points lie in a plane of their {} variables", points.rows(),
          points.cols());
  const Eigen::MatrixXd sheared = factor.solve_lower(points.transpose()).transpose();
  return {sheared, Eigen::VectorXd::Constant(points.rows(), 1.0 / count)};
}

}  // namespace mottle::stats
