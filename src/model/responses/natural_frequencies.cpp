#include "model/responses/natural_frequencies.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace mottle::model {

std::vector<Quantity> NaturalFrequencies::quantities() const {
  std::vector<Quantity> quantities;
  for (const int mode : modes_) quantities.push_back(natural_frequency(mode, unit_));
  return quantities;
}

std::string NaturalFrequencies::fill(const NumberedSolution& solution, Row row) const {
  Eigen::Index k = 0;
  for (const int mode : modes_) {
    row(k) = solution.frequency(mode);
    if (std::isnan(row(k++))) return fmt::format("mode {} is unstable: its eigenvalue is negative", mode);
  }
  return {};
}

Eigen::MatrixXd NaturalFrequencies::derivatives(const SolvedPoint& point) const {
  constexpr double k_two_pi = 2.0 * std::numbers::pi;
  const double largest = point.modes.eigenvalues.cwiseAbs().maxCoeff();
  Eigen::MatrixXd derivatives = Eigen::MatrixXd::Constant(
      static_cast<Eigen::Index>(modes_.size()), point.parameters.size(), std::numeric_limits<double>::quiet_NaN());
  Eigen::Index k = 0;
  for (const int mode : modes_) {
    const int column = point.column(mode);
    const double frequency = natural_frequency_hz(point.modes.eigenvalues(column), largest);
    if (frequency > 0.0) {
      derivatives.row(k) = point.eigenvalue_derivatives.row(column) / (2.0 * k_two_pi * k_two_pi * frequency);
    }
    ++k;
  }
  return derivatives;
}

}  // namespace mottle::model
