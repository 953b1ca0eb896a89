#include "mottle/dynamics/modes/damping.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/dynamics/modes/mac.hpp"

namespace mottle::dynamics {

Eigen::VectorXd modal_damping_ratios(const ModeSet& modes, const Eigen::Ref<const Eigen::MatrixXd>& damping) {
  const Eigen::Index n = modes.shapes.rows();
  require(modes.shapes.cols() == n, "{} modes of {}: damped modes need all of them", modes.shapes.cols(), n);
  // In modal coordinates the mass matrix is the identity: no inverse of M, well scaled.
  Eigen::MatrixXd state = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  state.topRightCorner(n, n).setIdentity();
  state.bottomLeftCorner(n, n) = (-modes.eigenvalues).asDiagonal();
  state.bottomRightCorner(n, n) = -modes.shapes.transpose() * damping * modes.shapes;
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(state);
  if (solver.info() != Eigen::Success) return Eigen::VectorXd::Constant(n, std::numeric_limits<double>::quiet_NaN());

  std::vector<double> ratios;
  Eigen::MatrixXd participation(n, n);  // [undamped mode x damped mode]; zero for a mode that does not oscillate
  participation.setZero();
  for (Eigen::Index k = 0; k < 2 * n && static_cast<Eigen::Index>(ratios.size()) < n; ++k) {
    const std::complex<double> root = solver.eigenvalues()(k);
    if (root.imag() <= 0.0) continue;  // one of each conjugate pair is enough
    const Eigen::VectorXd shape = solver.eigenvectors().col(k).head(n).cwiseAbs2();
    participation.col(static_cast<Eigen::Index>(ratios.size())) = shape / shape.sum();
    ratios.push_back(-root.real() / std::abs(root));
  }
  ratios.resize(static_cast<std::size_t>(n), std::numeric_limits<double>::quiet_NaN());

  const std::vector<int> damped_mode = optimal_assignment(participation);
  Eigen::VectorXd result(n);
  for (Eigen::Index r = 0; r < n; ++r) {
    result(r) = ratios[static_cast<std::size_t>(damped_mode[static_cast<std::size_t>(r)])];
  }
  return result;
}

}  // namespace mottle::dynamics
