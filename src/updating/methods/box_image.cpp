#include "updating/methods/box_image.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mottle/core/error.hpp"
#include "mottle/core/random.hpp"
#include "mottle/stats/sampling/sampling.hpp"

namespace mottle::updating {
namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
constexpr Eigen::Index k_most_corners = 256;

bool is_eigenvalue(const Quantity& output) {
  return output.kind == QuantityKind::frequency || output.kind == QuantityKind::eigenvalue;
}

/// An output from its eigenvalue; rounding below zero counts as zero.
double output_of(const Quantity& output, double eigenvalue) {
  if (output.kind == QuantityKind::eigenvalue) return eigenvalue;
  return std::sqrt(std::max(eigenvalue, 0.0)) / (2.0 * std::numbers::pi);
}

Eigen::MatrixXd corners_of(const ParameterBox& box) {
  const Eigen::Index q = box.lower.size();
  const Eigen::Index count = q < 8 ? Eigen::Index{1} << q : k_most_corners;
  Eigen::MatrixXd corners(count, q);
  for (Eigen::Index c = 0; c < count; ++c) {
    for (Eigen::Index i = 0; i < q; ++i) corners(c, i) = (c >> (i % 8)) % 2 == 1 ? box.upper(i) : box.lower(i);
  }
  return corners;
}

}  // namespace

BoxImage::BoxImage(const UpdatingProblem& problem, const IntervalOptions& options, const RunContext& context)
    : problem_(problem),
      options_(options),
      context_(context),
      prior_std_(problem.space.prior().covariance().diagonal().cwiseSqrt()) {
  structure_ = dynamic_cast<const StructureModel*>(problem.derivatives);
  const std::vector<Quantity>& outputs = problem.model.outputs();
  if (structure_ == nullptr) {
    obstacle_ = "the model's matrices are not known";
  } else if (std::none_of(outputs.begin(), outputs.end(), is_eigenvalue)) {
    obstacle_ = "no output is a natural frequency or an eigenvalue";
  } else {
    bounds_.emplace(*structure_);
    obstacle_ = bounds_->obstacle();
    if (!obstacle_.empty()) {
      bounds_.reset();
      return;
    }
    is_tracked_ = structure_->selection().tracking == ModeTracking::mac;
    is_exact_ = !is_tracked_ && std::all_of(outputs.begin(), outputs.end(), is_eigenvalue);
    mode_count_ = static_cast<int>(structure_->structure().mode_count());
  }
}

int BoxImage::highest_mode() const {
  int highest = 0;
  for (const Quantity& output : problem_.model.outputs()) {
    if (is_eigenvalue(output)) highest = std::max(highest, output.number);
  }
  return highest;
}

Eigen::MatrixXd BoxImage::outputs(const Eigen::Ref<const Eigen::MatrixXd>& points) {
  evaluations_ += points.rows();
  if (!is_exact_) return problem_.model.evaluate(points, context_).outputs;
  const Eigen::MatrixXd eigenvalues = bounds_->at(points, highest_mode(), context_);
  const std::vector<Quantity>& outputs = problem_.model.outputs();
  Eigen::MatrixXd values(points.rows(), static_cast<Eigen::Index>(outputs.size()));
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    for (Eigen::Index s = 0; s < points.rows(); ++s) {
      values(s, static_cast<Eigen::Index>(k)) = output_of(outputs[k], eigenvalues(s, outputs[k].number - 1));
    }
  }
  return values;
}

Eigen::MatrixXd BoxImage::jacobian(const Eigen::VectorXd& point) {
  const auto p = static_cast<Eigen::Index>(problem_.model.outputs().size());
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Constant(p, point.size(), k_nan);
  if (problem_.derivatives != nullptr) {
    try {
      slopes = problem_.derivatives->jacobian(point);
    } catch (const InvalidInput&) {  // modes that cannot be matched there
    } catch (const ModelFailure&) {
    }
  }
  if (slopes.allFinite()) return slopes;
  const double relative = is_exact_ ? k_usual_difference_step : problem_.model.difference_step();
  Eigen::MatrixXd ends(2 * point.size() + 1, point.size());
  ends.rowwise() = point.transpose();
  for (Eigen::Index i = 0; i < point.size(); ++i) {
    ends(2 * i, i) += relative * prior_std_(i);
    ends(2 * i + 1, i) -= relative * prior_std_(i);
    ends.row(2 * i) = problem_.space.clamp(ends.row(2 * i).transpose()).transpose();
    ends.row(2 * i + 1) = problem_.space.clamp(ends.row(2 * i + 1).transpose()).transpose();
  }
  const Eigen::MatrixXd y = outputs(ends);
  for (Eigen::Index k = 0; k < p; ++k) {
    for (Eigen::Index i = 0; i < point.size(); ++i) {
      if (std::isfinite(slopes(k, i))) continue;
      const Eigen::Index ahead = std::isfinite(y(2 * i, k)) ? 2 * i : 2 * point.size();
      const Eigen::Index behind = std::isfinite(y(2 * i + 1, k)) ? 2 * i + 1 : 2 * point.size();
      const double step = ends(ahead, i) - ends(behind, i);
      slopes(k, i) = step > 0.0 ? (y(ahead, k) - y(behind, k)) / step : 0.0;
      if (!std::isfinite(slopes(k, i))) {
        throw ModelFailure("the model fails at all points around the box, so there is no derivative");
      }
    }
  }
  return slopes;
}

std::vector<OutputRange> BoxImage::ranges(const ParameterBox& box) {
  crossing_.clear();
  const double infinity = std::numeric_limits<double>::infinity();
  std::vector<OutputRange> ranges(problem_.model.outputs().size());
  for (OutputRange& range : ranges) {
    range = {.lower = infinity, .upper = -infinity, .at_lower = box.middle(), .at_upper = box.middle()};
    range.proven_lower = range.proven_upper = k_nan;
  }
  const bool is_positive = (box.lower.array() > 0.0).all();  // else powers have no order to prove anything by
  if (bounds_ && is_positive) prove(box, ranges);
  if (!is_exact_ || !is_positive) search(box, ranges);
  certify(ranges);
  return ranges;
}

/// Whether the structure numbers the mode there as its place in the order says.
bool BoxImage::keeps_its_place(int mode, const Eigen::VectorXd& point) const {
  try {
    return structure_->follow(point).rank[static_cast<std::size_t>(mode)] == mode;
  } catch (const InvalidInput&) {  // it is lost there
    return false;
  }
}

/// What was attained says whether the proven ends are near, and takes a proof back that it contradicts.
void BoxImage::certify(std::vector<OutputRange>& ranges) {
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    OutputRange& range = ranges[k];
    if (!std::isfinite(range.proven_lower) || !std::isfinite(range.proven_upper)) continue;
    const double slack = options_.range_tolerance * std::max(std::abs(range.lower), std::abs(range.upper));
    if (range.lower < range.proven_lower - slack || range.upper > range.proven_upper + slack) {
      range.proven_lower = range.proven_upper = k_nan;
      crossing_.push_back(problem_.model.outputs()[k].name());
      continue;
    }
    range.is_certified = range.lower - range.proven_lower <= slack && range.proven_upper - range.upper <= slack;
  }
}

void BoxImage::prove(const ParameterBox& box, std::vector<OutputRange>& ranges) {
  const int modes = std::min(highest_mode() + (is_tracked_ ? 1 : 0), mode_count_);
  const EigenvalueRanges found = bounds_->over(
      box, modes, {.tolerance = options_.range_tolerance, .max_solutions = options_.max_solutions}, context_);
  evaluations_ += found.solutions;
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    const Quantity& output = problem_.model.outputs()[k];
    if (!is_eigenvalue(output)) continue;
    const Eigen::Index mode = output.number - 1;
    const bool is_apart_below = mode == 0 || found.proven_upper(mode - 1) < found.proven_lower(mode);
    const bool is_apart_above = mode + 1 >= modes || found.proven_upper(mode) < found.proven_lower(mode + 1);
    const bool may_cross = !(is_apart_below && is_apart_above);
    if (is_tracked_ && (may_cross || !keeps_its_place(static_cast<int>(mode), box.middle()))) {
      crossing_.push_back(output.name());
      continue;
    }
    OutputRange& range = ranges[k];
    range.proven_lower = output_of(output, found.proven_lower(mode));
    range.proven_upper = output_of(output, found.proven_upper(mode));
    if (!is_exact_) {  // attained by the model's own outputs
      take(found.at_lower.row(mode), ranges);
      take(found.at_upper.row(mode), ranges);
      continue;
    }
    range.lower = output_of(output, found.attained_lower(mode));
    range.upper = output_of(output, found.attained_upper(mode));
    range.at_lower = found.at_lower.row(mode).transpose();
    range.at_upper = found.at_upper.row(mode).transpose();
  }
}

void BoxImage::take(const Eigen::MatrixXd& points, std::vector<OutputRange>& ranges) {
  const Eigen::MatrixXd y = outputs(points);
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    for (Eigen::Index s = 0; s < points.rows(); ++s) {
      const double value = y(s, static_cast<Eigen::Index>(k));
      if (value < ranges[k].lower) {
        ranges[k].lower = value;
        ranges[k].at_lower = points.row(s).transpose();
      }
      if (value > ranges[k].upper) {
        ranges[k].upper = value;
        ranges[k].at_upper = points.row(s).transpose();
      }
    }
  }
}

/// The two corners of each output where its slopes in the middle of the box lead.
Eigen::MatrixXd BoxImage::corners_by_slopes(const ParameterBox& box) {
  const Eigen::MatrixXd slopes = jacobian(box.middle());
  Eigen::MatrixXd corners(2 * slopes.rows(), slopes.cols());
  for (Eigen::Index k = 0; k < slopes.rows(); ++k) {
    for (Eigen::Index i = 0; i < slopes.cols(); ++i) {
      const bool is_rising = slopes(k, i) > 0.0;
      corners(2 * k, i) = is_rising ? box.lower(i) : box.upper(i);
      corners(2 * k + 1, i) = is_rising ? box.upper(i) : box.lower(i);
    }
  }
  return corners;
}

void BoxImage::search(const ParameterBox& box, std::vector<OutputRange>& ranges) {
  constexpr int k_rounds = 6;
  constexpr Eigen::Index k_all_corners = 8;  // of so many parameters all corners are taken
  const Eigen::Index q = box.lower.size();
  take(corners_of(box), ranges);
  if (q > k_all_corners) take(corners_by_slopes(box), ranges);
  if (options_.search_points > 0) {
    const Eigen::MatrixXd uniforms = uniform_design(SamplingDesign::latin_hypercube, options_.search_points, q,
                                                    {.seed = context_.seed, .purpose = StreamPurpose::surrogate_runs});
    take((uniforms * box.width().asDiagonal()).rowwise() + box.lower.transpose(), ranges);
    double step = 1.0;  // from one face to the other
    for (int round = 0; round < k_rounds; ++round, step *= 0.5) {
      context_.throw_if_stopped();
      Eigen::MatrixXd trials(4 * q * static_cast<Eigen::Index>(ranges.size()), q);
      Eigen::Index row = 0;
      for (const OutputRange& range : ranges) {
        for (const Eigen::VectorXd* from : {&range.at_lower, &range.at_upper}) {
          for (Eigen::Index i = 0; i < q; ++i) {
            for (const double sign : {-1.0, 1.0}) {
              trials.row(row) = from->transpose();
              const double moved = trials(row, i) + sign * step * (box.upper(i) - box.lower(i));
              trials(row++, i) = std::clamp(moved, box.lower(i), box.upper(i));
            }
          }
        }
      }
      take(trials, ranges);
    }
  }
  for (const OutputRange& range : ranges) {
    if (!std::isfinite(range.lower)) throw ModelFailure("the model fails everywhere in the box of the parameters");
  }
}

std::vector<std::string> BoxImage::trends() const {
  std::vector<std::string> names(static_cast<std::size_t>(problem_.space.count()), "searched");
  for (std::size_t i = 0; bounds_ && i < names.size(); ++i) {
    const EigenvalueTrend trend = bounds_->trends()[i];
    names[i] = trend == EigenvalueTrend::rising ? "rising" : trend == EigenvalueTrend::falling ? "falling" : "mixed";
  }
  return names;
}

}  // namespace mottle::updating
