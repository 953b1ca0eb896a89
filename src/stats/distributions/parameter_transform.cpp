#include "mottle/stats/distributions/parameter_transform.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/process_mutex.hpp"
#include "mottle/stats/sampling/gaussian_rules.hpp"

namespace mottle::stats {
namespace {

const GaussianRule& rule() {
  const NoFork no_fork;
  static const GaussianRule result = hermite_rule(40);
  return result;
}

/// Strictly within the bounds, as a mean is: the sum may round to an end or past it.
double mean_by_quadrature(const ParameterTransform& transform, double mean, double std) {
  const auto& [nodes, weights] = rule();
  double sum = 0.0;
  for (Eigen::Index k = 0; k < nodes.rows(); ++k) sum += weights(k) * transform.to_variable(mean + std * nodes(k, 0));
  return std::clamp(sum, std::nextafter(transform.lower, transform.upper),
                    std::nextafter(transform.upper, transform.lower));
}

double covariance_by_quadrature(const ParameterTransform& first, const ParameterTransform& second,
                                const Eigen::Vector2d& mean, const Eigen::Matrix2d& covariance,
                                const Eigen::Vector2d& means_of_variables) {
  const auto& [nodes, weights] = rule();
  const double a = std::sqrt(covariance(0, 0));
  const double b = a > 0.0 ? covariance(0, 1) / a : 0.0;
  const double c = std::sqrt(std::max(covariance(1, 1) - b * b, 0.0));
  double sum = 0.0;
  for (Eigen::Index i = 0; i < nodes.rows(); ++i) {
    const double x = first.to_variable(mean(0) + a * nodes(i, 0)) - means_of_variables(0);
    for (Eigen::Index j = 0; j < nodes.rows(); ++j) {
      const double y = second.to_variable(mean(1) + b * nodes(i, 0) + c * nodes(j, 0)) - means_of_variables(1);
      sum += weights(i) * weights(j) * x * y;
    }
  }
  return sum;
}

}  // namespace

const char* scale_name(ParameterTransform::Kind kind) {
  switch (kind) {
    case ParameterTransform::Kind::log:
      return "log";
    case ParameterTransform::Kind::logit:
      return "logit";
    case ParameterTransform::Kind::identity:
      break;
  }
  return "identity";
}

double ParameterTransform::from_variable(double x) const {
  if (kind == Kind::log) return std::log(x);
  if (kind == Kind::logit) return std::log((x - lower) / (upper - x));
  return x;
}

double ParameterTransform::to_variable(double t) const {
  if (kind == Kind::log) return std::exp(t);
  if (kind == Kind::logit) return lower + (upper - lower) / (1.0 + std::exp(-t));
  return t;
}

double ParameterTransform::slope(double t) const {
  if (kind == Kind::log) return std::exp(t);
  if (kind == Kind::logit) {
    const double small = std::exp(-std::abs(t));
    return (upper - lower) * small / ((1.0 + small) * (1.0 + small));
  }
  return 1.0;
}

Eigen::MatrixXd to_variables(const std::vector<ParameterTransform>& transforms,
                             const Eigen::Ref<const Eigen::MatrixXd>& points) {
  Eigen::MatrixXd x = points;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const ParameterTransform& transform = transforms[static_cast<std::size_t>(i)];
    for (double& value : x.col(i)) value = transform.to_variable(value);
  }
  return x;
}

Eigen::MatrixXd from_variables(const std::vector<ParameterTransform>& transforms,
                               const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  Eigen::MatrixXd t = samples;
  for (Eigen::Index i = 0; i < t.cols(); ++i) {
    const ParameterTransform& transform = transforms[static_cast<std::size_t>(i)];
    for (double& value : t.col(i)) value = transform.from_variable(value);
  }
  return t;
}

VariableMoments moments_of_variables(const std::vector<ParameterTransform>& transforms,
                                     const Eigen::Ref<const Eigen::VectorXd>& mean,
                                     const Eigen::Ref<const Eigen::MatrixXd>& covariance) {
  using Kind = ParameterTransform::Kind;
  VariableMoments result{mean, covariance};
  const auto transform = [&](Eigen::Index i) -> const ParameterTransform& {
    return transforms[static_cast<std::size_t>(i)];
  };
  for (Eigen::Index i = 0; i < mean.size(); ++i) {
    if (transform(i).kind == Kind::log) result.mean(i) = std::exp(mean(i) + 0.5 * covariance(i, i));
    if (transform(i).kind == Kind::logit)
      result.mean(i) = mean_by_quadrature(transform(i), mean(i), std::sqrt(covariance(i, i)));
  }
  for (Eigen::Index i = 0; i < mean.size(); ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      const Kind first = transform(i).kind;
      const Kind second = transform(j).kind;
      double& entry = result.covariance(i, j);
      if (first == Kind::logit || second == Kind::logit) {
        Eigen::Matrix2d block;
        block << covariance(i, i), covariance(i, j), covariance(i, j), covariance(j, j);
        entry = covariance_by_quadrature(transform(i), transform(j), {mean(i), mean(j)}, block,
                                         {result.mean(i), result.mean(j)});
      } else if (first == Kind::log && second == Kind::log) {
        entry = result.mean(i) * result.mean(j) * std::expm1(covariance(i, j));
      } else if (first == Kind::log) {
        entry = covariance(i, j) * result.mean(i);
      } else if (second == Kind::log) {
        entry = covariance(i, j) * result.mean(j);
      }
      result.covariance(j, i) = entry;
    }
  }
  return result;
}

}  // namespace mottle::stats
