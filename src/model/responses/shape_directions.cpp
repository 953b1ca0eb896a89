#include "model/responses/shape_directions.hpp"

#include <cmath>
#include <limits>

#include "mottle/core/subject.hpp"

namespace mottle::model {
namespace {

/// The first among the largest: of components that are equal but for rounding always the same.
Eigen::Index first_of_largest(const Eigen::VectorXd& sizes) {
  constexpr double k_equal = 1e-3;
  Eigen::Index k = 0;
  while (sizes(k) < (1.0 - k_equal) * sizes.maxCoeff()) ++k;
  return k;
}

}  // namespace

void ShapeDirections::take_reference(const Eigen::MatrixXd& shapes) {
  const std::vector<Quantity> quantities = shapes_.quantities();
  const std::vector<int> modes = shapes_.needs().modes;
  const Eigen::Index rows = shapes.rows();
  const Subject locations{Subject::Kind::shape_locations};
  require_of(rows > 1, locations,
             "the size of the shapes is free, so that one component alone tells nothing; name at least two");
  weights_.resize(rows);
  for (Eigen::Index d = 0; d < rows; ++d) {
    weights_(d) = quantities[static_cast<std::size_t>(d)].kind == QuantityKind::displacement ? 1.0 : 0.0;
  }
  if (weights_.isZero(0.0)) weights_.setOnes();
  reference_.resize(rows, static_cast<Eigen::Index>(modes.size()));
  for (std::size_t k = 0; k < modes.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    reference_.col(column) = weights_.cwiseProduct(shapes.col(modes[k] - 1));
    require_of(!reference_.col(column).isZero(0.0), locations,
               "mode {} does not move them, so that its shape cannot be scaled", modes[k]);
    dropped_.push_back(first_of_largest(reference_.col(column).cwiseAbs()));
  }
}

std::vector<Quantity> ShapeDirections::quantities() const {
  std::vector<Quantity> quantities;
  const std::vector<Quantity> all = shapes_.quantities();
  for (std::size_t k = 0; k < dropped_.size(); ++k) {
    for (Eigen::Index d = 0; d < weights_.size(); ++d) {
      const std::size_t index = k * static_cast<std::size_t>(weights_.size()) + static_cast<std::size_t>(d);
      if (d != dropped_[k]) quantities.push_back(all[index]);
    }
  }
  return quantities;
}

Eigen::VectorXd ShapeDirections::without_dropped(const Eigen::VectorXd& shape, std::size_t k) const {
  const Eigen::Index dropped = dropped_[k];
  Eigen::VectorXd others(shape.size() - 1);
  others << shape.head(dropped), shape.tail(shape.size() - 1 - dropped);
  return others;
}

double ShapeDirections::factor(const Eigen::VectorXd& shape, Eigen::Index k) const {
  constexpr double k_min_mac = 0.1;
  constexpr double k_none = std::numeric_limits<double>::quiet_NaN();
  const auto r = reference_.col(k);
  const Eigen::VectorXd scaling = (weights_.array() > 0.0).select(shape, 0.0);  // rotations may be missing
  const double largest = scaling.cwiseAbs().maxCoeff<Eigen::PropagateNaN>();    // squares must not overflow
  if (!(largest > 0.0) || !std::isfinite(largest)) return k_none;
  const Eigen::VectorXd unit = scaling / largest;
  const double product = r.dot(unit);
  if (product * product < k_min_mac * r.squaredNorm() * unit.squaredNorm()) return k_none;
  return r.squaredNorm() / product / largest;
}

Eigen::RowVectorXd ShapeDirections::outputs_of(const Eigen::RowVectorXd& measured) const {
  const Eigen::Index n = weights_.size();
  Eigen::RowVectorXd outputs(static_cast<Eigen::Index>(dropped_.size()) * (n - 1));
  for (std::size_t k = 0; k < dropped_.size(); ++k) {
    const auto mode = static_cast<Eigen::Index>(k);
    const Eigen::VectorXd shape = measured.segment(mode * n, n).transpose();
    outputs.segment(mode * (n - 1), n - 1) = without_dropped(factor(shape, mode) * shape, k).transpose();
  }
  return outputs;
}

std::string ShapeDirections::fill(const NumberedSolution& solution, Row row) const {
  Eigen::RowVectorXd shapes(reference_.size());
  if (std::string failure = shapes_.fill(solution, shapes); !failure.empty()) return failure;
  row = outputs_of(shapes);
  if (!row.hasNaN()) return {};
  return "a shape is nearly orthogonal to that of the reference at outputs.shapes.dofs, so that it cannot be scaled";
}

/// dy = c dphi + phi dc,  dc = -c (r' W dphi) / (r' W phi).
Eigen::MatrixXd ShapeDirections::derivatives(const SolvedPoint& point) const {
  const Eigen::MatrixXd all = shapes_.derivatives(point);
  const Eigen::VectorXd shapes = shapes_.values(point);
  const Eigen::Index n = weights_.size();
  Eigen::MatrixXd derivatives(static_cast<Eigen::Index>(dropped_.size()) * (n - 1), all.cols());
  for (std::size_t k = 0; k < dropped_.size(); ++k) {
    const auto mode = static_cast<Eigen::Index>(k);
    const Eigen::VectorXd shape = shapes.segment(mode * n, n);
    const double c = factor(shape, mode);
    const double product = reference_.col(mode).dot(shape);
    for (Eigen::Index i = 0; i < all.cols(); ++i) {
      const Eigen::VectorXd change = all.col(i).segment(mode * n, n);
      const double factor_change = -c * reference_.col(mode).dot(change) / product;
      derivatives.col(i).segment(mode * (n - 1), n - 1) = without_dropped(c * change + factor_change * shape, k);
    }
  }
  return derivatives;
}

}  // namespace mottle::model
