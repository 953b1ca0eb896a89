// Displacements under static loads as outputs, load by load.
#pragma once

#include "model/responses/response.hpp"
#include "mottle/layers.hpp"

namespace mottle::model {

/// B u of K(x) u = f, f constant.
class StaticDisplacements final : public Response {
 public:
  /// @throws InvalidInput  a structure without stiffness matrix, a load without force, a degree of freedom that the
  ///                       structure does not have or that is fixed
  StaticDisplacements(const std::vector<StaticLoad>& loads, const UnitNames& units, const Structure& structure);

  std::vector<Quantity> quantities() const override { return quantities_; }
  ResponseNeeds needs() const override { return {.degrees_of_freedom = degrees_of_freedom_, .loads = loads_}; }
  std::string fill(const NumberedSolution& solution, Row row) const override;
  /// du/dx = -K^-1 (dK/dx) u.
  Eigen::MatrixXd derivatives(const SolvedPoint& point) const override;

 private:
  std::vector<Quantity> quantities_;
  std::vector<int> degrees_of_freedom_;  // of all loads, one after the other, by the structure's numbers
  Eigen::MatrixXd loads_;                // f [equation x load]
};

}  // namespace mottle::model
