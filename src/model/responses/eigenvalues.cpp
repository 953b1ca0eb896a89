#include "model/responses/eigenvalues.hpp"

#include <fmt/format.h>

#include <cmath>

namespace mottle::model {

std::vector<Quantity> Eigenvalues::quantities() const {
  std::vector<Quantity> quantities;
  for (const int mode : modes_) quantities.push_back(natural_eigenvalue(mode, unit_));
  return quantities;
}

std::string Eigenvalues::fill(const NumberedSolution& solution, Row row) const {
  Eigen::Index k = 0;
  for (const int mode : modes_) {
    row(k) = solution.eigenvalue(mode);
    if (std::isnan(row(k++))) return fmt::format("mode {} is unstable: its eigenvalue is negative", mode);
  }
  return {};
}

Eigen::MatrixXd Eigenvalues::derivatives(const SolvedPoint& point) const {
  Eigen::MatrixXd derivatives(static_cast<Eigen::Index>(modes_.size()), point.parameters.size());
  Eigen::Index k = 0;
  for (const int mode : modes_) derivatives.row(k++) = point.eigenvalue_derivatives.row(point.column(mode));
  return derivatives;
}

}  // namespace mottle::model
