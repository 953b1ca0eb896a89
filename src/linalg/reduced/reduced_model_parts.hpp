// What a reduced model is made of; one place for construction, training and solution to share.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <mutex>
#include <vector>

#include "linalg/reduced/batched_davidson.hpp"
#include "linalg/sparse/supported_matrix.hpp"
#include "mottle/linalg/reduced/reduced_model.hpp"

namespace mottle::linalg {

constexpr Eigen::Index k_sketch_rows = 80;
// Of squares that a sketch shows: chi-squared with 80 degrees of freedom is below 80 / 3.2 once in 2e9.
constexpr double k_sketch_reserve = 3.2;
// Above the wanted modes: one that is followed as well as they are, since the two may meet anywhere, two that are
// followed roughly, and one that tells only how far away the next is.
constexpr int k_guard_modes = 4;
constexpr int k_sharp_guards = 1;

/// What samples are solved for. Training asks what more vectors could mend: it takes no notice of modes that residuals
/// cannot show, and leaves less over inside the basis, which would look like a want of vectors.
enum class Purpose { training, results };

/// A pencil of the family of which all modes up to a level are in the basis.
struct Floor {
  Eigen::VectorXd stiffness, mass;  ///< coefficients, the constants' first
  double level = 0.0;               ///< lambda
};

/// What the solution of the nominal pencil told and a file of a trained model keeps.
struct NominalFacts {
  Eigen::MatrixXd stiffness_bounds;  ///< of K_t against A, see FormBounds [term x (lower, upper)]
  Eigen::MatrixXd mass_bounds;       ///< of M_t against the nominal M; zeros where the mass is constant
  double mass_share = 0.0;           ///< largest share of the shifted mass in A: 1 where a body is free
  double exact_seconds = 0.0;        ///< processor time of the nominal solution
  double shift = 0.0;                ///< A = K - shift M, at the nominal sample
  double highest_mode = 0.0;         ///< lambda of the highest nominal mode
};

/// The full pencils and everything that the nominal one gives. The constant terms come first. Copies of a model share
/// it; only training and refinement use the factor and the sketch.
struct FullPencils : NominalFacts {
  FullPencils(const PencilTerms& terms, const TermCoefficients& nominal, const SparseMatrix& nominal_k,
              const SparseMatrix& nominal_m, const ReducedModelOptions& options);
  /// With what an earlier solution told: no factor until something asks for it.
  FullPencils(const PencilTerms& terms, const TermCoefficients& nominal, const SparseMatrix& nominal_k,
              const SparseMatrix& nominal_m, NominalFacts facts);

  Eigen::Index size() const { return shifted.rows(); }
  /// alpha: a sample's K - shift M >= alpha A as forms; -infinity where nothing is known [sample].
  Eigen::VectorXd smallest_ratios(const TermCoefficients& samples) const;
  /// beta: a sample's mass <= beta times the nominal one; infinity where nothing is known [sample].
  Eigen::VectorXd largest_mass_ratios(const TermCoefficients& samples) const;
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
  void take(const PencilTerms& terms, const SparseMatrix& nominal_k, const SparseMatrix& nominal_m);
  void make_sketch();
  void catch_up();
  /// @param flexibility  diagonal of A^-1, an upper estimate
  void bound_stiffness(const PencilTerms& terms, const Eigen::VectorXd& flexibility);
  void bound_mass(const PencilTerms& terms, const Eigen::VectorXd& flexibility);

  std::once_flag is_ready_;  ///< of the rest
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

/// A-orthonormal combinations of a block whose Gram matrix is given, `before` that of the squared lengths before the
/// basis was taken out; what is hardly there is dropped.
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
  Eigen::MatrixXd pending;                       ///< while it grows: V is the basis times this, once it is settled
  std::vector<Eigen::MatrixXd> stiffness, mass;  ///< V' K_t V, V' M_t V
  std::vector<Floor> floors;
  bool reaches_tolerance = true;                               ///< the last training did
  Eigen::MatrixXd floor_modes;                                 ///< coordinates, of A-length 1 [vector x mode]
  std::vector<Eigen::MatrixXd> stiffness_sketch, mass_sketch;  ///< W' K_t V, W' M_t V
  /// Of the basis as it is: another one with every change of it, shared by copies.
  std::shared_ptr<PreparedModes> prepared = std::make_shared<PreparedModes>();

  /// Ritz values and vectors with guards, what they leave over, and what that means.
  struct Solution {
    Eigen::MatrixXd values;   ///< [mode and guards x sample]
    Eigen::MatrixXd vectors;  ///< [vector * (mode and guards) x sample]
    Eigen::MatrixXd bounds;   ///< [mode and sharp guard x sample]
    /// Sketched, over sqrt(sketch rows * ratio * mu) [sketch row x (mode and guards) * sample].
    Eigen::MatrixXd residuals;
  };
  /// Modes and guards that are solved for; the first of them are followed as well as the wanted ones.
  Eigen::Index solved_modes() const;
  Eigen::Index sharp_modes() const;
  Solution solve(const TermCoefficients& samples, Purpose purpose, int threads) const;
  const BatchedDavidson& batched_davidson() const;
  /// Lowest modes of the reduced pencils, guards included: of most samples by BatchedDavidson, of the others by
  /// themselves.
  ///
  /// @param inside  squared residual that the iteration may leave over inside the basis, of the tolerance
  SketchedModes reduced_modes(const TermCoefficients& samples, const Eigen::VectorXd& ratios, double inside,
                              int threads) const;
  /// See SketchedModes.
  Eigen::MatrixXd sketched_residuals(const TermCoefficients& samples, const BatchModes& found, int threads) const;
  /// Bounds on lambda of the lowest `wanted` of one sample's Ritz pairs; infinite from `unseen` on.
  ///
  /// @param lambda   Ritz values [mode and guards]
  /// @param squares  r' A^-1 r over the sample's ratio, upper estimates [mode and guards]
  Eigen::VectorXd bounds(const Eigen::Ref<const Eigen::VectorXd>& lambda, const Eigen::VectorXd& squares, double unseen,
                         Eigen::Index wanted) const;

  /// A mode that residuals cannot show, because it shares nothing with the basis at any sample, obeys
  ///   lambda(s) >= min (a_t(s) / a_t) / max (b_t(s) / b_t) lambda of the floor,
  /// and the floor's lambda is above its level. The largest of these bounds [sample].
  Eigen::VectorXd unseen_above(const TermCoefficients& samples) const;
  /// Adds a floor below all samples, with its modes, if those there are do not keep unseen modes away.
  void raise_floor(const TermCoefficients& samples, int threads);
  /// Appends modes up to `level` of a pencil and remembers it as a floor.
  void add_floor(Floor floor, const Eigen::MatrixXd& modes, int threads);

  /// V c of some coordinates, with their padding.
  VectorRows shapes(const Eigen::MatrixXd& coordinates) const;
  /// Appends what is new in the first `count` vectors of `block` to the basis.
  void append(const VectorRows& block, Eigen::Index count, int threads);
  /// Enlarges the projections by those of the last `added` vectors of the basis, which `block` holds too.
  void project_last(const VectorRows& block, Eigen::Index added, int threads);
  /// The last columns of V' A V, by the projections.
  Eigen::MatrixXd nominal_columns(Eigen::Index count) const;
  /// Makes the last vectors A-orthonormal to all and to each other, by the projections alone; returns how many are
  /// left.
  Eigen::Index orthonormalise_last(Eigen::Index added);
  /// Turns the basis and drops directions: V <- V q.
  void rotate(const Eigen::MatrixXd& q);
  /// Multiplies the basis by what is pending.
  void settle();
};

}  // namespace mottle::linalg
