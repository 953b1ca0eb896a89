#include "mottle/updating/methods/interval.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"
#include "mottle/updating/estimate/box_estimate.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "updating/fits/measured_outputs.hpp"
#include "updating/methods/box_image.hpp"
#include "updating/methods/covering_box.hpp"
#include "updating/methods/interval_notes.hpp"
#include "updating/methods/interval_specimens.hpp"
#include "updating/methods/interval_targets.hpp"
#include "updating/methods/interval_tests.hpp"

namespace mottle::updating {
namespace {

IterationRecord record_of(const IntervalSetup& setup, const ParameterBox& box, const Eigen::MatrixXd& image) {
  const BoxEstimate estimate(box);
  IterationRecord record;
  record.parameter_mean = estimate.mean();
  record.parameter_covariance = estimate.covariance();
  record.output_mean = image.rowwise().mean();
  record.output_covariance = ((image.col(1) - image.col(0)).cwiseAbs2() / 12.0).asDiagonal();
  set_distances(record, setup.tests);
  return record;
}

class IntervalSearch {
 public:
  IntervalSearch(const IntervalSetup& setup, const OwnParameters& own, BoxImage& image, UpdatingResult& result)
      : setup_(setup),
        own_(own),
        image_(image),
        result_(result),
        task_(cover_task(setup.problem, setup.bounds.limits, own.hull)) {
    task_.after_each = [this](const ParameterBox&) {
      ++updates_;
      begin_iteration(setup_.problem, std::min<std::int64_t>(updates_ + 1, setup_.problem.iterations), setup_.context);
      return !setup_.context.stop_requested();
    };
  }

  /// The smallest of the boxes from two starts; where none covers, that which covers what can be covered.
  CoveringBox run() {
    begin_iteration(setup_.problem, 1, setup_.context);
    CoveringBox best = best_of_starts();
    if (best.uncovered > 0.0) {
      reachable_ = keep_what_is_possible(image_, task_);
      best = best_of_starts();
    }
    return best;
  }

  const CoverTask& task() const { return task_; }
  const Eigen::MatrixXd& reachable() const { return reachable_; }

 private:
  /// Descends again where the range of the box found shows points that cover better than those that held it.
  CoveringBox settle(const ParameterBox& start) {
    constexpr int k_rounds = 3;
    constexpr double k_smaller = 1e-4;
    CoveringBox found = find_covering_box(image_, task_, start);
    for (int round = 1; round < k_rounds; ++round) {
      const CoveringBox next = find_covering_box(image_, task_, found.box);
      setup_.context.throw_if_stopped();
      const bool is_better = next.uncovered <= found.uncovered && next.measure < found.measure;
      const bool is_same = next.measure > (1.0 - k_smaller) * found.measure;
      if (is_better) found = next;
      if (is_same) break;
    }
    append(found);
    return found;
  }

  CoveringBox best_of_starts() {
    CoveringBox best = settle(own_.hull);
    const CoveringBox other = settle(own_.of_limits);
    const bool is_better =
        other.uncovered < best.uncovered || (other.uncovered == best.uncovered && other.measure < best.measure);
    return is_better ? other : best;
  }

  void append(const CoveringBox& found) {
    const std::int64_t runs = result_.model_evaluations;
    append_state(result_, record_of(setup_, found.box, found.reached));
    result_.model_evaluations = runs;
  }

  const IntervalSetup& setup_;
  const OwnParameters& own_;
  BoxImage& image_;
  UpdatingResult& result_;
  CoverTask task_;
  Eigen::MatrixXd reachable_;  ///< see IntervalResult
  std::int64_t updates_ = 0;
};

/// @param reached  values at points of the box [output x 2]; nan: none
void describe_image(const IntervalSetup& setup, const OwnParameters& own, const Eigen::MatrixXd& reached,
                    BoxImage& image, IntervalResult& found) {
  found.image = image.ranges(found.box);
  for (std::size_t k = 0; k < found.image.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    found.image[k].lower = std::fmin(found.image[k].lower, reached(row, 0));
    found.image[k].upper = std::fmax(found.image[k].upper, reached(row, 1));
  }
  found.excess.resize(found.asked.rows(), 2);
  for (Eigen::Index k = 0; k < found.excess.rows(); ++k) {
    const OutputRange& range = found.image[static_cast<std::size_t>(k)];
    found.excess.row(k) << setup.bounds.limits(k, 0) - range.lower, range.upper - setup.bounds.limits(k, 1);
  }
  found.trends = image.trends();
  found.obstacle = image.obstacle();
  constexpr double k_rounding = 1e-9;
  const Eigen::VectorXd slack = k_rounding * setup.prior_std;
  for (Eigen::Index s = 0; s < own.specimens.rows(); ++s) {
    const Eigen::VectorXd x = own.specimens.row(s).transpose();
    const bool is_inside =
        ((x - found.box.lower + slack).array() >= 0.0).all() && ((found.box.upper - x + slack).array() >= 0.0).all();
    if (!is_inside) found.outside.push_back(setup.problem.tests.number_of(s));
  }
}

SpecimenResiduals residuals_of(const IntervalSetup& setup, const OwnParameters& own) {
  SpecimenResiduals residuals;
  for (Eigen::Index s = 0; s < own.unbounded.rows(); ++s) {
    const std::vector<Eigen::Index> measured = measured_outputs(setup.problem.tests.values, s);
    residuals.degrees_of_freedom +=
        std::max(0, static_cast<int>(measured.size()) - own.ranks[static_cast<std::size_t>(s)]);
    for (const Eigen::Index k : measured) {
      const double noise = setup.problem.tests.repeatability_std(k);
      if (noise > 0.0) residuals.sum_of_squares += std::pow(own.unbounded(s, k) / noise, 2);
    }
  }
  return residuals;
}

void finish(const IntervalSetup& setup, const OwnParameters& own, const CoveringBox& covering,
            const IntervalSearch& search, BoxImage& image, UpdatingResult& result) {
  const auto found = std::make_shared<IntervalResult>();
  found->box = covering.box;
  found->tests = setup.bounds;
  found->asked = search.task().targets;
  found->allowed = search.task().allowed;
  found->reachable = search.reachable();
  found->measure = covering.measure;
  found->hull = own.hull;
  describe_image(setup, own, covering.reached, image, *found);
  found->undetermined = undetermined_ends(setup.problem, found->allowed, covering);
  result.set_estimate(std::make_shared<BoxEstimate>(covering.box));
  result.sensitivity = image.jacobian(result.mean);
  result.specimens = SpecimenEstimates{own.specimens, own.residuals};
  for (Eigen::Index k = 0; k < own.residuals.cols(); ++k) {
    const double noise = setup.problem.tests.repeatability_std(k);
    const double scale =
        noise > 0.0 ? noise : weighing_deviation(std::sqrt(setup.tests.covariance(k, k)), setup.tests.mean(k));
    result.specimens->residuals.col(k) /= scale;
  }
  result.model_evaluations += image.evaluations();
  IterationRecord last = record_state(setup.problem, setup.tests, *result.estimate, setup.context);
  result.model_evaluations += last.cloud.samples.rows();
  result.history.pop_back();
  result.history.push_back(std::move(last));
  test_box(setup.problem, *found, residuals_of(setup, own), result);
  add_interval_notes(setup.problem, *found, image.crossing(), result);
  result.interval = found;
}

UpdatingResult stopped(UpdatingResult result, const UpdatingProblem& problem) {
  result.status = UpdatingStatus::stopped;
  result.message = "stopped on request before there was a box";
  result.mean = problem.space.prior().mean();
  result.covariance = problem.space.prior().covariance();
  return result;
}

}  // namespace

const OptionTable<IntervalOptions>& interval_option_table() {
  using I = IntervalOptions;
  static const OptionTable<I> table =
      OptionTable<I>()
          .choice<I::Bounds>("bounds", &I::bounds,
                             {{"observed", I::Bounds::observed},
                              {"normal-tolerance", I::Bounds::normal_tolerance},
                              {"distribution-free", I::Bounds::distribution_free}},
                             "Bounds of each output that the box must cover: the smallest and the largest test, which "
                             "lie inside the population's; normal tolerance limits; or the extremes as "
                             "distribution-free tolerance limits, which need many specimens.")
          .number("content", &I::content, {.lower = 0.5, .upper = 0.999}, "-",
                  "Fraction of the population of each output that tolerance limits contain.")
          .number("confidence", &I::confidence, {.lower = 0.5, .upper = 0.999}, "-",
                  "Probability that tolerance limits of an output contain that fraction.")
          .number("range_tolerance", &I::range_tolerance, {.lower = 1e-6, .upper = 0.5}, "-",
                  "Relative distance of the proven from the attained end of an eigenvalue's range over a box, below "
                  "which the box is not divided further.")
          .integer("max_solutions", &I::max_solutions, {.lower = 100.0, .upper = 1e8}, "-",
                   "Most eigenvalue problems that are solved for one proof of ranges.")
          .integer("search_points", &I::search_points, {.lower = 0.0, .upper = 1e6}, "-",
                   "Points that fill a box where its image is searched for, as nothing can be proven; 0: corners "
                   "alone.");
  return table;
}

UpdatingResult IntervalUpdater::update(const UpdatingProblem& problem, const RunContext& context) const {
  const Subject method{Subject::Kind::method, "interval"};
  require_of(problem.tests.values.rows() >= 2, method,
             "{} specimen has no bounds; at least 2 are needed, or use method = \"deterministic\"",
             problem.tests.values.rows());
  const SpecimenBounds bounds = find_specimen_bounds(problem, options_);
  const IntervalSetup setup{problem, context, test_moments(problem.tests), bounds,
                            problem.space.prior().covariance().diagonal().cwiseSqrt()};
  require_of((setup.prior_std.array() > 0.0).all(), method,
             "a parameter's prior has no width, in which the width of its bounds is measured; give it one");
  UpdatingResult result;
  append_state(result, record_state(problem, setup.tests, problem.space.prior(), 0, context));
  if (context.stop_requested()) return stopped(std::move(result), problem);
  try {
    context.phase({.name = "parameters of each specimen"});
    const OwnParameters own = fit_own_parameters(setup, result.model_evaluations);
    BoxImage image(problem, options_, context);
    IntervalSearch search(setup, own, image, result);
    const CoveringBox covering = search.run();
    context.throw_if_stopped();
    describe_ending(covering, search.task(), result);
    finish(setup, own, covering, search, image, result);
  } catch (const Stopped&) {
    return stopped(std::move(result), problem);
  }
  return result;
}

}  // namespace mottle::updating
