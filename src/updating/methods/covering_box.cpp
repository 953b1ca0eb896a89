#include "updating/methods/covering_box.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "updating/methods/least_distance.hpp"
#include "updating/methods/point_cache.hpp"

namespace mottle::updating {
namespace {

constexpr double k_margin = 1e-7;        // beyond the targets, in scales: what is covered is so in floating point
constexpr double k_nothing = 0.5e-7;     // left of the moved targets: less than the margin
constexpr int k_lower = 0, k_upper = 1;  // columns of targets

/// The point of the box that holds one target.
struct TargetPoint {
  Eigen::Index output = 0;
  int side = k_lower;
  Eigen::VectorXd at;
  Eigen::VectorXi face;  ///< -1: the coordinate is the box's lower end, 1: its upper one, 0: fixed [parameter]
  double value = 0.0;
  Eigen::VectorXd slope;  ///< of the output [parameter]

  /// Whether a value is nearer to the target, or farther beyond it.
  bool prefers(double other) const { return side == k_lower ? other < value : other > value; }
  /// On which side of the box the output goes the target's way.
  int good_face(Eigen::Index i) const {
    const double downhill = side == k_lower ? slope(i) : -slope(i);
    return downhill > 0.0 ? -1 : downhill < 0.0 ? 1 : face(i);
  }
};

/// A box with the points that hold its targets.
struct CoverState {
  ParameterBox box;
  std::vector<TargetPoint> points;
  double measure = 0.0;
  double uncovered = 0.0;
};

/// Linear constraints A d >= b on the movements of all lower and then all upper ends, in units.
struct CoverConstraints {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
  Eigen::Index targets = 0;  ///< the first rows
};

class CoverSearch {
 public:
  CoverSearch(BoxImage& image, const CoverTask& task) : image_(image), cache_(image), task_(task) {}

  CoveringBox run(ParameterBox box) {
    CoverState state = first_state(std::move(box));
    CoveringBox result;
    double tau = 1.0;
    double penalty = 1.0;
    bool is_defined = true;
    constexpr double k_least_tau = 1e-9, k_most_tau = 1e3;
    for (int iteration = 1; iteration <= task_.max_iterations && tau > k_least_tau;) {
      const CoverConstraints constraints = constraints_of(state);
      const Eigen::VectorXd step = proximal_step(constraints, tau, penalty);
      if (step.cwiseAbs().maxCoeff() <= task_.tolerance && state.uncovered <= k_nothing) {
        result.has_converged = true;
        break;
      }
      CoverState next = state;
      is_defined = move(next, moved(state.box, step));
      const double before = state.measure + penalty * state.uncovered;
      const double expected = -cost().dot(step) + penalty * state.uncovered;
      if (!is_defined || before - next.measure - penalty * next.uncovered < 1e-4 * std::max(expected, 0.0)) {
        tau = std::min(0.25 * tau, step.cwiseAbs().maxCoeff());
        continue;
      }
      state = std::move(next);
      tau = std::min(2.0 * tau, k_most_tau);
      ++iteration;
      if (task_.after_each && !task_.after_each(state.box)) break;
    }
    if (tau <= k_least_tau && is_defined && state.uncovered <= k_nothing) result.has_converged = true;
    describe(state, result);
    return result;
  }

 private:
  Eigen::Index parameters() const { return task_.unit.size(); }
  Eigen::VectorXd cost() const {
    Eigen::VectorXd cost = Eigen::VectorXd::Ones(2 * parameters());
    cost.head(parameters()).setConstant(-1.0);
    return cost;
  }
  double target(const TargetPoint& point) const {
    const double outwards = point.side == k_lower ? -1.0 : 1.0;
    return task_.targets(point.output, point.side) + outwards * k_margin * task_.scale(point.output);
  }
  /// What is left of the point's target, in scales.
  double left_of(const TargetPoint& point) const {
    const double missing = point.side == k_lower ? point.value - target(point) : target(point) - point.value;
    return std::max(missing / task_.scale(point.output), 0.0);
  }

  /// The points of the box's own range; a box in whose corners the model fails is widened a little.
  CoverState first_state(ParameterBox box) {
    constexpr int k_attempts = 8;
    constexpr double k_widening = 0.01;  // units
    for (int attempt = 0; attempt < k_attempts; ++attempt) {
      CoverState state;
      const std::vector<OutputRange> ranges = image_.ranges(box);
      for (std::size_t k = 0; k < ranges.size(); ++k) {
        for (const int side : {k_lower, k_upper}) {
          TargetPoint point;
          point.output = static_cast<Eigen::Index>(k);
          point.side = side;
          point.at = side == k_lower ? ranges[k].at_lower : ranges[k].at_upper;
          point.face = faces_of(point.at, box);
          state.points.push_back(std::move(point));
        }
      }
      if (move(state, box)) return state;
      box.lower = (box.lower - k_widening * task_.unit).cwiseMax(task_.allowed.lower);
      box.upper = (box.upper + k_widening * task_.unit).cwiseMin(task_.allowed.upper);
    }
    throw ModelFailure("the model fails in the corners of every box that was tried around the specimens' parameters");
  }

  static Eigen::VectorXi faces_of(const Eigen::VectorXd& at, const ParameterBox& box) {
    Eigen::VectorXi faces = Eigen::VectorXi::Zero(at.size());
    for (Eigen::Index i = 0; i < at.size(); ++i) faces(i) = at(i) == box.lower(i) ? -1 : at(i) == box.upper(i) ? 1 : 0;
    return faces;
  }

  ParameterBox moved(const ParameterBox& box, const Eigen::VectorXd& step) const {
    ParameterBox next{box.lower + step.head(parameters()).cwiseProduct(task_.unit),
                      box.upper + step.tail(parameters()).cwiseProduct(task_.unit)};
    next.lower = next.lower.cwiseMax(task_.allowed.lower).cwiseMin(task_.allowed.upper);
    next.upper = next.upper.cwiseMax(task_.allowed.lower).cwiseMin(task_.allowed.upper);
    for (Eigen::Index i = 0; i < parameters(); ++i) {
      if (next.lower(i) > next.upper(i)) next.lower(i) = next.upper(i) = 0.5 * (next.lower(i) + next.upper(i));
    }
    return next;
  }

  static Eigen::VectorXd place(const TargetPoint& point, const ParameterBox& box) {
    Eigen::VectorXd at = point.at.cwiseMax(box.lower).cwiseMin(box.upper);
    for (Eigen::Index i = 0; i < at.size(); ++i) {
      if (point.face(i) != 0) at(i) = point.face(i) < 0 ? box.lower(i) : box.upper(i);
    }
    return at;
  }

  /// Puts the points onto another box and lets each look for a better face; false where the model fails.
  bool move(CoverState& state, const ParameterBox& box) {
    state.box = box;
    std::vector<Eigen::VectorXd> places;
    for (TargetPoint& point : state.points) {
      point.at = place(point, box);
      places.push_back(point.at);
    }
    if (!cache_.evaluate(places)) return false;
    read(state);
    constexpr int k_turns = 3;
    for (int turn = 0; turn < k_turns && turn_faces(state); ++turn) read(state);
    state.measure = box.width().cwiseQuotient(task_.unit).sum();
    state.uncovered = 0.0;
    for (const TargetPoint& point : state.points) state.uncovered += left_of(point);
    return true;
  }

  void read(CoverState& state) {
    for (TargetPoint& point : state.points) {
      point.value = cache_.value(point.at, point.output);
      point.slope = cache_.slope(point.at, point.output);
    }
  }

  /// Points go to the faces that their slopes ask for, where that is better; returns whether one went.
  bool turn_faces(CoverState& state) {
    std::vector<TargetPoint> turned = state.points;
    std::vector<Eigen::VectorXd> places;
    for (TargetPoint& point : turned) {
      for (Eigen::Index i = 0; i < parameters(); ++i) point.face(i) = point.good_face(i);
      point.at = place(point, state.box);
      places.push_back(point.at);
    }
    cache_.evaluate(places);
    bool has_turned = false;
    for (std::size_t k = 0; k < turned.size(); ++k) {
      if (turned[k].at == state.points[k].at) {
        state.points[k].face = turned[k].face;  // of a box without width there
      } else if (state.points[k].prefers(cache_.value(turned[k].at, turned[k].output))) {
        state.points[k] = turned[k];
        has_turned = true;
      }
    }
    return has_turned;
  }

  /// Coordinates on the wrong face, where turning is no better, stay where they are.
  bool is_fixed(const TargetPoint& point, Eigen::Index i) const {
    return point.face(i) == 0 || point.good_face(i) != point.face(i);
  }

  CoverConstraints constraints_of(const CoverState& state) const {
    CoverConstraints constraints{Eigen::MatrixXd(0, 2 * parameters()), Eigen::VectorXd(), 0};
    for (const TargetPoint& point : state.points) {
      if (std::isfinite(target(point))) add_target(point, state.box, constraints);  // else left out
    }
    constraints.targets = constraints.right.size();
    for (Eigen::Index i = 0; i < parameters(); ++i) add_ends(state, i, constraints);
    return constraints;
  }

  static void add(const Eigen::VectorXd& row, double bound, CoverConstraints& constraints) {
    const Eigen::Index rows = constraints.right.size();
    constraints.matrix.conservativeResize(rows + 1, row.size());
    constraints.right.conservativeResize(rows + 1);
    constraints.matrix.row(rows) = row.transpose();
    constraints.right(rows) = bound;
  }

  /// The movement to the allowed box.
  Eigen::VectorXd largest_movement(const ParameterBox& box) const {
    Eigen::VectorXd largest(2 * parameters());
    largest << (task_.allowed.lower - box.lower).cwiseQuotient(task_.unit),
        (task_.allowed.upper - box.upper).cwiseQuotient(task_.unit);
    return largest;
  }

  /// The linearised point reaches its target, or goes as far as the allowed box lets it.
  void add_target(const TargetPoint& point, const ParameterBox& box, CoverConstraints& constraints) const {
    const double sign = point.side == k_lower ? -1.0 : 1.0;
    const double scale = task_.scale(point.output);
    Eigen::VectorXd row = Eigen::VectorXd::Zero(2 * parameters());
    for (Eigen::Index i = 0; i < parameters(); ++i) {
      if (is_fixed(point, i)) continue;
      row(point.face(i) < 0 ? i : parameters() + i) = sign * point.slope(i) * task_.unit(i) / scale;
    }
    const double reachable = (1.0 - 1e-9) * row.dot(largest_movement(box));
    add(row, std::min(sign * (target(point) - point.value) / scale, reachable), constraints);
  }

  /// The ends of one parameter stay in order, in the allowed box, and around coordinates that are fixed.
  void add_ends(const CoverState& state, Eigen::Index i, CoverConstraints& constraints) const {
    const Eigen::VectorXd largest = largest_movement(state.box);
    const Eigen::VectorXd lower = Eigen::VectorXd::Unit(2 * parameters(), i);
    const Eigen::VectorXd upper = Eigen::VectorXd::Unit(2 * parameters(), parameters() + i);
    add(upper - lower, (state.box.lower(i) - state.box.upper(i)) / task_.unit(i), constraints);
    add(lower, largest(i), constraints);
    add(-upper, -largest(parameters() + i), constraints);
    for (const TargetPoint& point : state.points) {
      if (!is_fixed(point, i)) continue;
      add(-lower, (state.box.lower(i) - point.at(i)) / task_.unit(i), constraints);
      add(upper, (point.at(i) - state.box.upper(i)) / task_.unit(i), constraints);
    }
  }

  /// d of min c'd + |d|^2 / (2 tau) such that A d >= b; the penalty grows beyond the multipliers of the targets.
  Eigen::VectorXd proximal_step(const CoverConstraints& constraints, double tau, double& penalty) {
    const Eigen::VectorXd shift = tau * cost();
    const LeastDistance nearest = least_distance(constraints.matrix, constraints.right + constraints.matrix * shift);
    multipliers_.setZero(constraints.matrix.rows());
    if (!nearest.is_feasible) return Eigen::VectorXd::Zero(shift.size());
    multipliers_ = nearest.pressure / tau;
    if (constraints.targets > 0) {
      penalty = std::max(penalty, 2.0 * multipliers_.head(constraints.targets).maxCoeff());
    }
    return nearest.point - shift;
  }

  void describe(const CoverState& state, CoveringBox& result) {
    const Eigen::Index q = parameters();
    result.box = state.box;
    result.measure = state.measure;
    result.uncovered = state.uncovered <= k_nothing * static_cast<double>(state.points.size()) ? 0.0 : state.uncovered;
    result.reached.setConstant(task_.targets.rows(), 2, std::numeric_limits<double>::quiet_NaN());
    for (const TargetPoint& point : state.points) result.reached(point.output, point.side) = point.value;
    result.is_undetermined.setConstant(q, 2, false);
    const CoverConstraints constraints = constraints_of(state);
    double penalty = 0.0;
    proximal_step(constraints, 1.0, penalty);
    std::vector<Eigen::Index> holding;
    constexpr double k_holds = 1e-6;
    for (Eigen::Index r = 0; r < multipliers_.size(); ++r) {
      if (multipliers_(r) > k_holds) holding.push_back(r);
    }
    if (holding.empty()) return;
    const Eigen::MatrixXd rows = constraints.matrix(holding, Eigen::all);
    const Eigen::MatrixXd seen = LeastNormSolver(rows, k_holds).pseudo_inverse() * rows;
    constexpr double k_free = 0.05;
    for (Eigen::Index j = 0; j < 2 * q; ++j) result.is_undetermined(j % q, j / q) = 1.0 - seen(j, j) > k_free;
  }

  BoxImage& image_;
  PointCache cache_;
  const CoverTask& task_;
  Eigen::VectorXd multipliers_;
};

}  // namespace

CoveringBox find_covering_box(BoxImage& image, const CoverTask& task, const ParameterBox& start) {
  ParameterBox box{start.lower.cwiseMax(task.allowed.lower).cwiseMin(task.allowed.upper),
                   start.upper.cwiseMax(task.allowed.lower).cwiseMin(task.allowed.upper)};
  return CoverSearch(image, task).run(std::move(box));
}

}  // namespace mottle::updating
