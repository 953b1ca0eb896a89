#include "updating/fits/scaled_parameters.hpp"

#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/core/parallel.hpp"

namespace mottle::updating {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
constexpr double k_not_known = std::numeric_limits<double>::quiet_NaN();
constexpr double k_max_logit = 25.0;  // x is then 1e-11 of the range from its bound: on it for every purpose

double scaled_end(const ParameterTransform& scale, double end) {
  if (scale.kind == ParameterTransform::Kind::log) return end > 0.0 ? std::log(end) : -k_infinity;
  if (scale.kind != ParameterTransform::Kind::logit) return end;
  if (end <= scale.lower) return -k_max_logit;
  if (end >= scale.upper) return k_max_logit;
  return std::clamp(scale.from_variable(end), -k_max_logit, k_max_logit);
}

/// One column of one point's Jacobian that differences must fill.
struct Column {
  Eigen::Index point;
  Eigen::Index parameter;
};

/// Runs at points(point) +- step along the parameter: two rows a column.
Eigen::MatrixXd shifted_outputs(const UpdatingProblem& problem, const ScaledParameters& parameters,
                                const Eigen::Ref<const Eigen::MatrixXd>& points, const std::vector<Column>& columns,
                                const RunContext& context, std::int64_t& evaluations) {
  Eigen::MatrixXd shifted(2 * static_cast<Eigen::Index>(columns.size()), points.cols());
  Eigen::Index row = 0;
  for (const Column& column : columns) {
    for (const double sign : {1.0, -1.0}) {
      shifted.row(row) = points.row(column.point);
      shifted(row++, column.parameter) +=
          sign * problem.model.difference_step() * parameters.standard_deviation()(column.parameter);
    }
  }
  return outputs_on_scales(problem, shifted, context, evaluations);
}

double quotient(double ahead, double centre, double behind, double step) {
  if (std::isfinite(ahead) && std::isfinite(behind)) return (ahead - behind) / (2.0 * step);
  return std::isfinite(ahead) ? (ahead - centre) / step : (centre - behind) / step;
}

}  // namespace

Eigen::MatrixXd own_derivatives(const UpdatingProblem& problem, const Eigen::VectorXd& variables) {
  try {
    return problem.derivatives->jacobian(variables);
  } catch (const InvalidInput&) {  // modes that cannot be matched there
  } catch (const ModelFailure&) {
  }
  return Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(problem.model.outputs().size()), variables.size(),
                                   k_not_known);
}

PriorOnScales prior_on_scales(const ParameterSpace& space) {
  const std::vector<ParameterTransform> scales = space.transforms();
  Eigen::VectorXd mean = from_variables(scales, space.prior().mean().transpose()).row(0);
  Eigen::VectorXd slope(mean.size());
  for (Eigen::Index i = 0; i < slope.size(); ++i) slope(i) = scales[static_cast<std::size_t>(i)].slope(mean(i));
  return {std::move(mean),
          slope.cwiseInverse().asDiagonal() * space.prior().covariance() * slope.cwiseInverse().asDiagonal()};
}

ScaledParameters::ScaledParameters(const ParameterSpace& space) : scales_(space.transforms()) {
  PriorOnScales prior = prior_on_scales(space);
  start_ = std::move(prior.mean);
  covariance_ = std::move(prior.covariance);
  standard_deviation_ = covariance_.diagonal().cwiseSqrt();
  const Eigen::VectorXd lowest = space.clamp(Eigen::VectorXd::Constant(space.count(), -k_infinity));
  const Eigen::VectorXd highest = space.clamp(Eigen::VectorXd::Constant(space.count(), k_infinity));
  lower_ = lowest;
  upper_ = highest;
  for (Eigen::Index i = 0; i < space.count(); ++i) {
    const ParameterTransform& scale = scales_[static_cast<std::size_t>(i)];
    lower_(i) = scaled_end(scale, lowest(i));
    upper_(i) = scaled_end(scale, highest(i));
  }
}

Eigen::MatrixXd ScaledParameters::to_variables(const Eigen::Ref<const Eigen::MatrixXd>& points) const {
  return stats::to_variables(scales_, points);
}

Eigen::VectorXd ScaledParameters::slopes(const Eigen::Ref<const Eigen::VectorXd>& point) const {
  Eigen::VectorXd slopes(point.size());
  for (Eigen::Index i = 0; i < point.size(); ++i) slopes(i) = scales_[static_cast<std::size_t>(i)].slope(point(i));
  return slopes;
}

Eigen::VectorXd ScaledParameters::clamp(const Eigen::Ref<const Eigen::VectorXd>& point) const {
  return point.cwiseMax(lower_).cwiseMin(upper_);
}

Eigen::VectorXi ScaledParameters::active_bounds(const Eigen::Ref<const Eigen::VectorXd>& point) const {
  Eigen::VectorXi active(point.size());
  for (Eigen::Index i = 0; i < point.size(); ++i) active(i) = (point(i) >= upper_(i)) - (point(i) <= lower_(i));
  return active;
}

Eigen::MatrixXd outputs_on_scales(const UpdatingProblem& problem, const Eigen::Ref<const Eigen::MatrixXd>& points,
                                  const RunContext& context, std::int64_t& evaluations) {
  const Eigen::MatrixXd x = to_variables(problem.space.transforms(), points);
  // What is physically impossible is not put to the model: it counts as a failed run.
  std::vector<Eigen::Index> possible;
  for (Eigen::Index s = 0; s < x.rows(); ++s) {
    if (x.row(s).allFinite() && problem.space.is_possible(x.row(s))) possible.push_back(s);
  }
  const auto p = static_cast<Eigen::Index>(problem.model.outputs().size());
  Eigen::MatrixXd result = Eigen::MatrixXd::Constant(x.rows(), p, std::nan(""));
  if (possible.empty()) return result;
  const Eigen::MatrixXd asked = x(possible, Eigen::all);
  evaluations += asked.rows();
  result(possible, Eigen::all) = problem.model.evaluate(asked, context).outputs;
  return result;
}

std::vector<Eigen::MatrixXd> scaled_jacobians(const UpdatingProblem& problem, const ScaledParameters& parameters,
                                              const Eigen::Ref<const Eigen::MatrixXd>& points,
                                              const Eigen::Ref<const Eigen::MatrixXd>& outputs,
                                              const RunContext& context, std::int64_t& evaluations) {
  const Eigen::MatrixXd variables = parameters.to_variables(points);
  std::vector<Eigen::MatrixXd> jacobians(static_cast<std::size_t>(points.rows()),
                                         Eigen::MatrixXd::Constant(outputs.cols(), points.cols(), k_not_known));
  if (problem.derivatives != nullptr && (points.rows() == 1 || problem.derivatives->has_cheap_jacobian())) {
    parallel_for(points.rows(), 1, context.threads, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t s = begin; s < end; ++s) {
        jacobians[static_cast<std::size_t>(s)] = own_derivatives(problem, variables.row(s).transpose()) *
                                                 parameters.slopes(points.row(s).transpose()).asDiagonal();
      }
    });
  }
  std::vector<Column> columns;
  for (Eigen::Index s = 0; s < points.rows(); ++s) {
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      if (!jacobians[static_cast<std::size_t>(s)].col(i).allFinite()) columns.push_back({s, i});
    }
  }
  if (columns.empty()) return jacobians;
  const Eigen::MatrixXd shifted = shifted_outputs(problem, parameters, points, columns, context, evaluations);
  Eigen::Index row = 0;
  for (const auto& [point, parameter] : columns) {
    auto column = jacobians[static_cast<std::size_t>(point)].col(parameter);
    const double step = problem.model.difference_step() * parameters.standard_deviation()(parameter);
    for (Eigen::Index k = 0; k < outputs.cols(); ++k) {
      if (!std::isfinite(column(k)))
        column(k) = quotient(shifted(row, k), outputs(point, k), shifted(row + 1, k), step);
    }
    row += 2;
  }
  return jacobians;
}

}  // namespace mottle::updating
