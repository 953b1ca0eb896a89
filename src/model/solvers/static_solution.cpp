#include "model/solvers/static_solution.hpp"

#include <cmath>
#include <limits>

namespace mottle::model {
namespace {

constexpr const char* k_undetermined =
    "its stiffness matrix is singular to the computer's precision: a part of it is not supported, or its stiffnesses "
    "differ by too many orders of magnitude";

/// Moves every degree of freedom, and no two alike.
Eigen::VectorXd load_of_everything(const Eigen::VectorXd& diagonal) {
  constexpr double k_golden = 0.6180339887498949;  // multiples of it, taken modulo 1, are spread evenly
  Eigen::VectorXd load(diagonal.size());
  for (Eigen::Index i = 0; i < load.size(); ++i) {
    const double part = std::fmod(static_cast<double>(i + 1) * k_golden, 1.0);
    load(i) = std::sqrt(diagonal(i)) * (0.5 + part) * (part < 0.5 ? -1.0 : 1.0);
  }
  return load;
}

}  // namespace

StaticSolution refined_static_solution(const StaticSystem& system, const Eigen::MatrixXd& loads) {
  constexpr double k_max_loss = 1e-3;  // of a load's energy
  // Of the load that moves everything; structures that are not supported lose 0.3 and more, long beams 0.01.
  constexpr double k_max_general_loss = 0.03;
  constexpr double k_max_step_energy = 1e-6;  // an error of 1e-3
  Eigen::MatrixXd columns(loads.rows(), loads.cols() + 1);
  Eigen::RowVectorXd sizes = loads.cwiseAbs().colwise().maxCoeff();  // energies must not overflow
  sizes = (sizes.array() > 0.0).select(sizes, 1.0);
  columns << loads * sizes.cwiseInverse().asDiagonal(), load_of_everything(system.diagonal);
  Eigen::MatrixXd displacements = system.solve(columns);
  const Eigen::MatrixXd residuals = columns - system.multiply(displacements);
  const Eigen::MatrixXd steps = system.solve(residuals);
  const Eigen::MatrixXd sums = system.multiply_absolute(displacements.cwiseAbs());
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    const double energy = displacements.col(k).dot(columns.col(k));
    const double loss = std::numeric_limits<double>::epsilon() * displacements.col(k).cwiseAbs().dot(sums.col(k));
    const double step = steps.col(k).dot(residuals.col(k));
    // Written so that nan is refused.
    const bool is_determined = energy >= 0.0 && step <= k_max_step_energy * energy &&
                               loss <= (k < loads.cols() ? k_max_loss : k_max_general_loss) * energy;
    if (!is_determined) return {.failure = k_undetermined};
  }
  displacements += steps;
  return {.displacements = displacements.leftCols(loads.cols()) * sizes.asDiagonal()};
}

std::vector<Eigen::MatrixXd> static_sensitivity(const Eigen::MatrixXd& adjoint, Eigen::Index loads,
                                                Eigen::Index parameters,
                                                const std::function<Eigen::MatrixXd(Eigen::Index)>& forces) {
  std::vector<Eigen::MatrixXd> derivatives(static_cast<std::size_t>(loads),
                                           Eigen::MatrixXd(adjoint.cols(), parameters));
  for (Eigen::Index i = 0; i < parameters; ++i) {
    const Eigen::MatrixXd moved = adjoint.transpose() * forces(i);
    for (Eigen::Index load = 0; load < loads; ++load) {
      derivatives[static_cast<std::size_t>(load)].col(i) = -moved.col(load);
    }
  }
  return derivatives;
}

}  // namespace mottle::model
