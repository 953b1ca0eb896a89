#include "mottle/dynamics/modes/close_modes.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/dynamics/modes/mac.hpp"
#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::dynamics {
namespace {

constexpr double k_close = 0.1;    // relative difference of the model's frequencies
constexpr double k_partner = 0.2;  // relative difference of a pair's frequencies
constexpr std::size_t k_largest_group = 4;
constexpr double k_sure_mac = 0.8;

bool is_within(double value, double of, double limit) {
  return std::abs(value / of - 1.0) <= limit;
}

/// Components that were measured in all modes of the group and exist in the model.
std::vector<Eigen::Index> shared_rows(const Eigen::MatrixXd& reference, const Eigen::MatrixXd& measured) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index k = 0; k < measured.rows(); ++k) {
    if (measured.row(k).allFinite() && reference.row(k).allFinite()) rows.push_back(k);
  }
  return rows;
}

double subspace_mac(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::MatrixXd cosines = orthonormal_columns(a).transpose() * orthonormal_columns(b);
  return std::pow(SingularValues(cosines).values().minCoeff(), 2);
}

/// MAC of the group; 0 where too few components were measured.
double group_mac(const std::vector<int>& group, const std::map<int, Eigen::Index>& pairs,
                 const ShapesAndFrequencies& reference, const ShapesAndFrequencies& measured) {
  std::vector<Eigen::Index> tests;
  for (const int mode : group) tests.push_back(pairs.at(mode));
  const Eigen::MatrixXd own = reference.shapes(Eigen::all, group);
  const Eigen::MatrixXd found = measured.shapes(Eigen::all, tests);
  const std::vector<Eigen::Index> rows = shared_rows(own, found);
  if (rows.size() < 2 * group.size()) return 0.0;
  return subspace_mac(own(rows, Eigen::all), found(rows, Eigen::all));
}

Eigen::VectorXd without_gaps(const Eigen::VectorXd& shape) {
  return shape.array().isNaN().select(0.0, shape);
}

/// The other modes that are close, the most alike in shape first.
std::vector<int> neighbours(int mode, const std::map<int, Eigen::Index>& pairs, const ShapesAndFrequencies& reference,
                            const ShapesAndFrequencies& measured) {
  std::vector<int> close;
  for (const auto& [other, test] : pairs) {
    const double frequency = reference.frequencies(other);
    if (other != mode && is_within(frequency, reference.frequencies(mode), k_close) &&
        is_within(measured.frequencies(test), frequency, k_partner))
      close.push_back(other);
  }
  const Eigen::VectorXd found = without_gaps(measured.shapes.col(pairs.at(mode)));
  const auto shared = [&](int other) {
    return std::abs(shape_cosines(without_gaps(reference.shapes.col(other)), found)(0, 0));
  };
  std::ranges::stable_sort(close, [&](int a, int b) { return shared(a) > shared(b); });
  return close;
}

}  // namespace

CloseModes close_modes(int mode, const std::map<int, Eigen::Index>& pairs, const ShapesAndFrequencies& reference,
                       const ShapesAndFrequencies& measured) {
  if (!is_within(measured.frequencies(pairs.at(mode)), reference.frequencies(mode), k_partner)) return {};
  CloseModes best;
  std::vector<int> group{mode};
  for (const int other : neighbours(mode, pairs, reference, measured)) {
    if (group.size() == k_largest_group || best.mac >= k_sure_mac) break;
    group.push_back(other);
    const double mac = group_mac(group, pairs, reference, measured);
    if (mac > best.mac) best = {group, mac};
  }
  return best;
}

}  // namespace mottle::dynamics
