#include "updating/population/mean_residuals.hpp"

#include <Eigen/Core>
#include <algorithm>

#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/population/residual_noise.hpp"
#include "updating/fits/measured_outputs.hpp"
#include "updating/methods/matched_moments.hpp"

namespace mottle::updating {
namespace {

/// Residuals of the specimens in units of the noise, what their own best parameters leave of them.
struct WhitenedResiduals {
  Eigen::MatrixXd values;       // [specimen x output], 0 where missing
  Eigen::MatrixXd mean_design;  // [output x effect]
  Eigen::MatrixXd projection;   // sum of P_s [output x output]
  Eigen::VectorXd count;        // specimens that have the output [output]
  double squares = 0.0;
  double degrees_of_freedom = 0.0;
};

WhitenedResiduals whiten(const Eigen::Ref<const Eigen::MatrixXd>& tests, const std::vector<RandomEffectsUnit>& units,
                         const Eigen::VectorXd& noise) {
  const Eigen::Index p = tests.cols();
  WhitenedResiduals result{Eigen::MatrixXd::Zero(tests.rows(), p), Eigen::MatrixXd::Zero(p, units[0].design.cols()),
                           Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Zero(p)};
  for (Eigen::Index s = 0; s < tests.rows(); ++s) {
    const RandomEffectsUnit& unit = units[static_cast<std::size_t>(s)];
    const std::vector<Eigen::Index> rows = measured_outputs(tests, s);
    const auto count = static_cast<Eigen::Index>(rows.size());
    const Eigen::VectorXd weight = noise(rows).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd design = weight.asDiagonal() * unit.design;
    const Eigen::VectorXd response = weight.asDiagonal() * unit.response;
    const Eigen::MatrixXd reached = reached_by(design);
    const Eigen::VectorXd residual = response - reached * (reached.transpose() * response);
    result.projection(rows, rows) += Eigen::MatrixXd::Identity(count, count) - reached * reached.transpose();
    result.mean_design(rows, Eigen::all) += design;
    result.values(s, rows) = residual.transpose();
    result.count(rows).array() += 1.0;
    result.squares += residual.squaredNorm();
    result.degrees_of_freedom += static_cast<double>(count - reached.cols());
  }
  result.mean_design = (result.count.cwiseMax(1.0).cwiseInverse().asDiagonal() * result.mean_design).eval();
  return result;
}

/// What residuals r = P (e + N^-1/2 d) say of a shared error d.
struct SharedError {
  double explained = 0.0;  // r' (I - (I + X D X')^-1) r, X = P N^-1/2 of all specimens
  Eigen::VectorXd mean;    // E[d | r]
};

SharedError shared_error_of(const WhitenedResiduals& whitened, const Eigen::VectorXd& noise,
                            const Eigen::VectorXd& std) {
  const Eigen::VectorXd root = std.cwiseQuotient(noise.cwiseSqrt());
  Eigen::MatrixXd covariance = root.asDiagonal() * whitened.projection * root.asDiagonal();
  covariance.diagonal().array() += 1.0;
  const Eigen::VectorXd sum = root.cwiseProduct(whitened.values.colwise().sum().transpose());
  const Eigen::VectorXd deviates = CholeskyFactor(covariance).solve(sum);
  return {sum.dot(deviates), std.cwiseProduct(deviates)};
}

/// Directions of whitened outputs that no parameter moves, orthonormal [output x direction].
Eigen::MatrixXd unmoved_whitened(const Eigen::MatrixXd& design) {
  const Eigen::VectorXd scale = design.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  return unmoved_directions(design, Eigen::VectorXd::Ones(design.rows()), scale);
}

}  // namespace

MeanResiduals mean_residuals(const Eigen::Ref<const Eigen::MatrixXd>& values,
                             const std::vector<RandomEffectsUnit>& units, const Eigen::VectorXd& noise,
                             const Eigen::VectorXd& error) {
  constexpr double k_unseen = 1e-6;  // of a direction that specimens see with all of their outputs
  const WhitenedResiduals whitened = whiten(values, units, noise);
  MeanResiduals result{whitened.values, whitened.mean_design, unmoved_whitened(whitened.mean_design)};
  result.squares = std::max(whitened.squares, 1e-300);
  result.degrees_of_freedom = whitened.degrees_of_freedom;
  if (result.directions.cols() == 0) return result;
  const Eigen::MatrixXd turn =
      result.directions.transpose() * whitened.count.cwiseMax(1.0).cwiseSqrt().cwiseInverse().asDiagonal();
  const SymmetricEigen solver(turn * whitened.projection * turn.transpose());
  const Eigen::Index seen = (solver.eigenvalues().array() > k_unseen).count();
  // Rows of `unit` turn sums of residuals into independent normal deviates of variance 1.
  const Eigen::MatrixXd unit = solver.eigenvalues().tail(seen).cwiseSqrt().cwiseInverse().asDiagonal() *
                               solver.eigenvectors().rightCols(seen).transpose() * turn;
  const Eigen::VectorXd unmoved = unit * whitened.values.colwise().sum().transpose();
  result.mean_degrees_of_freedom = static_cast<double>(seen);
  result.mean_squares = unmoved.squaredNorm();
  result.squares = whitened.squares - result.mean_squares;
  if (error.size() > 0 && seen > 0) {
    const Eigen::MatrixXd by_output = unit * whitened.projection * noise.cwiseSqrt().cwiseInverse().asDiagonal();
    const Eigen::MatrixXd moved = by_output * error.asDiagonal();
    Eigen::MatrixXd covariance = moved * moved.transpose();
    covariance.diagonal().array() += 1.0;
    const CholeskyFactor factor(covariance);
    result.mean_squares = unmoved.dot(factor.solve(unmoved));
    const Eigen::MatrixXd seen_by_output = factor.solve_lower(by_output);
    result.own_noncentrality = seen_by_output.colwise().squaredNorm().transpose();
    const SharedError shared = shared_error_of(whitened, noise, error);
    result.squares = whitened.squares - shared.explained - result.mean_squares;
    result.shared = shared.mean;
    result.largest_variance = symmetric_eigenvalues(covariance).maxCoeff();
  }
  result.squares = std::max(result.squares, 1e-300);
  result.degrees_of_freedom = whitened.degrees_of_freedom - result.mean_degrees_of_freedom;
  return result;
}

}  // namespace mottle::updating
