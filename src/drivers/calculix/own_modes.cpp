#include "drivers/calculix/own_modes.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/dynamics/modes/mode_set.hpp"
#include "mottle/linalg/sparse/sparse_modes.hpp"

namespace mottle::drivers {

OwnModesComparison compare_with_own_modes(const SeparablePencil& pencil, const Eigen::VectorXd& parameters,
                                          const Eigen::VectorXd& own) {
  constexpr double k_agreement = 1e-4;  // of frequencies: what a reduced model may be off too
  constexpr double k_rigid = 1e-6;      // of the highest eigenvalue: what both programs leave of a rigid-body mode
  OwnModesComparison result;
  if (own.size() == 0) return result;
  SparseModeSolver solver;
  const SparseModes modes = solver.solve(pencil.stiffness.at(parameters), pencil.mass.at(parameters),
                                         {.modes = static_cast<int>(own.size()), .measures = false});
  if (!modes.failure.empty()) {
    result.failure = fmt::format("CalculiX prints its matrices with 14 digits, and of those {}", modes.failure);
    return result;
  }
  const double rigid = k_rigid * own.cwiseAbs().maxCoeff();
  for (Eigen::Index k = 0; k < std::min(own.size(), modes.values.size()); ++k) {
    if (std::abs(own(k)) <= rigid && std::abs(modes.values(k)) <= rigid) continue;
    const double error = std::abs(std::sqrt(std::max(modes.values(k) / own(k), 0.0)) - 1.0);
    result.error = std::max(result.error, error);
    if (error <= k_agreement || !result.failure.empty()) continue;
    const double frequency = natural_frequencies_hz(modes.values)(k);
    result.failure =
        fmt::format("CalculiX prints its matrices with 14 digits, and of those mode {} {} instead of its own {:.6g} Hz",
                    k + 1, std::isnan(frequency) ? "is unstable" : fmt::format("has {:.6g} Hz", frequency),
                    natural_frequencies_hz(own)(k));
  }
  return result;
}

}  // namespace mottle::drivers
