#include "model/responses/damping_ratios.hpp"

#include <cmath>
#include <limits>

#include "mottle/core/subject.hpp"

namespace mottle::model {

DampingRatios::DampingRatios(std::vector<int> modes, const Structure& structure) : modes_(std::move(modes)) {
  require_of(structure.is_damped(), {Subject::Kind::damping}, "the model has no damper");
}

std::vector<Quantity> DampingRatios::quantities() const {
  std::vector<Quantity> quantities;
  for (const int mode : modes_) quantities.push_back(damping_ratio(mode));
  return quantities;
}

std::string DampingRatios::fill(const NumberedSolution& solution, Row row) const {
  Eigen::Index k = 0;
  for (const int mode : modes_) {
    row(k) = solution.damping_ratio(mode);
    if (std::isnan(row(k++))) return fmt::format("mode {} does not oscillate: it is overdamped", mode);
  }
  return {};
}

Eigen::MatrixXd DampingRatios::derivatives(const SolvedPoint& point) const {
  return Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(modes_.size()), point.parameters.size(),
                                   std::numeric_limits<double>::quiet_NaN());
}

}  // namespace mottle::model
