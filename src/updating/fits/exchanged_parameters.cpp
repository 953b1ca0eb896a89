#include "updating/fits/exchanged_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace mottle::updating {
namespace {

using Order = std::vector<Eigen::Index>;

bool are_alike(const ScaledParameters& parameters, Eigen::Index i, Eigen::Index j) {
  constexpr double k_equal = 1e-9;
  const ParameterTransform& one = parameters.scales()[static_cast<std::size_t>(i)];
  const ParameterTransform& other = parameters.scales()[static_cast<std::size_t>(j)];
  const double std = parameters.standard_deviation()(i);
  const auto differ = [&](double a, double b) { return std::abs(a - b) > k_equal * std; };
  return one.kind == other.kind && one.lower == other.lower && one.upper == other.upper &&
         !differ(std, parameters.standard_deviation()(j)) && !differ(parameters.start()(i), parameters.start()(j));
}

/// Groups of parameters that are alike, those of one member too.
std::vector<Order> groups_of(const ScaledParameters& parameters) {
  std::vector<Order> groups;
  for (Eigen::Index i = 0; i < parameters.count(); ++i) {
    const auto group =
        std::ranges::find_if(groups, [&](const Order& members) { return are_alike(parameters, members.front(), i); });
    if (group == groups.end()) {
      groups.push_back({i});
    } else {
      group->push_back(i);
    }
  }
  return groups;
}

Order identity(Eigen::Index count) {
  Order order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  return order;
}

std::vector<Order> of_two(const std::vector<Order>& groups, Eigen::Index count) {
  std::vector<Order> permutations;
  for (const Order& members : groups) {
    for (std::size_t i = 0; i < members.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        permutations.push_back(identity(count));
        std::swap(permutations.back()[static_cast<std::size_t>(members[i])],
                  permutations.back()[static_cast<std::size_t>(members[j])]);
      }
    }
  }
  return permutations;
}

/// Like the digits of a number: a group that comes back to its first order moves the next one on.
std::vector<Order> all_of(const std::vector<Order>& groups, Eigen::Index count) {
  std::vector<Order> order = groups;
  std::vector<Order> permutations;
  const auto next = [](Order& members) { return std::next_permutation(members.begin(), members.end()); };
  while (std::ranges::find_if(order, next) != order.end()) {
    permutations.push_back(identity(count));
    for (std::size_t g = 0; g < groups.size(); ++g) {
      for (std::size_t k = 0; k < groups[g].size(); ++k) {
        permutations.back()[static_cast<std::size_t>(groups[g][k])] = order[g][k];
      }
    }
  }
  return permutations;
}

}  // namespace

std::vector<std::vector<Eigen::Index>> exchanges(const ScaledParameters& parameters) {
  constexpr double k_most = 120.0;  // five alike
  const std::vector<Order> groups = groups_of(parameters);
  double number = 1.0;
  for (const Order& members : groups) number *= std::tgamma(static_cast<double>(members.size()) + 1.0);
  return number <= k_most ? all_of(groups, parameters.count()) : of_two(groups, parameters.count());
}

}  // namespace mottle::updating
