// Posteriors of two-parameter problems whose evidence and moments are known by quadrature, for tests and validation.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "mottle/stats/distributions/distribution.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/updating/sampling/sequential_monte_carlo.hpp"

namespace mottle::test {

using namespace updating;  // of which these are the tests

/// The two-storey shear frame of Beck and Au (2002): stiffness factors (a, b) of the storeys, log-normal, two measured
/// frequencies of a structure with two unknowns; a ridge with two modes.
struct BeckAu {
  static Eigen::Vector2d parameters(const Eigen::Ref<const Eigen::RowVectorXd>& u) {
    return {std::exp(0.5102367348 + 0.4978679246 * u(0)), std::exp(0.1695776862 + 0.6266747461 * u(1))};
  }
  static double log_likelihood(const Eigen::Ref<const Eigen::RowVectorXd>& u) {
    constexpr double k_pi = 3.14159265358979323846;
    constexpr double k_stiffness = 29.7e6;
    constexpr double k_masses[] = {16.5e3, 16.1e3};
    constexpr double k_measured[] = {3.13, 9.83};
    const Eigen::Vector2d theta = parameters(u);
    const double a = (theta(0) + theta(1)) * k_stiffness / k_masses[0];
    const double b = theta(1) * k_stiffness / k_masses[1];
    const double half = 0.5 * (a + b);
    const double product = theta(0) * theta(1) * k_stiffness * k_stiffness / (k_masses[0] * k_masses[1]);
    const double high = half + std::sqrt(half * half - product);
    const double low = product / high;
    const double first = low / std::pow(2.0 * k_pi * k_measured[0], 2) - 1.0;
    const double second = high / std::pow(2.0 * k_pi * k_measured[1], 2) - 1.0;
    return -(first * first + second * second) / (2.0 * std::pow(0.5, 8));
  }
};

/// Eigenvalues ((a + 2 b) +- sqrt(a^2 + 4 b^2)) / 2 measured once each, uniform priors on [0.01, 4]: two modes of the
/// same probability. The likelihood is exp(-chi^2 / 2), without its constant.
struct TwinEigenvalues {
  static constexpr double k_width = 4.0 - 0.01;
  static Eigen::Vector2d parameters(const Eigen::Ref<const Eigen::RowVectorXd>& u) {
    return {0.01 + k_width * standard_normal_cdf(u(0)), 0.01 + k_width * standard_normal_cdf(u(1))};
  }
  static double log_likelihood(const Eigen::Ref<const Eigen::RowVectorXd>& u) {
    const Eigen::Vector2d x = parameters(u);
    const double root = std::sqrt(x(0) * x(0) + 4.0 * x(1) * x(1));
    const double high = 0.5 * (x(0) + 2.0 * x(1) + root);
    const double low = 0.5 * (x(0) + 2.0 * x(1) - root);
    return -0.5 * std::pow((high - 3.27069063) / 0.1, 2) - 0.5 * std::pow((low - 0.22930937) / 0.05, 2);
  }
};

/// A problem of the above as the sampler takes it.
template <typename Problem>
SamplingTarget target_of() {
  return {.dimension = 2, .log_likelihood = [](const Eigen::MatrixXd& points) {
            Eigen::VectorXd values(points.rows());
            for (Eigen::Index s = 0; s < points.rows(); ++s) values(s) = Problem::log_likelihood(points.row(s));
            return values;
          }};
}

/// The parameters of all islands' particles [particle x 2].
template <typename Problem>
Eigen::MatrixXd parameters_of(const std::vector<SampledIsland>& islands) {
  Eigen::Index rows = 0;
  for (const SampledIsland& island : islands) rows += island.points.rows();
  Eigen::MatrixXd all(rows, 2);
  Eigen::Index next = 0;
  for (const SampledIsland& island : islands) {
    for (Eigen::Index s = 0; s < island.points.rows(); ++s) {
      all.row(next++) = Problem::parameters(island.points.row(s)).transpose();
    }
  }
  return all;
}

}  // namespace mottle::test
