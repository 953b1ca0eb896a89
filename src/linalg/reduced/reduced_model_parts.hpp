// Data of a reduced model, shared by its construction, training and solution.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "linalg/reduced/batched_davidson.hpp"
#include "linalg/sparse/supported_matrix.hpp"
#include "mottle/linalg/reduced/reduced_model.hpp"

namespace mottle::linalg {

constexpr Eigen::Index k_sketch_rows = 80;
// Safety factor on squared norms estimated by a sketch: chi-squared with 80 degrees of freedom is below 80 / 3.2 with
// probability 5e-10.
constexpr double k_sketch_reserve = 3.2;
// Guard modes above the wanted ones: one that converges as they do, since eigenvalues may cross in the family, two
// with a looser limit, and one that only bounds the distance to the next eigenvalue.
constexpr int k_guard_modes = 4;
constexpr int k_converged_guards = 1;

/// What samples are solved for. Training looks for errors that more basis vectors would reduce: it ignores the bound
/// for modes orthogonal to the basis, and iterates to smaller residuals within the basis, which would otherwise be
/// taken for a lack of vectors.
enum class Purpose { training, results };

/// A pencil of the family whose modes up to a known eigenvalue are all in the basis. Other samples' spectra are
/// compared with it, see complement_bounds.
struct ReferencePencil {
  Eigen::VectorXd stiffness, mass;  ///< coefficients, the constants' first
  double complete_to = 0.0;         ///< lambda up to which the basis holds its modes
  std::int64_t modes = 0;           ///< number of them
};

/// The pencils, each with another level `complete_to`.
std::vector<ReferencePencil> with_levels(std::vector<ReferencePencil> pencils, const Eigen::VectorXd& levels);

/// Results of the nominal pencil's solution that a file of a trained model keeps.
struct NominalFacts {
  Eigen::MatrixXd stiffness_bounds;  ///< of K_t against A, see FormBounds [term x (lower, upper)]
  Eigen::MatrixXd mass_bounds;       ///< of M_t against the nominal M; zeros where the mass is constant
  double mass_fraction = 0.0;        ///< largest fraction of A that is the shifted mass: 1 with rigid-body modes
  double exact_seconds = 0.0;        ///< processor time of the nominal solution
  double shift = 0.0;                ///< A = K - shift M, at the nominal sample
  double highest_mode = 0.0;         ///< lambda of the highest nominal mode
  Eigen::MatrixXd resolution;        ///< see ReducedModel::resolution()
};

/// The pencils in all equations, with the nominal pencil's factor and modes. The constant terms come first. Copies of a
/// model share it; only training and refinement use the factor and the sketch.
struct FullPencils : NominalFacts {
  FullPencils(const PencilTerms& terms, const TermCoefficients& nominal, const SparseMatrix& nominal_k,
              const SparseMatrix& nominal_m, const ReducedModelOptions& options);
  /// From results of an earlier solution: A is factorised only when its factor is asked for.
  FullPencils(const PencilTerms& terms, const TermCoefficients& nominal, const SparseMatrix& nominal_k,
              const SparseMatrix& nominal_m, NominalFacts facts);

  Eigen::Index size() const { return shifted.rows(); }
  /// alpha: a sample's K - shift M >= alpha A as forms; -infinity where nothing is known [sample].
  Eigen::VectorXd stiffness_lower_ratios(const TermCoefficients& samples) const;
  /// beta: a sample's mass <= beta times the nominal one; infinity where nothing is known [sample].
  Eigen::VectorXd mass_upper_ratios(const TermCoefficients& samples) const;
  /// A sample's mass >= this times the nominal one, and semidefinite where it is not negative; -infinity where nothing
  /// is known [sample].
  Eigen::VectorXd mass_lower_ratios(const TermCoefficients& samples) const;
  /// Whether a term is not proven to be positive semidefinite.
  bool has_indefinite_terms() const;

  /// The pencil at given coefficients, the constants' first.
  SparseMatrix stiffness_at(const Eigen::VectorXd& coefficients) const { return sum(stiffness, coefficients); }
  SparseMatrix mass_at(const Eigen::VectorXd& coefficients) const { return sum(mass, coefficients); }

  std::vector<SupportedMatrix> stiffness, mass;
  Eigen::VectorXd nominal_stiffness, nominal_mass;  ///< coefficients, 1 for the constants
  SparseMatrix shifted;                             ///< A, lower triangle
  Eigen::MatrixXd modes;                            ///< nominal shapes [equation x mode]

  /// Of A.
  DefiniteFactor& factor();
  /// W with W W' near k_sketch_rows A^-1 [equation x sketch row].
  const VectorRows& sketch();

 private:
  SparseMatrix sum(const std::vector<SupportedMatrix>& terms, const Eigen::VectorXd& coefficients) const;
  void set_terms(const PencilTerms& terms, const SparseMatrix& nominal_k, const SparseMatrix& nominal_m);
  void make_sketch();
  void make_factor();
  /// @param flexibility  upper estimate of the diagonal of A^-1
  void bound_stiffness(const PencilTerms& terms, const Eigen::VectorXd& flexibility);
  void bound_mass(const PencilTerms& terms, const Eigen::VectorXd& flexibility);

  std::once_flag is_ready_;  ///< of factor and sketch
  SparseModeSolver solver_;  ///< holds the factor of A
  VectorRows sketch_;
  SparseMatrix nominal_k_, nominal_m_;  ///< until the factor is made
};

/// Coefficients of one sample with the constant's, 1, in front.
inline Eigen::VectorXd with_constant(const Eigen::Ref<const Eigen::VectorXd>& coefficients) {
  Eigen::VectorXd result(coefficients.size() + 1);
  result << 1.0, coefficients;
  return result;
}

/// Coefficients of A-orthonormal combinations of a block of vectors; directions that depend linearly on others are
/// dropped.
///
/// @param gram    Gram matrix of the block, after projection onto the complement of the basis
/// @param before  squared A-lengths before that projection
Eigen::MatrixXd orthonormal_combinations(const Eigen::MatrixXd& gram, const Eigen::VectorXd& before);

/// Upper estimates of r' A^-1 r from W' r [sketch row x residual].
Eigen::VectorXd sketched_squares(const Eigen::Ref<const Eigen::MatrixXd>& sketched);

/// BatchedDavidson of a basis, made when they are first asked for.
struct PreparedModes {
  std::once_flag is_made;
  std::unique_ptr<BatchedDavidson> modes;
};

struct ReducedModel::Parts {
  std::shared_ptr<FullPencils> full;
  ReducedModelOptions options;
  Eigen::MatrixXd basis;                         ///< V, A-orthonormal
  Eigen::MatrixXd pending;                       ///< while it grows: V is `basis` times this, see apply_pending
  std::vector<Eigen::MatrixXd> stiffness, mass;  ///< V' K_t V, V' M_t V
  std::vector<ReferencePencil> reference_pencils;
  bool reaches_tolerance = true;                               ///< whether the last training did
  Eigen::MatrixXd reference_modes;                             ///< coordinates, of A-length 1 [vector x mode]
  std::vector<Eigen::MatrixXd> stiffness_sketch, mass_sketch;  ///< W' K_t V, W' M_t V
  /// For the current basis: replaced with every change of it, shared by copies.
  std::shared_ptr<PreparedModes> prepared = std::make_shared<PreparedModes>();
  /// Coordinates of the directions that most samples get by with [vector x direction], and the model on them, which has
  /// no basis of its own; empty and null where they save too little.
  Eigen::MatrixXd leading_directions;
  Eigen::VectorXd leading_levels;  ///< up to which these hold the reference pencils' modes
  std::shared_ptr<const Parts> leading;

  /// Ritz values and vectors with guards, their residuals and error bounds.
  struct Solution {
    Eigen::MatrixXd values;   ///< [mode and guards x sample]
    Eigen::MatrixXd vectors;  ///< [vector * (mode and guards) x sample]
    Eigen::MatrixXd bounds;   ///< [mode and converged guard x sample]
    /// Sketched, over sqrt(sketch rows * ratio * mu) [sketch row x (mode and guards) * sample].
    Eigen::MatrixXd residuals;
  };
  Eigen::Index vectors() const { return stiffness[0].rows(); }
  /// Number of modes and guards that are solved for, and of the first of them that must converge to the limit.
  Eigen::Index solved_modes() const;
  Eigen::Index converged_modes() const;
  /// Number of modes, and of these and guards, that are given.
  Eigen::Index wanted_modes() const { return std::min<Eigen::Index>(options.modes, solved_modes()); }
  Eigen::Index given_modes() const { return std::min<Eigen::Index>(options.modes + options.guards, solved_modes()); }
  Solution solve(const TermCoefficients& samples, Purpose purpose, int threads) const;
  CertifiedModes certified(const TermCoefficients& samples, int threads) const;
  const BatchedDavidson& batched_davidson() const;
  /// Lowest modes of the reduced pencils, guards included: of most samples by BatchedDavidson, of the others by
  /// themselves.
  ///
  /// @param inside  squared residual at which the iteration within the basis stops, relative to the tolerance
  SketchedModes reduced_modes(const TermCoefficients& samples, const Eigen::VectorXd& ratios, double inside,
                              int threads) const;
  /// Modes of the whole reduced pencils, guards included, from the highest eigenvalues of (M, K - shift M): rotations
  /// without mass make the projected mass nearly singular, and a factor of it would lose the digits of all modes.
  BatchModes whole_modes(const TermCoefficients& samples, int threads) const;
  /// Rayleigh-Ritz on the modes far below what the basis holds, in its coordinates: in the standard form that the dense
  /// solution takes, rounding errors scale with the highest eigenvalue.
  void solve_soft_modes(const TermCoefficients& samples, int threads, BatchModes& found) const;
  /// What errors of eigenvalues are relative to: lambda, of rigid-body modes smallest_size().
  Eigen::ArrayXd sizes(const Eigen::Ref<const Eigen::VectorXd>& lambda) const;
  double smallest_size() const;
  /// See SketchedModes.
  Eigen::MatrixXd sketched_residuals(const TermCoefficients& samples, const BatchModes& found, int threads) const;
  /// Relative error bounds of lambda for the lowest `wanted` of one sample's Ritz pairs; infinite from
  /// `complement_bound` on.
  ///
  /// @param lambda   Ritz values [mode and guards]
  /// @param squares  upper estimates of r' A^-1 r over the sample's stiffness ratio [mode and guards]
  /// @param enough   below this fraction of the tolerance a smaller bound is not sought
  Eigen::VectorXd bounds(const Eigen::Ref<const Eigen::VectorXd>& lambda, const Eigen::VectorXd& squares,
                         double complement_bound, Eigen::Index wanted, double enough = 0.0) const;

  /// Lower bound of lambda for modes orthogonal to the basis, which residuals cannot show: the largest over the
  /// reference pencils (a, b) of
  ///   lambda(s) >= min (a_t(s) / a_t) / max (b_t(s) / b_t) complete_to   [sample]
  /// less what terms that are not semidefinite may take away.
  Eigen::VectorXd complement_bounds(const TermCoefficients& samples) const;
  /// The bound by one of the further reference pencils of one sample whose stiffness ratio (alpha) is known. With r and
  /// h the extreme ratios, d = sum (a_t(s) - r a_t) max(-l_t, 0) / alpha and e the like of the masses,
  ///   lambda(s) >= (r / h (1 - e) complete_to - d |shift|) / (1 + d)
  double reference_bound(const ReferencePencil& reference, const TermCoefficients& sample,
                         double stiffness_ratio) const;
  /// Adds a reference pencil softer and heavier than all samples, with its modes, if the present ones do not bound the
  /// complement's spectrum above the wanted modes.
  void add_reference_below(const TermCoefficients& samples, int threads);
  /// Appends the modes of a pencil to the basis and keeps the pencil as a reference.
  void add_reference_pencil(ReferencePencil reference, const Eigen::MatrixXd& modes, int threads);

  /// V c of some coordinates, padded as VectorRows are.
  VectorRows shapes(const Eigen::MatrixXd& coordinates) const;
  /// Appends the components of the first `count` vectors of `block` that are A-orthogonal to the basis.
  void append(const VectorRows& block, Eigen::Index count, int threads);
  /// Enlarges the projections by those of the last `added` vectors of the basis, which `block` holds too.
  void project_last(const VectorRows& block, Eigen::Index added, int threads);
  /// The last columns of V' A V, by the projections.
  Eigen::MatrixXd nominal_columns(Eigen::Index count) const;
  /// Makes the last vectors A-orthonormal to all and to each other, by the projections alone; returns how many remain.
  Eigen::Index orthonormalise_last(Eigen::Index added);
  /// Rotates the basis and drops directions: V <- V q.
  void rotate(const Eigen::MatrixXd& q);
  /// Orthonormal directions rotated to the nominal modes within their span, the lowest first.
  Eigen::MatrixXd rotation_to_nominal_modes(const Eigen::MatrixXd& directions) const;
  /// @param directions  orthonormal, nominal modes within their span [vector x direction]
  /// @param levels      lambda up to which these hold the modes of each reference pencil
  void make_leading(const Eigen::MatrixXd& directions, const Eigen::VectorXd& levels);
  /// Forgets what was made for the basis before it changes.
  void forget_derived();
  /// basis <- basis pending.
  void apply_pending();
};

}  // namespace mottle::linalg
