#include "updating/methods/specimen_bounds.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include "mottle/core/subject.hpp"
#include "mottle/stats/moments/descriptive.hpp"
#include "mottle/stats/tests/tolerance_limits.hpp"

namespace mottle::updating {
namespace {

const Subject k_tests{Subject::Kind::tests};
const Subject k_bounds{Subject::Kind::option, "interval.bounds"};

Eigen::VectorXd measured_values(const Eigen::MatrixXd& values, Eigen::Index output) {
  std::vector<double> list;
  for (const double value : values.col(output)) {
    if (!std::isnan(value)) list.push_back(value);
  }
  return Eigen::Map<const Eigen::VectorXd>(list.data(), static_cast<Eigen::Index>(list.size()));
}

/// mean -+ k s, and no narrower than the observed bounds.
void widen_by_normal_limits(const Quantity& output, const Eigen::VectorXd& values, const IntervalOptions& options,
                            Eigen::Index k, SpecimenBounds& bounds) {
  bounds.factor(k) = normal_tolerance_factor(bounds.count(k), options.content, options.confidence);
  const double mean = values.mean();
  const double reach = bounds.factor(k) * std::sqrt(sample_covariance(values)(0, 0));
  const double lower = mean - reach;
  require_of(lower > 0.0 || !traits_of(output.kind).is_positive, k_bounds,
             "the lower tolerance limit of {} is {:.4g}, which is impossible: {} specimens leave a factor of {:.4g} "
             "standard deviations; test more specimens, lower content or confidence, or set \"observed\"",
             output.name(), lower, bounds.count(k), bounds.factor(k));
  bounds.limits(k, 0) = std::min(bounds.limits(k, 0), lower);
  bounds.limits(k, 1) = std::max(bounds.limits(k, 1), mean + reach);
  bounds.content(k) = options.content;
  bounds.confidence(k) = options.confidence;
}

void require_enough_for_extremes(const Quantity& output, const IntervalOptions& options, Eigen::Index k,
                                 SpecimenBounds& bounds) {
  const int needed = specimens_for_extremes(options.content, options.confidence);
  const double reached = content_of_extremes(bounds.count(k), options.confidence);
  require_of(bounds.count(k) >= needed, k_bounds,
             "\"distribution-free\" limits of {} need {} specimens for content {:g} with confidence {:g}, there are "
             "{}, whose extremes contain {:.3g} with that confidence; set \"normal-tolerance\", or lower content or "
             "confidence",
             output.name(), needed, options.content, options.confidence, bounds.count(k), reached);
  bounds.content(k) = reached;
  bounds.confidence(k) = options.confidence;
}

}  // namespace

SpecimenBounds find_specimen_bounds(const UpdatingProblem& problem, const IntervalOptions& options) {
  const Eigen::MatrixXd& tests = problem.tests.values;
  const Eigen::Index p = tests.cols();
  const Eigen::VectorXd unknown = Eigen::VectorXd::Constant(p, std::numeric_limits<double>::quiet_NaN());
  SpecimenBounds bounds{.observed = Eigen::MatrixXd(p, 2),
                        .limits = {},
                        .count = Eigen::VectorXi(p),
                        .factor = unknown,
                        .content = unknown,
                        .confidence = unknown,
                        .expected_inside = Eigen::VectorXd(p)};
  for (Eigen::Index k = 0; k < p; ++k) {
    const Quantity& output = problem.model.outputs()[static_cast<std::size_t>(k)];
    const Eigen::VectorXd values = measured_values(tests, k);
    require_of(values.size() >= 2, k_tests,
               "{} was measured on {} specimens, and bounds need at least 2; leave it out, or use method = "
               "\"deterministic\" for one structure",
               output.name(), values.size());
    const auto n = static_cast<double>(values.size());
    bounds.count(k) = static_cast<int>(values.size());
    bounds.observed.row(k) << values.minCoeff(), values.maxCoeff();
    bounds.expected_inside(k) = (n - 1.0) / (n + 1.0);
  }
  bounds.limits = bounds.observed;
  for (Eigen::Index k = 0; k < p; ++k) {
    const Quantity& output = problem.model.outputs()[static_cast<std::size_t>(k)];
    if (options.bounds == IntervalOptions::Bounds::normal_tolerance) {
      widen_by_normal_limits(output, measured_values(tests, k), options, k, bounds);
    } else if (options.bounds == IntervalOptions::Bounds::distribution_free) {
      require_enough_for_extremes(output, options, k, bounds);
    }
  }
  return bounds;
}

}  // namespace mottle::updating
