#include "updating/methods/posterior_target.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/parallel.hpp"
#include "mottle/core/subject.hpp"
#include "updating/fits/regional_problem.hpp"
#include "updating/fits/scaled_parameters.hpp"

namespace mottle::updating {

std::vector<bool> are_possible(const ParameterSpace& space, const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  std::vector<bool> possible(static_cast<std::size_t>(samples.rows()));
  for (Eigen::Index s = 0; s < samples.rows(); ++s) {
    bool is_inside = space.is_possible(samples.row(s));
    for (Eigen::Index i = 0; i < samples.cols() && is_inside; ++i) {
      const Parameter& parameter = space.parameters()[static_cast<std::size_t>(i)];
      const double value = samples(s, i);
      is_inside = value >= parameter.lower_bound && value <= parameter.upper_bound &&
                  std::isfinite(parameter.transform.from_variable(value));
    }
    possible[static_cast<std::size_t>(s)] = is_inside;
  }
  return possible;
}

PosteriorTarget::PosteriorTarget(const UpdatingProblem& problem, const NoiseLevels& noise,
                                 const CommonLikelihood& likelihood, const RunContext& context)
    : problem_(problem), noise_(noise), likelihood_(likelihood), context_(context) {
  if (problem.derivatives == nullptr || !problem.derivatives->has_cheap_jacobian()) return;
  has_gradient_ = own_derivatives(problem, problem.space.prior().mean()).allFinite();
}

SamplingTarget PosteriorTarget::target() {
  SamplingTarget target{
      .dimension = problem_.space.count() + noise_.count(),
      .log_likelihood = [this](const Eigen::MatrixXd& points) { return run(points).log_likelihood; },
      .is_possible = [this](const Eigen::MatrixXd& points) { return is_possible(points); },
      .before_batch =
          [this](const Eigen::MatrixXd& particles) {
            follow(particles);
            return !context_.stop_requested();
          },
      .largest_log_likelihood = [this](const Eigen::MatrixXd& points) { return largest_log_likelihood(points); }};
  if (has_gradient_) target.with_gradient = [this](const Eigen::MatrixXd& points) { return with_gradient(points); };
  return target;
}

Eigen::MatrixXd PosteriorTarget::parameters(const Eigen::MatrixXd& points) const {
  return problem_.space.prior().from_standard_normal(points.leftCols(problem_.space.count()));
}

Eigen::MatrixXd PosteriorTarget::values(const Eigen::MatrixXd& points) const {
  Eigen::MatrixXd values(points.rows(), points.cols());
  values.leftCols(problem_.space.count()) = parameters(points);
  values.rightCols(noise_.count()) = levels(points);
  return values;
}

Eigen::MatrixXd PosteriorTarget::levels(const Eigen::MatrixXd& points) const {
  return points.rightCols(noise_.count()).unaryExpr([this](double score) { return noise_.level(score); });
}

/// Where the model meets the tests' means.
Eigen::VectorXd PosteriorTarget::largest_log_likelihood(const Eigen::MatrixXd& points) const {
  const Eigen::MatrixXd levels_of = levels(points);
  Eigen::VectorXd logs(points.rows());
  for (Eigen::Index s = 0; s < points.rows(); ++s) {
    logs(s) = likelihood_.log_value(likelihood_.mean(), noise_.variances(levels_of.row(s).transpose()));
  }
  return logs;
}

PosteriorTarget::Runs PosteriorTarget::run(const Eigen::MatrixXd& points) {
  Eigen::MatrixXd all = values(points);
  const Eigen::Index q = problem_.space.count();
  Evaluation evaluation = region_ ? problem_.model.evaluate_in(*region_, all.leftCols(q), context_)
                                  : problem_.model.evaluate(all.leftCols(q), context_);
  evaluations_ += points.rows();
  failed_ += static_cast<std::int64_t>(evaluation.failures.size());
  Eigen::VectorXd logs(points.rows());
  for (Eigen::Index s = 0; s < points.rows(); ++s) {
    logs(s) = likelihood_.log_value(evaluation.outputs.row(s).transpose(),
                                    noise_.variances(all.row(s).tail(points.cols() - q).transpose()));
  }
  return {std::move(all), std::move(evaluation.outputs), std::move(logs)};
}

LikelihoodGradient PosteriorTarget::with_gradient(const Eigen::MatrixXd& points) {
  const Runs runs = run(points);
  gradients_ += points.rows();
  Eigen::MatrixXd gradient(points.rows(), points.cols());
  parallel_for(points.rows(), 1, context_.threads, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t s = begin; s < end; ++s) {
      gradient.row(s) = gradient_at(points.row(s), runs.values.row(s), runs.outputs.row(s)).transpose();
    }
  });
  return {runs.log_likelihood, std::move(gradient)};
}

/// grad_u ln L = (dx/du)' (df/dx)' d ln L / df for parameters, by the levels for their scores.
Eigen::VectorXd PosteriorTarget::gradient_at(const Eigen::VectorXd& point, const Eigen::VectorXd& values,
                                             const Eigen::VectorXd& outputs) const {
  if (!outputs.allFinite()) return Eigen::VectorXd::Constant(point.size(), std::numeric_limits<double>::quiet_NaN());
  const Eigen::Index q = problem_.space.count();
  const CommonLikelihood::Slopes slopes = likelihood_.slopes(outputs, noise_.variances(values.tail(noise_.count())));
  Eigen::VectorXd gradient(point.size());
  gradient.head(q) = problem_.space.prior().standard_normal_derivatives(point.head(q)).transpose() *
                     (own_derivatives(problem_, values.head(q)).transpose() * slopes.by_outputs);
  gradient.tail(noise_.count()) = noise_.by_scores(slopes.by_variances, point.tail(noise_.count()));
  return gradient;
}

/// Called from several threads.
std::vector<bool> PosteriorTarget::is_possible(const Eigen::MatrixXd& points) const {
  return are_possible(problem_.space, parameters(points));
}

/// Adapts the model to where the particles are, each time that they have halved their spread.
void PosteriorTarget::follow(const Eigen::MatrixXd& particles) {
  noise_.require_above_zero(particles.rightCols(noise_.count()));
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
