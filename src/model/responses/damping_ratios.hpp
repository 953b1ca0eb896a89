// Modal damping ratios as outputs.
#pragma once

#include "model/responses/response.hpp"
#include "mottle/layers.hpp"

namespace mottle::model {

class DampingRatios final : public Response {
 public:
  /// @throws InvalidInput  the structure has no damper
  DampingRatios(std::vector<int> modes, const Structure& structure);

  std::vector<Quantity> quantities() const override;
  ResponseNeeds needs() const override { return {.modes = modes_, .shapes = true, .damping = true}; }
  std::string fill(const NumberedSolution& solution, Row row) const override;
  /// nan.
  Eigen::MatrixXd derivatives(const SolvedPoint& point) const override;

 private:
  std::vector<int> modes_;
};

}  // namespace mottle::model
