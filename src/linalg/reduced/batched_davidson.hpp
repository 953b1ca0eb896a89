// Lowest modes of many reduced pencils near a nominal one by block Davidson iteration from the nominal modes, which is
// cheaper than a dense solution of each.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/linalg/batched/batch_eigen.hpp"
#include "mottle/linalg/reduced/reduced_model.hpp"

namespace mottle::linalg {

/// Dense terms, the constants' first, in coordinates in which the nominal K - shift M is the identity.
struct DavidsonPencils {
  const std::vector<Eigen::MatrixXd>& stiffness;
  const std::vector<Eigen::MatrixXd>& mass;
  const Eigen::VectorXd& nominal_stiffness;  ///< coefficients, 1 for the constants
  const Eigen::VectorXd& nominal_mass;
  double shift = 0.0;
  double smallest = 0.0;                                 ///< errors of smaller eigenvalues are relative to this
  const std::vector<Eigen::MatrixXd>& stiffness_sketch;  ///< W'K_t, rows a multiple of 16
  const std::vector<Eigen::MatrixXd>& mass_sketch;
};

/// Modes, with sketches of their residuals in the full space.
struct SketchedModes {
  BatchModes modes;           ///< in the family's coordinates
  Eigen::MatrixXd residuals;  ///< W'(K - lambda M) y [sketch row x mode * sample]
};

struct DavidsonOptions {
  Eigen::Index modes = 0;      ///< wanted
  Eigen::Index converged = 0;  ///< number of lowest modes whose residuals must be below the limit
  SimdLevel simd = SimdLevel::automatic;
};

/// Bounds of the samples' forms by those of the nominal pencil.
struct DavidsonBounds {
  Eigen::VectorXd ratios;       ///< alpha: K(s) - shift M(s) >= alpha (K - shift M) [sample]
  Eigen::VectorXd mass_ratios;  ///< beta: M(s) <= beta M [sample]
};

/// Block Davidson iteration, one sample in each SIMD lane.
///
/// The block begins with the lowest nominal modes, more than are wanted, rotated to the Ritz vectors of the sample. Its
/// residuals r = K y - theta M y are answered by the diagonals, y <- y - r_i / (k_ii - theta m_ii), until those of the
/// converged modes keep to the limit; Rayleigh and Ritz on the block give the modes. A sample's modes are given only
/// where
///
///   #(negative eigenvalues of S'(K - x M) S - R' D^-1 R) = number of Ritz values below x,
///
/// x above the wanted ones, S the block, R the other rows of (K - x M) S and D = alpha - (x - shift) beta m_i a lower
/// bound of K - x M there, proves that no mode below x is missed. Bits of a sample do not depend on its neighbours.
///
/// Source: [Davidson1975]; the count is Sylvester's law of inertia after a congruence, [Parlett1998].
class BatchedDavidson {
 public:
  BatchedDavidson(const DavidsonPencils& family, const DavidsonOptions& options);

  /// False where the pencils are too small, or their spectrum too dense, for the iteration to be cheaper.
  bool is_useful() const { return block_ > 0; }

  /// Samples that are too far from the nominal one, or whose modes are not proven to be the lowest, are marked failed.
  ///
  /// @param limit  upper limit of r'r over alpha max(lambda, smallest) y'My
  SketchedModes solve(const TermCoefficients& samples, const DavidsonBounds& bounds, double limit, int threads) const;

 private:
  void pack(const std::vector<Eigen::MatrixXd>& terms, double filling, std::vector<double>& packed) const;
  void pack_sketch(const std::vector<Eigen::MatrixXd>& terms, std::vector<double>& packed) const;
  std::vector<Eigen::Index> near_samples(const TermCoefficients& samples) const;
  SketchedModes solve_near(const TermCoefficients& samples, const DavidsonBounds& bounds, double limit,
                           int threads) const;

  DavidsonOptions options_;
  double shift_, smallest_;
  Eigen::VectorXd nominal_stiffness_, nominal_mass_;  ///< coefficients
  Eigen::MatrixXd rotation_;  ///< nominal modes in the family's coordinates; empty where they are the unit vectors
  Eigen::VectorXd masses_;    ///< of the nominal modes, padded with zeros
  std::vector<double> stiffness_, mass_, stiffness_sketch_, mass_sketch_;  ///< in tiles
  Eigen::Index sketch_rows_;
  Eigen::Index rows_ = 0, order_ = 0, block_ = 0, kept_ = 0, corrected_ = 0;
};

/// sum of coefficients(t) terms[t].
Eigen::MatrixXd weighted_sum(const std::vector<Eigen::MatrixXd>& terms, const Eigen::VectorXd& coefficients);

/// Orthonormal eigenvectors of the nominal mass, its largest eigenvalue (the lowest mode) first; empty where the matrix
/// is diagonal in that order already.
Eigen::MatrixXd nominal_rotation(const Eigen::MatrixXd& nominal_mass);

}  // namespace mottle::linalg
