// Natural frequencies as outputs.
#pragma once

#include "model/responses/response.hpp"
#include "mottle/layers.hpp"

namespace mottle::model {

class NaturalFrequencies final : public Response {
 public:
  NaturalFrequencies(std::vector<int> modes, std::string unit) : modes_(std::move(modes)), unit_(std::move(unit)) {}

  std::vector<Quantity> quantities() const override;
  ResponseNeeds needs() const override { return {.modes = modes_}; }
  std::string fill(const NumberedSolution& solution, Row row) const override;
  /// df/dx = (d lambda / dx) / (8 pi^2 f); nan at f = 0.
  Eigen::MatrixXd derivatives(const SolvedPoint& point) const override;

 private:
  std::vector<int> modes_;
  std::string unit_;
};

}  // namespace mottle::model
