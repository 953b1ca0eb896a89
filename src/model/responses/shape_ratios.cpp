#include "model/responses/shape_ratios.hpp"

#include <cmath>

#include "mottle/core/subject.hpp"

namespace mottle::model {
namespace {

const Subject k_ratios{Subject::Kind::outputs, "shape_ratios"};

}  // namespace

ShapeRatios::ShapeRatios(std::vector<ShapeRatio> ratios, std::string length, const Structure& structure)
    : ratios_(std::move(ratios)), length_(std::move(length)) {
  for (std::size_t k = 0; k < ratios_.size(); ++k) {
    const ShapeRatio& ratio = ratios_[k];
    require_of(ratio.mode >= 1 && ratio.mode <= structure.mode_count(), k_ratios,
               "mode {} is not there, the model has modes 1 to {}", ratio.mode, structure.mode_count());
    for (std::size_t j = 0; j < k; ++j) {
      const ShapeRatio& other = ratios_[j];
      const bool is_same =
          other.mode == ratio.mode && other.numerator == ratio.numerator && other.denominator == ratio.denominator;
      require_of(!is_same, k_ratios, "the ratio of '{}' to '{}' in mode {} is given twice", ratio.numerator,
                 ratio.denominator, ratio.mode);
    }
    for (const int number : find_degrees_of_freedom(structure, {ratio.numerator, ratio.denominator}, k_ratios)) {
      degrees_of_freedom_.push_back(number);
    }
  }
}

ResponseNeeds ShapeRatios::needs() const {
  std::vector<int> modes;
  for (const ShapeRatio& ratio : ratios_) modes.push_back(ratio.mode);
  return {.modes = modes, .degrees_of_freedom = degrees_of_freedom_};
}

void ShapeRatios::take_reference(const Eigen::MatrixXd& shapes) {
  constexpr double k_still = 1e-6;  // of the largest component: a node of the mode
  for (std::size_t k = 0; k < ratios_.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(2 * k);
    const Eigen::VectorXd shape = shapes.col(ratios_[k].mode - 1);
    require_of(std::abs(shape(row + 1)) > k_still * shape.cwiseAbs().maxCoeff(), k_ratios,
               "mode {} does not move '{}', so nothing can be divided by its motion; exchange the two degrees of "
               "freedom, or name another",
               ratios_[k].mode, ratios_[k].denominator);
  }
}

std::vector<Quantity> ShapeRatios::quantities() const {
  std::vector<Quantity> quantities;
  for (const ShapeRatio& ratio : ratios_) {
    quantities.push_back(shape_ratio(ratio.mode, ratio.numerator, ratio.denominator, length_));
  }
  return quantities;
}

std::string ShapeRatios::fill(const NumberedSolution& solution, Row row) const {
  for (Eigen::Index k = 0; k < row.size(); ++k) {
    const ShapeRatio& ratio = ratios_[static_cast<std::size_t>(k)];
    row(k) = solution.displacement(ratio.mode, 2 * k) / solution.displacement(ratio.mode, 2 * k + 1);
    if (!std::isfinite(row(k))) {
      return fmt::format("mode {} does not move {}, by which a component is divided", ratio.mode, ratio.denominator);
    }
  }
  return {};
}

Eigen::MatrixXd ShapeRatios::derivatives(const SolvedPoint& point) const {
  const Structure& structure = point.solver.structure();
  Eigen::MatrixXd derivatives(static_cast<Eigen::Index>(ratios_.size()), point.parameters.size());
  Eigen::MatrixXd changes;  // of the shape of `solved`
  int solved = -1;
  for (std::size_t k = 0; k < ratios_.size(); ++k) {
    const int column = point.column(ratios_[k].mode);
    if (column != solved) changes = point.solver.shape_derivatives(point.parameters, point.modes, column);
    solved = column;
    const std::vector<int> pair(degrees_of_freedom_.begin() + static_cast<std::ptrdiff_t>(2 * k),
                                degrees_of_freedom_.begin() + static_cast<std::ptrdiff_t>(2 * k + 2));
    const Eigen::MatrixXd values = structure.displacements(point.modes.shapes.col(column), pair);
    const Eigen::MatrixXd moved = structure.displacements(changes, pair);
    const double ratio = values(0) / values(1);
    derivatives.row(static_cast<Eigen::Index>(k)) = (moved.row(0) - ratio * moved.row(1)) / values(1);
  }
  return derivatives;
}

}  // namespace mottle::model
