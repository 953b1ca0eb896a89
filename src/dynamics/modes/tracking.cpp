#include "mottle/dynamics/modes/tracking.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <set>

#include "mottle/dynamics/modes/mac.hpp"
#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::dynamics {
namespace {

constexpr double k_shares_shape = 0.1;  // MAC from which a mode counts as part of another's shape
constexpr std::size_t k_largest_group = 6;

/// Group of reference modes that are mixed with one another in the sample's shapes, starting from one of them.
std::set<int> mixed_group(const Eigen::Ref<const Eigen::MatrixXd>& cosines, const std::vector<int>& mode, int start) {
  std::set<int> group{start};
  std::vector<int> open{start};
  while (!open.empty() && group.size() < k_largest_group) {
    const int row = open.back();
    open.pop_back();
    for (int other = 0; other < cosines.rows(); ++other) {
      const double shared = std::max(std::pow(cosines(row, mode[static_cast<std::size_t>(other)]), 2),
                                     std::pow(cosines(other, mode[static_cast<std::size_t>(row)]), 2));
      if (shared >= k_shares_shape && group.insert(other).second) open.push_back(other);
    }
  }
  return group;
}

double subspace_mac(const Eigen::Ref<const Eigen::MatrixXd>& cosines, const std::vector<int>& mode,
                    const std::set<int>& group) {
  const std::vector<int> rows(group.begin(), group.end());
  std::vector<int> columns;
  for (const int row : rows) columns.push_back(mode[static_cast<std::size_t>(row)]);
  const Eigen::MatrixXd block = cosines(rows, columns);
  const double smallest = SingularValues(block).values().minCoeff();
  return smallest * smallest;
}

}  // namespace

TrackedModes track_modes(const Eigen::Ref<const Eigen::MatrixXd>& cosines, double minimum_mac) {
  TrackedModes tracked;
  tracked.mode = optimal_assignment(cosines.cwiseAbs2());
  const int count = static_cast<int>(cosines.rows());
  for (int i = 0; i < count; ++i)
    tracked.mac.push_back(std::pow(cosines(i, tracked.mode[static_cast<std::size_t>(i)]), 2));
  tracked.subspace_mac = tracked.mac;
  std::set<std::vector<int>> groups;
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (tracked.mac[k] >= minimum_mac) continue;
    const std::set<int> group = mixed_group(cosines, tracked.mode, i);
    tracked.subspace_mac[k] = std::max(tracked.mac[k], subspace_mac(cosines, tracked.mode, group));
    if (tracked.subspace_mac[k] >= minimum_mac) groups.insert({group.begin(), group.end()});
  }
  tracked.mixed.assign(groups.begin(), groups.end());
  for (int i = 0; i < count; ++i) {
    for (int j = i + 1; j < count; ++j) {
      if (tracked.mode[static_cast<std::size_t>(i)] > tracked.mode[static_cast<std::size_t>(j)]) {
        tracked.crossed.emplace_back(i, j);
      }
    }
  }
  return tracked;
}

}  // namespace mottle::dynamics
