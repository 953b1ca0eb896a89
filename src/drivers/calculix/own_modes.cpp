#include "drivers/calculix/own_modes.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/dynamics/modes/mode_set.hpp"
#include "mottle/linalg/sparse/sparse_modes.hpp"

namespace mottle::drivers {

namespace {

/// Up to these sizes eigenvalues may be what rounding leaves of a rigid-body motion: a small part of the highest one,
/// or of the terms that its shape adds up.
struct RigidLimits {
  Eigen::ArrayXd own;       ///< of CalculiX's own eigenvalues [mode]
  Eigen::ArrayXd matrices;  ///< of those of the matrices: 14 digits are printed, and a fit to several decks keeps fewer
};

RigidLimits rigid_limits(const SparseMatrix& stiffness, const SparseModes& modes, const Eigen::VectorXd& own) {
  constexpr double k_of_highest = 1e-6;
  const double of_highest = k_of_highest * own.cwiseAbs().maxCoeff();
  const Eigen::ArrayXd terms = sums_of_terms(stiffness, modes.vectors).array();
  return {(1e-14 * terms).max(of_highest), (1e-12 * terms).max(of_highest)};
}

std::string frequency_text(double eigenvalue) {
  if (eigenvalue < 0.0) return fmt::format("the eigenvalue {:.3g}", eigenvalue);
  return fmt::format("{:.6g} Hz", natural_frequencies_hz(Eigen::VectorXd::Constant(1, eigenvalue))(0));
}

}  // namespace

OwnModesComparison compare_with_own_modes(const SeparablePencil& pencil, const Eigen::VectorXd& parameters,
                                          const Eigen::VectorXd& own) {
  constexpr double k_agreement = 1e-4;  // of frequencies: what a reduced model may be off too
  OwnModesComparison result;
  if (own.size() == 0) return result;
  SparseModeSolver solver;
  const SparseMatrix stiffness = pencil.stiffness.at(parameters);
  const SparseModes modes =
      solver.solve(stiffness, pencil.mass.at(parameters), {.modes = static_cast<int>(own.size()), .measures = false});
  if (!modes.failure.empty()) {
    result.failure = fmt::format("CalculiX prints its matrices with 14 digits, and of those {}", modes.failure);
    return result;
  }
  const RigidLimits rigid = rigid_limits(stiffness, modes, own);
  for (Eigen::Index k = 0; k < std::min(own.size(), modes.values.size()); ++k) {
    if (std::abs(own(k)) <= rigid.own(k) && std::abs(modes.values(k)) <= rigid.matrices(k)) continue;
    ++result.compared;
    const double error = std::abs(std::sqrt(std::max(modes.values(k) / own(k), 0.0)) - 1.0);
    result.error = std::max(result.error, error);
    if (error <= k_agreement || !result.failure.empty()) continue;
    result.failure =
        fmt::format("CalculiX prints its matrices with 14 digits, and of those mode {} has {} instead of its own {}",
                    k + 1, frequency_text(modes.values(k)), frequency_text(own(k)));
  }
  return result;
}

}  // namespace mottle::drivers
