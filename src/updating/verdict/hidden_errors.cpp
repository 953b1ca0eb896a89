#include "mottle/updating/verdict/hidden_errors.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "updating/fits/measured_outputs.hpp"
#include "updating/population/mean_intervals.hpp"
#include "updating/verdict/test_plan.hpp"

namespace mottle::updating {
namespace {

/// Inverse of a positive semi-definite matrix on the directions that it sees, after scaling to a unit diagonal.
struct SeenInverse {
  Eigen::MatrixXd inverse;
  Eigen::Index rank = 0;
};

SeenInverse invert_seen(const Eigen::MatrixXd& matrix) {
  constexpr double k_unseen = 1e-10;
  const Eigen::VectorXd scale =
      matrix.diagonal().unaryExpr([](double value) { return value > 0.0 ? 1.0 / std::sqrt(value) : 1.0; });
  const SymmetricEigen solver(scale.asDiagonal() * matrix * scale.asDiagonal());
  const Eigen::VectorXd inverses =
      solver.eigenvalues().unaryExpr([](double value) { return value > k_unseen ? 1.0 / value : 0.0; });
  const Eigen::MatrixXd turned = scale.asDiagonal() * solver.eigenvectors();
  return {turned * inverses.asDiagonal() * turned.transpose(), (inverses.array() > 0.0).count()};
}

/// Specimens with the same outputs measured.
std::map<std::vector<Eigen::Index>, double> measured_patterns(const Eigen::MatrixXd& values) {
  std::map<std::vector<Eigen::Index>, double> patterns;
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    patterns[measured_outputs(values, s)] += 1.0;
  }
  return patterns;
}

/// Information of all tests on the columns of `design` [output x column].
Eigen::MatrixXd information_of(const LinearTests& tests, const Eigen::MatrixXd& design) {
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(design.cols(), design.cols());
  for (const auto& [rows, count] : measured_patterns(tests.values)) {
    const CholeskyFactor factor(tests.covariance(rows, rows));
    require(factor.is_positive_definite(), "the covariance of the tests is not positive definite");
    const Eigen::MatrixXd whitened = factor.solve_lower(design(rows, Eigen::all));
    information += count * whitened.transpose() * whitened;
  }
  return information;
}

/// The information less what the last `shared` columns, unknowns of unit variance, explain of it.
Eigen::MatrixXd without_shared(const Eigen::MatrixXd& information, Eigen::Index shared) {
  const Eigen::Index left = information.cols() - shared;
  if (shared == 0) return information;
  Eigen::MatrixXd own = information.bottomRightCorner(shared, shared);
  own.diagonal().array() += 1.0;
  const Eigen::MatrixXd across = information.topRightCorner(left, shared);
  return information.topLeftCorner(left, left) - across * solve_semidefinite(own, across.transpose());
}

/// What remains of the errors' own information, [parameters, errors], where parameters imitate what they can.
void remain_of(const Eigen::MatrixXd& information, const SeenInverse& seen, ErrorEffects& effects) {
  const Eigen::Index q = seen.inverse.cols();
  const Eigen::Index m = information.cols() - q;
  const Eigen::MatrixXd across = information.topRightCorner(q, m);
  const Eigen::VectorXd whole = information.bottomRightCorner(m, m).diagonal();
  const Eigen::VectorXd imitated = (across.array() * (seen.inverse * across).array()).colwise().sum().transpose();
  constexpr double k_rounding = 1e-9;  // of the whole: what is left by cancellation alone
  effects.noncentrality = ((whole - imitated).array() > k_rounding * whole.array()).select(whole - imitated, 0.0);
}

/// The test of residuals within specimens: each specimen's own parameters imitate what they can of an error.
void test_within_specimens(const LinearTests& tests, ErrorEffects& effects) {
  constexpr double k_unseen = 1e-9;
  const Eigen::Index p = tests.values.cols();
  const Eigen::Index m = tests.errors.cols();
  const Eigen::Index shared = tests.model_error_std.size();
  Eigen::MatrixXd moved(p, m + shared);
  moved.leftCols(m) = tests.errors;
  if (shared > 0) moved.rightCols(shared) = tests.model_error_std.asDiagonal();
  Eigen::MatrixXd projection = Eigen::MatrixXd::Zero(p, p);
  Eigen::VectorXd measured = Eigen::VectorXd::Zero(p);
  Eigen::Index left = 0;
  for (const auto& [rows, count] : measured_patterns(tests.values)) {
    const auto size = static_cast<Eigen::Index>(rows.size());
    const Eigen::VectorXd weight = tests.noise(rows).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd design = weight.asDiagonal() * tests.sensitivity(rows, Eigen::all);
    const Eigen::VectorXd scale = design.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
    const Eigen::MatrixXd reached = PivotedQr(design * scale.asDiagonal(), 1e-8).range();
    projection(rows, rows) += count * (Eigen::MatrixXd::Identity(size, size) - reached * reached.transpose());
    measured(rows).array() += count;
    left += static_cast<Eigen::Index>(count) * (size - reached.cols());
  }
  const Eigen::VectorXd root = measured.cwiseMax(1.0).cwiseSqrt().cwiseInverse();
  const SymmetricEigen solver(root.asDiagonal() * projection * root.asDiagonal());
  effects.means_degrees_of_freedom = (solver.eigenvalues().array() > k_unseen).count();
  effects.denominator_degrees_of_freedom = std::max<Eigen::Index>(left - effects.means_degrees_of_freedom, 0);
  const Eigen::MatrixXd whitened = tests.noise.cwiseSqrt().cwiseInverse().asDiagonal() * moved;
  const Eigen::VectorXd whole = (projection.diagonal().asDiagonal() * whitened.leftCols(m).cwiseAbs2()).colwise().sum();
  const Eigen::VectorXd remains = without_shared(whitened.transpose() * projection * whitened, shared).diagonal();
  constexpr double k_rounding = 1e-9;
  effects.noncentrality = (remains.array() > k_rounding * whole.array()).select(remains, 0.0);
}

/// The test of the means, by the covariance that it has of them.
void test_means(const LinearTests& tests, ErrorEffects& effects) {
  LinearTests means{tests.sensitivity, tests.errors, tests.of_cloud, Eigen::MatrixXd::Zero(1, tests.values.cols()), {}};
  means.covariance += covariance_of_tests_mean(
      {.values = tests.values, .repeatability_std = {}, .model_error_std = tests.model_error_std}, tests.of_test);
  const ErrorEffects own = error_effects(means);
  effects.noncentrality = own.noncentrality;
}

}  // namespace

ErrorEffects error_effects(const LinearTests& tests) {
  const Eigen::Index q = tests.sensitivity.cols();
  const Eigen::Index m = tests.errors.cols();
  const Eigen::Index shared = tests.model_error_std.size();
  Eigen::MatrixXd design(tests.sensitivity.rows(), q + m + shared);
  design.leftCols(q) = tests.sensitivity;
  design.middleCols(q, m) = tests.errors;
  if (shared > 0) design.rightCols(shared) = tests.model_error_std.asDiagonal();
  const Eigen::MatrixXd information = without_shared(information_of(tests, design), shared);
  const SeenInverse seen = invert_seen(information.topLeftCorner(q, q));
  ErrorEffects effects;
  effects.mean_covariance = seen.inverse;
  effects.shift = seen.inverse * information.topRightCorner(q, m);
  remain_of(information, seen, effects);
  Eigen::Index measured = 0;
  Eigen::Index left = 0;
  for (Eigen::Index k = 0; k < tests.values.cols(); ++k) measured += tests.values.col(k).array().isNaN().all() ? 0 : 1;
  for (Eigen::Index s = 0; s < tests.values.rows(); ++s) {
    left += std::max<Eigen::Index>((!tests.values.row(s).array().isNaN()).count() - seen.rank, 0);
  }
  effects.means_degrees_of_freedom = std::max<Eigen::Index>(measured - seen.rank, 0);
  effects.denominator_degrees_of_freedom = std::max<Eigen::Index>(left - effects.means_degrees_of_freedom, 0);
  if (tests.noise.size() > 0) test_within_specimens(tests, effects);
  if (tests.of_test.size() > 0) test_means(tests, effects);
  return effects;
}

namespace {

double noncentrality_refused(double degrees_of_freedom, const MeansTest& test) {
  return std::isinf(test.denominator) ? chi_squared_detectable(degrees_of_freedom, test.level)
                                      : f_detectable(degrees_of_freedom, test.denominator, test.level);
}

}  // namespace

double HiddenError::harm() const {
  double largest = 0.0;
  for (Eigen::Index i = 0; i < would_move.size(); ++i) largest = std::max(largest, harm_to(i));
  return largest;
}

double HiddenError::harm_to(Eigen::Index parameter) const {
  if (std::isfinite(would_move(parameter))) return std::abs(would_move(parameter));
  const double move = prior_deviations(parameter);
  return std::isfinite(move) ? std::abs(move) : 0.0;
}

bool HiddenError::is_beyond_first_order() const {
  return (prior_deviations.array().abs() > 1.0).any();
}

std::vector<HiddenError> hidden_errors(const ErrorEffects& effects, const MeansTest& test) {
  const auto degrees_of_freedom = static_cast<double>(effects.means_degrees_of_freedom);
  const bool is_tested = degrees_of_freedom > 0.0 && test.denominator > 0.0;
  const double needed = is_tested ? noncentrality_refused(degrees_of_freedom, test) : 0.0;
  std::vector<HiddenError> errors;
  for (Eigen::Index e = 0; e < effects.noncentrality.size(); ++e) {
    HiddenError error{.quantity = e, .relative_change = test.stated_change};
    const double detected = std::sqrt(needed / effects.noncentrality(e));  // infinite where nothing remains
    error.is_detected = is_tested && detected <= 1.0;
    const Eigen::ArrayXd shift = effects.shift.col(e).array();
    if (error.is_detected) {
      error.relative_change = detected;
    } else {
      // An error may go either way: the way that leaves more room counts.
      double up = test.stated_change;
      double down = test.stated_change;
      for (Eigen::Index i = 0; i < shift.size(); ++i) {
        if (shift(i) == 0.0) continue;
        up = std::min(up, (shift(i) > 0.0 ? test.room_above(i) : test.room_below(i)) / std::abs(shift(i)));
        down = std::min(down, (shift(i) > 0.0 ? test.room_below(i) : test.room_above(i)) / std::abs(shift(i)));
      }
      error.relative_change = std::max(up, down);
      error.is_cut = error.relative_change < test.stated_change;
    }
    error.would_move = (test.half_widths.array() > 0.0)
                           .select(error.relative_change * shift / test.half_widths.array(), std::nan(""))
                           .matrix();
    error.prior_deviations = Eigen::VectorXd::Constant(shift.size(), std::nan(""));
    if (test.prior_std.size() > 0) {
      error.prior_deviations = error.relative_change * shift.matrix().cwiseQuotient(test.prior_std);
    }
    errors.push_back(std::move(error));
  }
  return errors;
}

}  // namespace mottle::updating
