// What is taken from OpenTURNS: Sobol's sequence, Gaussian processes and polynomial chaos. Loading that library takes
// 70 ms and 60 MB, which most runs do not need: it is linked to a module of Mottle's (modules/openturns), which is
// loaded at the first call.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <vector>

#include "mottle/layers.hpp"
#include "stats/surrogates/surrogate_fit.hpp"

namespace mottle::stats {

/// Const members may be called from many threads.
class OpenTurns {
 public:
  virtual ~OpenTurns() = default;

  /// Largest dimension of Sobol's sequence.
  virtual Eigen::Index max_sobol_dimension() const = 0;

  /// Fills `points` [point x dimension] with Sobol's sequence, from the first point after the origin on.
  virtual void fill_with_sobol_points(Eigen::Ref<Eigen::MatrixXd> points) const = 0;

  /// Gaussian process with a Matern 5/2 covariance for each output.
  ///
  /// @param x     scaled inputs [run x input]
  /// @param y     scaled outputs [run x output]
  /// @param like  a fit of kriging() whose covariance lengths are taken; null: the most likely ones
  /// @throws SystemFailure  the fit breaks down (so in chaos())
  virtual std::shared_ptr<const Surrogate::Fit> kriging(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y,
                                                        const Surrogate::Fit* like) const = 0;

  /// Sparse Legendre expansion for each output.
  virtual std::shared_ptr<const Surrogate::Fit> chaos(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) const = 0;
};

/// Version of the classes above; a module says the one that it was built with as `mottle_openturns_version`.
inline constexpr int k_openturns_version = 1;
/// A module's function that gives its only object; it is `mottle_openturns` there, with C linkage.
using GiveOpenTurns = const OpenTurns*();

/// The first of the folders' modules. Throws SystemFailure where none of them has it.
std::filesystem::path find_openturns_module(const std::vector<std::filesystem::path>& folders);

/// The module's object, loaded at the first call. The module is looked for in the folder that MOTTLE_MODULES names,
/// beside the program or library that holds this function, and where the system looks for the libraries of that one,
/// its run path first.
///
/// @throws SystemFailure  the module is not there, cannot be loaded or belongs to another version
const OpenTurns& openturns();

}  // namespace mottle::stats
