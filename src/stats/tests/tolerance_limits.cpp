#include "mottle/stats/tests/tolerance_limits.hpp"

#include <array>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <vector>

#include "mottle/core/error.hpp"

namespace mottle::stats {
namespace {

constexpr double k_least = 0.5;
constexpr double k_most = 0.999;

void require_probability(const char* name, double value) {
  require(value >= k_least && value <= k_most, "{}: {} is outside [{}, {}]", name, value, k_least, k_most);
}

/// The root of a function that rises through zero between two ends.
template <class Function>
double root_between(const Function& function, double low, double high) {
  std::uintmax_t rounds = 200;
  const auto ends =
      boost::math::tools::toms748_solve(function, low, high, boost::math::tools::eps_tolerance<double>(50), rounds);
  return 0.5 * (ends.first + ends.second);
}

/// r of Phi(z + r) - Phi(z - r) = content.
double half_width(double z, double content) {
  const boost::math::normal law;
  const auto excess = [&](double r) { return cdf(law, z + r) - cdf(law, z - r) - content; };
  return root_between(excess, 0.0, z + 10.0);
}

struct ToleranceNode {
  double weight;  ///< of the mean's deviation t = sqrt(n) z, its density included
  double squared_half_width;
};

std::vector<ToleranceNode> nodes_of(int specimens, double content) {
  constexpr double k_reach = 9.0;  // beyond, the mean of a sample lies with probability 2e-19
  constexpr int k_pieces = 6;
  using Rule = boost::math::quadrature::gauss<double, 20>;
  const double half = 0.5 * k_reach / k_pieces;
  std::vector<ToleranceNode> nodes;
  for (int piece = 0; piece < k_pieces; ++piece) {
    for (std::size_t k = 0; k < Rule::abscissa().size(); ++k) {
      for (const double sign : {-1.0, 1.0}) {
        const double t = half * (2 * piece + 1 + sign * Rule::abscissa()[k]);
        const double r = half_width(t / std::sqrt(static_cast<double>(specimens)), content);
        nodes.push_back({2.0 * half * Rule::weights()[k] * pdf(boost::math::normal(), t), r * r});
      }
    }
  }
  return nodes;
}

}  // namespace

double normal_tolerance_factor(int specimens, double content, double confidence) {
  require(specimens >= 2, "specimens: {}, at least 2 are needed for tolerance limits", specimens);
  require_probability("content", content);
  require_probability("confidence", confidence);
  const std::vector<ToleranceNode> nodes = nodes_of(specimens, content);
  const double freedom = specimens - 1;
  const boost::math::chi_squared law(freedom);
  const auto excess = [&](double k) {
    double sum = 0.0;
    for (const ToleranceNode& node : nodes) {
      sum += node.weight * cdf(complement(law, freedom * node.squared_half_width / (k * k)));
    }
    return sum - confidence;
  };
  double high = 4.0;
  while (excess(high) < 0.0) high *= 2.0;
  return root_between(excess, 1e-3, high);
}

double confidence_of_extremes(int specimens, double content) {
  require(specimens >= 2, "specimens: {}, at least 2 are needed for tolerance limits", specimens);
  const double n = specimens;
  return 1.0 - n * std::pow(content, n - 1.0) + (n - 1.0) * std::pow(content, n);
}

double content_of_extremes(int specimens, double confidence) {
  require_probability("confidence", confidence);
  return root_between([&](double content) { return confidence - confidence_of_extremes(specimens, content); }, 0.0,
                      1.0);
}

int specimens_for_extremes(double content, double confidence) {
  require_probability("content", content);
  require_probability("confidence", confidence);
  int specimens = 2;
  while (confidence_of_extremes(specimens, content) < confidence) ++specimens;
  return specimens;
}

}  // namespace mottle::stats
