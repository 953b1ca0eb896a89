// Ratios of two components of one mode shape as outputs: what a test without modal mass or phase reference gives.
#pragma once

#include "model/responses/response.hpp"
#include "mottle/layers.hpp"

namespace mottle::model {

/// r = phi_a / phi_b of one mode, the same for every size and sign of the shape. Unbounded where b comes near a node of
/// the mode: the denominator should move as much as any.
class ShapeRatios final : public Response {
 public:
  /// @param length  unit of length, for ratios of a rotation and a translation
  /// @throws InvalidInput  a mode or degree of freedom that the structure does not have, a ratio that is given twice
  ShapeRatios(std::vector<ShapeRatio> ratios, std::string length, const Structure& structure);

  ResponseNeeds needs() const override;
  /// @throws InvalidInput  the mode does not move a denominator
  void take_reference(const Eigen::MatrixXd& shapes) override;
  std::vector<Quantity> quantities() const override;
  std::string fill(const NumberedSolution& solution, Row row) const override;
  /// dr = (d phi_a - r d phi_b) / phi_b.
  Eigen::MatrixXd derivatives(const SolvedPoint& point) const override;

 private:
  std::vector<ShapeRatio> ratios_;
  std::string length_;
  std::vector<int> degrees_of_freedom_;  // a and b of each ratio in turn, by the structure's numbers
};

}  // namespace mottle::model
