// The outputs of a model over a box of its parameters: values, derivatives and ranges.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/interval.hpp"

namespace mottle::updating {

/// Ranges are proven for natural frequencies and eigenvalues, by their order, of models whose matrices are known
/// (EigenvalueBounds). Those of modes that are followed by their shapes are proven where the ranges of neighbours do
/// not overlap, so that no two cross in the box. All others are searched for: in the corners, at points that fill the
/// box, and from the best of these by steps along the axes.
class BoxImage {
 public:
  /// @param problem  must outlive this object
  BoxImage(const UpdatingProblem& problem, const IntervalOptions& options, const RunContext& context);

  /// Outputs [point x output], a row of nan where the model fails: of the full matrices where all ranges are proven.
  Eigen::MatrixXd outputs(const Eigen::Ref<const Eigen::MatrixXd>& points);
  /// dy/dx at one point [output x parameter]; central differences for what the model does not give.
  Eigen::MatrixXd jacobian(const Eigen::VectorXd& point);
  /// Of every output.
  std::vector<OutputRange> ranges(const ParameterBox& box);

  /// Why nothing is proven; empty: ranges of eigenvalues are.
  const std::string& obstacle() const { return obstacle_; }
  std::vector<std::string> trends() const;
  std::int64_t evaluations() const { return evaluations_; }
  /// Outputs whose modes may cross another one in the last box, so that their ranges are not proven.
  const std::vector<std::string>& crossing() const { return crossing_; }

 private:
  void prove(const ParameterBox& box, std::vector<OutputRange>& ranges);
  void search(const ParameterBox& box, std::vector<OutputRange>& ranges);
  void certify(std::vector<OutputRange>& ranges);
  bool keeps_its_place(int mode, const Eigen::VectorXd& point) const;
  Eigen::MatrixXd corners_by_slopes(const ParameterBox& box);
  void take(const Eigen::MatrixXd& points, std::vector<OutputRange>& ranges);
  int highest_mode() const;

  const UpdatingProblem& problem_;
  const IntervalOptions& options_;
  const RunContext& context_;
  const StructureModel* structure_ = nullptr;  // null: the model's matrices are not known
  std::optional<EigenvalueBounds> bounds_;
  std::string obstacle_;
  bool is_tracked_ = false;
  bool is_exact_ = false;  // all outputs are eigenvalues by their order
  int mode_count_ = 0;     // of the structure
  Eigen::VectorXd prior_std_;
  std::int64_t evaluations_ = 0;
  std::vector<std::string> crossing_;
};

}  // namespace mottle::updating
