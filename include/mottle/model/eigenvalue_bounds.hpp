// Proven bounds of a structure's eigenvalues over a box of its parameters.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "mottle/core/run_context.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/structure_model.hpp"

namespace mottle::model {

class ParameterPencils;

/// Parameters between two ends, lower <= upper [parameter].
struct ParameterBox {
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;

  Eigen::VectorXd middle() const { return 0.5 * (lower + upper); }
  Eigen::VectorXd width() const { return upper - lower; }
};

/// What a parameter does to every eigenvalue.
enum class EigenvalueTrend {
  rising,   ///< none falls where it grows; also of a parameter that moves none
  falling,  ///< none rises
  mixed,    ///< neither is proven
};

/// Ranges of the lowest eigenvalues, by their order, over a box [mode].
struct EigenvalueRanges {
  Eigen::VectorXd proven_lower, proven_upper;      ///< no eigenvalue in the box lies beyond
  Eigen::VectorXd attained_lower, attained_upper;  ///< the smallest and the largest that was found in it
  Eigen::MatrixXd at_lower, at_upper;              ///< where [mode x parameter]
  bool reaches_tolerance = true;                   ///< proven and attained ends agree within the tolerance
  std::int64_t solutions = 0;                      ///< eigenvalue problems that were solved
};

struct EigenvalueBoundsOptions {
  double tolerance = 1e-3;             ///< relative, between proven and attained ends
  std::int64_t max_solutions = 20000;  ///< the ends stay proven where these do not suffice
};

/// Ranges of the ordered eigenvalues of K(x) phi = lambda M(x) phi, K and M sums of products of powers of x times
/// positive semidefinite matrices. By the principle of Courant and Fischer
///
///   K- <= K(x) <= K+ and M- <= M(x) <= M+ in the box   =>   lambda_k(K-, M+) <= lambda_k(x) <= lambda_k(K+, M-),
///
/// also after K and M are multiplied by a common power of a parameter, which leaves the eigenvalues as they are. Where
/// no term of M has a higher power of a parameter than any of K, all eigenvalues rise with it, and the ends are
/// attained in corners; where none of K has a higher one than any of M, they fall. The box is divided by the other
/// parameters until proven and attained ends agree. The proven ends include a bound on the rounding of the solver.
///
/// The theory: docs/theory/interval.md. Source: [Parlett1998], sections 10.2 and 15.3; [Hladik2010].
class EigenvalueBounds {
 public:
  /// @param model  must outlive this object
  explicit EigenvalueBounds(const StructureModel& model);
  ~EigenvalueBounds();
  EigenvalueBounds(EigenvalueBounds&&) noexcept;

  /// Why nothing can be proven of this model; empty: it can.
  const std::string& obstacle() const { return obstacle_; }
  /// [parameter]
  const std::vector<EigenvalueTrend>& trends() const { return trends_; }

  /// @param box    all ends > 0, within the physical limits
  /// @param modes  the lowest so many, >= 1
  /// @throws ModelFailure  the structure has no modes in a corner of the box
  /// @throws Stopped       on request
  EigenvalueRanges over(const ParameterBox& box, int modes, const EigenvalueBoundsOptions& options,
                        const RunContext& context) const;

  /// The lowest eigenvalues at each point, by the full matrices [point x mode]; a row of nan where there are none.
  Eigen::MatrixXd at(const Eigen::Ref<const Eigen::MatrixXd>& points, int modes, const RunContext& context) const;

 private:
  std::unique_ptr<const ParameterPencils> pencils_;
  std::string obstacle_;
  std::vector<EigenvalueTrend> trends_;
};

}  // namespace mottle::model
