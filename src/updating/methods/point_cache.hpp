// Outputs and slopes of a model at points, each found once.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "mottle/layers.hpp"
#include "updating/methods/box_image.hpp"

namespace mottle::updating {

/// Outputs and slopes at points of which many are the same.
class PointCache {
 public:
  explicit PointCache(BoxImage& image) : image_(image) {}

  /// Whether the model gives outputs at all of them.
  bool evaluate(const std::vector<Eigen::VectorXd>& points) {
    std::vector<Eigen::VectorXd> unknown;
    for (const Eigen::VectorXd& point : points) {
      const auto is_same = [&](const Eigen::VectorXd& other) { return other == point; };
      if (find(point) == nullptr && std::ranges::none_of(unknown, is_same)) unknown.push_back(point);
    }
    if (!unknown.empty()) {
      Eigen::MatrixXd rows(static_cast<Eigen::Index>(unknown.size()), unknown.front().size());
      for (Eigen::Index s = 0; s < rows.rows(); ++s) rows.row(s) = unknown[static_cast<std::size_t>(s)].transpose();
      const Eigen::MatrixXd outputs = image_.outputs(rows);
      for (Eigen::Index s = 0; s < rows.rows(); ++s) {
        known_.push_back({unknown[static_cast<std::size_t>(s)], outputs.row(s).transpose(), {}});
      }
    }
    return std::ranges::all_of(points, [&](const auto& point) { return find(point)->outputs.allFinite(); });
  }
  double value(const Eigen::VectorXd& point, Eigen::Index output) { return find(point)->outputs(output); }
  Eigen::VectorXd slope(const Eigen::VectorXd& point, Eigen::Index output) {
    Known& known = *find(point);
    if (known.jacobian.size() == 0) known.jacobian = image_.jacobian(point);
    return known.jacobian.row(output).transpose();
  }

 private:
  struct Known {
    Eigen::VectorXd at, outputs;
    Eigen::MatrixXd jacobian;
  };
  Known* find(const Eigen::VectorXd& point) {
    const auto place = std::ranges::find_if(known_, [&](const Known& known) { return known.at == point; });
    return place == known_.end() ? nullptr : &*place;
  }

  BoxImage& image_;
  std::vector<Known> known_;
};

}  // namespace mottle::updating
