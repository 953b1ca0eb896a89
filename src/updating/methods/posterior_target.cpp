#include "updating/methods/posterior_target.hpp"

#include <cmath>

#include "updating/population/regional_problem.hpp"

namespace mottle::updating {

SamplingTarget PosteriorTarget::target() {
  return {.dimension = problem_.space.count() + noise_.count(),
          .log_likelihood = [this](const Eigen::MatrixXd& points) { return log_likelihood(points); },
          .is_possible = [this](const Eigen::MatrixXd& points) { return is_possible(points); },
          .before_batch =
              [this](const Eigen::MatrixXd& particles) {
                follow(particles);
                return !context_.stop_requested();
              }};
}

Eigen::MatrixXd PosteriorTarget::parameters(const Eigen::MatrixXd& points) const {
  return problem_.space.prior().from_standard_normal(points.leftCols(problem_.space.count()));
}

Eigen::MatrixXd PosteriorTarget::values(const Eigen::MatrixXd& points) const {
  Eigen::MatrixXd values(points.rows(), points.cols());
  values.leftCols(problem_.space.count()) = parameters(points);
  for (Eigen::Index k = problem_.space.count(); k < points.cols(); ++k) {
    values.col(k) = points.col(k).unaryExpr([this](double score) { return noise_.level(score); });
  }
  return values;
}

Eigen::VectorXd PosteriorTarget::log_likelihood(const Eigen::MatrixXd& points) {
  const Eigen::MatrixXd all = values(points);
  const Eigen::Index q = problem_.space.count();
  const Evaluation evaluation = region_ ? problem_.model.evaluate_in(*region_, all.leftCols(q), context_)
                                        : problem_.model.evaluate(all.leftCols(q), context_);
  evaluations_ += points.rows();
  failed_ += static_cast<std::int64_t>(evaluation.failures.size());
  Eigen::VectorXd logs(points.rows());
  for (Eigen::Index s = 0; s < points.rows(); ++s) {
    logs(s) = likelihood_.log_value(evaluation.outputs.row(s).transpose(),
                                    noise_.variances(all.row(s).tail(points.cols() - q).transpose()));
  }
  return logs;
}

/// Within bounds, physical limits and scales. Called from several threads.
std::vector<bool> PosteriorTarget::is_possible(const Eigen::MatrixXd& points) const {
  const Eigen::MatrixXd samples = parameters(points);
  std::vector<bool> possible(static_cast<std::size_t>(samples.rows()));
  for (Eigen::Index s = 0; s < samples.rows(); ++s) {
    bool is_inside = problem_.space.is_possible(samples.row(s));
    for (Eigen::Index i = 0; i < samples.cols() && is_inside; ++i) {
      const Parameter& parameter = problem_.space.parameters()[static_cast<std::size_t>(i)];
      const double value = samples(s, i);
      is_inside = value >= parameter.lower_bound && value <= parameter.upper_bound &&
                  std::isfinite(parameter.transform.from_variable(value));
    }
    possible[static_cast<std::size_t>(s)] = is_inside;
  }
  return possible;
}

/// Adapts the model to where the particles are, each time that they have halved their spread.
void PosteriorTarget::follow(const Eigen::MatrixXd& particles) {
  if (!problem_.model.adapts_to_regions()) return;
  const Eigen::MatrixXd scaled = from_variables(problem_.space.transforms(), parameters(particles));
  const Eigen::VectorXd mean = scaled.colwise().mean().transpose();
  const Eigen::MatrixXd apart = scaled.rowwise() - mean.transpose();
  const Eigen::MatrixXd covariance = apart.transpose() * apart / static_cast<double>(scaled.rows());
  const double width = 0.5 * covariance.diagonal().array().max(1e-300).log().mean();
  if (has_width_ && width > width_ - std::log(2.0)) return;
  if (has_width_) region_ = region_around(problem_, mean, covariance);
  has_width_ = true;
  width_ = width;
}

}  // namespace mottle::updating
