// Eigenvalues of the undamped structure, lambda = (2 pi f)^2, as outputs.
#pragma once

#include "model/responses/response.hpp"
#include "mottle/layers.hpp"

namespace mottle::model {

class Eigenvalues final : public Response {
 public:
  Eigenvalues(std::vector<int> modes, std::string unit) : modes_(std::move(modes)), unit_(std::move(unit)) {}

  std::vector<Quantity> quantities() const override;
  ResponseNeeds needs() const override { return {.modes = modes_}; }
  std::string fill(const NumberedSolution& solution, Row row) const override;
  /// d lambda / dx = phi' (dK/dx - lambda dM/dx) phi, phi' M phi = 1 [Fox1968].
  Eigen::MatrixXd derivatives(const SolvedPoint& point) const override;

 private:
  std::vector<int> modes_;
  std::string unit_;
};

}  // namespace mottle::model
