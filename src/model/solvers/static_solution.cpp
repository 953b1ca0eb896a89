#include "model/solvers/static_solution.hpp"

namespace mottle::model {

StaticSolution refined_static_solution(const Eigen::MatrixXd& loads,
                                       const std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>& solve,
                                       const std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>& multiply) {
  constexpr double k_max_energy = 1e-6;  // of the step over that of the solution: an error of 1e-3
  Eigen::MatrixXd displacements = solve(loads);
  const Eigen::MatrixXd residuals = loads - multiply(displacements);
  const Eigen::MatrixXd steps = solve(residuals);
  for (Eigen::Index k = 0; k < loads.cols(); ++k) {
    const double energy = displacements.col(k).dot(loads.col(k));
    const double step_energy = steps.col(k).dot(residuals.col(k));
    // Written so that nan is refused.
    if (!(energy >= 0.0) || !(step_energy <= k_max_energy * energy)) return {.failure = k_no_static_solution};
  }
  displacements += steps;
  return {.displacements = std::move(displacements)};
}

}  // namespace mottle::model
