#include "mottle/updating/estimate/box_estimate.hpp"

#include "mottle/core/error.hpp"

namespace mottle::updating {

BoxEstimate::BoxEstimate(ParameterBox box) : box_(std::move(box)) {
  require(box_.lower.size() == box_.upper.size() && box_.lower.size() > 0 && box_.lower.allFinite() &&
              box_.upper.allFinite() && (box_.lower.array() <= box_.upper.array()).all(),
          "the ends of a box must be finite, as many lower as upper ones, and no lower end above its upper one");
}

Eigen::MatrixXd BoxEstimate::covariance() const {
  return (box_.width().cwiseAbs2() / 12.0).asDiagonal();
}

Eigen::MatrixXd BoxEstimate::from_uniform(const Eigen::Ref<const Eigen::MatrixXd>& uniforms) const {
  return (uniforms * box_.width().asDiagonal()).rowwise() + box_.lower.transpose();
}

Eigen::VectorXd BoxEstimate::density(Eigen::Index parameter, const Eigen::Ref<const Eigen::VectorXd>& points) const {
  const double lower = box_.lower(parameter);
  const double upper = box_.upper(parameter);
  return points.unaryExpr([=](double x) { return x >= lower && x <= upper ? 1.0 / (upper - lower) : 0.0; });
}

Eigen::VectorXd BoxEstimate::density_points(Eigen::Index parameter, Eigen::Index count) const {
  if (!(box_.upper(parameter) > box_.lower(parameter))) return {};
  return Eigen::VectorXd::LinSpaced(count, box_.lower(parameter), box_.upper(parameter));
}

double BoxEstimate::quantile(Eigen::Index parameter, double probability) const {
  return box_.lower(parameter) + probability * (box_.upper(parameter) - box_.lower(parameter));
}

std::vector<Eigen::MatrixXd> BoxEstimate::region(Eigen::Index first, Eigen::Index second, double /*probability*/,
                                                 Eigen::Index /*points*/) const {
  const Eigen::VectorXd width = box_.width();
  if (!(width(first) > 0.0) || !(width(second) > 0.0)) return {};
  Eigen::MatrixXd outline(5, 2);
  outline.col(0) << box_.lower(first), box_.upper(first), box_.upper(first), box_.lower(first), box_.lower(first);
  outline.col(1) << box_.lower(second), box_.lower(second), box_.upper(second), box_.upper(second), box_.lower(second);
  return {outline};
}

std::string BoxEstimate::prediction_note() const {
  return "The estimate is a box of the parameters, without a distribution: predicted intervals are those of parameters "
         "that are spread evenly and independently in it, which is a convention and no finding.";
}

}  // namespace mottle::updating
