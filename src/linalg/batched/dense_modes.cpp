#include "mottle/linalg/batched/dense_modes.hpp"

#include <Eigen/Core>
#include <limits>

#include "linalg/vector_signs.hpp"
#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::linalg {
namespace {

DenseModes failed_modes(Eigen::Index order, Eigen::Index modes) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  return {Eigen::VectorXd::Constant(modes, nan), Eigen::MatrixXd::Constant(order, modes, nan), true};
}

}  // namespace

DenseModes solve_modes(const Eigen::Ref<const Eigen::MatrixXd>& stiffness,
                       const Eigen::Ref<const Eigen::MatrixXd>& mass, int modes) {
  const Eigen::Index order = stiffness.rows();
  require(order >= 1 && stiffness.cols() == order, "stiffness: {} x {}, need a square matrix", order, stiffness.cols());
  require(mass.rows() == order && mass.cols() == order, "mass: {} x {}, need {} x {} as the stiffness", mass.rows(),
          mass.cols(), order, order);
  require(0 <= modes && modes <= order, "modes: {}, need 0 (all) to {}", modes, order);
  const Eigen::Index count = modes == 0 ? order : modes;

  if (!stiffness.allFinite() || !mass.allFinite()) return failed_modes(order, count);
  const CholeskyFactor cholesky(mass);
  if (!cholesky.is_positive_definite()) return failed_modes(order, count);
  Eigen::MatrixXd reduced = stiffness.selfadjointView<Eigen::Lower>();
  cholesky.solve_lower_in_place(reduced);
  reduced.transposeInPlace();
  cholesky.solve_lower_in_place(reduced);

  const SymmetricEigen solver(reduced);
  if (!solver.has_converged()) return failed_modes(order, count);
  DenseModes result{solver.eigenvalues().head(count), solver.eigenvectors().leftCols(count), false};
  cholesky.solve_upper_in_place(result.vectors);
  if (!result.values.allFinite() || !result.vectors.allFinite()) return failed_modes(order, count);
  make_largest_component_positive(result.vectors);
  return result;
}

}  // namespace mottle::linalg
