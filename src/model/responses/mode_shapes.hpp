// Components of mass-normalised mode shapes as outputs, mode by mode.
#pragma once

#include "model/responses/response.hpp"
#include "mottle/layers.hpp"

namespace mottle::model {

class ModeShapes final : public Response {
 public:
  /// @throws InvalidInput  a degree of freedom that the structure does not have, a repeated one, or none
  ModeShapes(std::vector<int> modes, std::vector<std::string> degrees_of_freedom, std::string unit,
             const Structure& structure);

  std::vector<Quantity> quantities() const override;
  ResponseNeeds needs() const override {
    return {.modes = modes_, .degrees_of_freedom = degrees_of_freedom_, .shapes = !modes_.empty()};
  }
  std::string fill(const NumberedSolution& solution, Row row) const override;
  Eigen::MatrixXd derivatives(const SolvedPoint& point) const override;
  /// The quantities where derivatives are taken.
  Eigen::VectorXd values(const SolvedPoint& point) const;

 private:
  std::vector<int> modes_;
  std::vector<std::string> names_;       // of the degrees of freedom
  std::vector<int> degrees_of_freedom_;  // by the structure's numbers
  std::string unit_;
};

}  // namespace mottle::model
