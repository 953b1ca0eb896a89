#include "mottle/updating/estimate/estimate.hpp"

#include <limits>

#include "mottle/core/random.hpp"

namespace mottle::updating {

std::string estimate_kind_text(EstimateKind kind) {
  switch (kind) {
    case EstimateKind::population:
      return "population";
    case EstimateKind::mean:
      return "mean";
    case EstimateKind::posterior:
      return "posterior";
    case EstimateKind::box:
      break;
  }
  return "box";
}

Eigen::MatrixXd Estimate::correlation() const {
  const Eigen::MatrixXd spread = covariance();
  const Eigen::VectorXd standard_deviation = spread.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse = standard_deviation.unaryExpr(
      [](double value) { return value > 0.0 ? 1.0 / value : std::numeric_limits<double>::quiet_NaN(); });
  return inverse.asDiagonal() * spread * inverse.asDiagonal();
}

Eigen::MatrixXd Estimate::draw_specimens(const SpecimenDrawing& drawing) const {
  const StreamKey key{.seed = drawing.seed,
                      .purpose = StreamPurpose::prediction,
                      .iteration = static_cast<std::uint32_t>(drawing.kind)};
  Eigen::MatrixXd uniforms(drawing.draws, parameter_count());
  for (Eigen::Index s = 0; s < uniforms.rows(); ++s) {
    RandomStream stream(key, static_cast<std::uint32_t>(s));
    for (double& uniform : uniforms.row(s)) uniform = stream.uniform();
  }
  return from_uniform(uniforms);
}

}  // namespace mottle::updating
