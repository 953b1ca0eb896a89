// Lowest modes of many large sparse pencils of one family by a reduced basis from one factorisation, each with an error
// bound.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "mottle/linalg/sparse/sparse_modes.hpp"

namespace mottle::linalg {

/// Fraction of diag(T) added to a symmetric T before the signs of its pivots decide whether it is positive
/// semidefinite. Terms are singular as a rule (rigid-body motions of their elements), so that rounding decides the sign
/// of some pivots; this is a thousand times the rounding error of a factor.
constexpr double k_inertia_tolerance = 1e-13;

/// K(s) = K_0 + sum_t a_t(s) K_t, M(s) = M_0 + sum_t b_t(s) M_t: lower triangles, compressed, all of one size; M
/// positive semidefinite. The constants may be without entries.
struct PencilTerms {
  SparseMatrix stiffness_constant;
  std::vector<SparseMatrix> stiffness;
  SparseMatrix mass_constant;
  std::vector<SparseMatrix> mass;
  /// For the constant and each term: T + k_inertia_tolerance diag(T) is known to be positive semidefinite. Where it is
  /// not known (empty, false), the term is factorised.
  std::vector<bool> is_stiffness_semidefinite = {};
  std::vector<bool> is_mass_semidefinite = {};
};

/// a_t(s) and b_t(s), [term x sample].
struct TermCoefficients {
  Eigen::MatrixXd stiffness;
  Eigen::MatrixXd mass;

  Eigen::Index samples() const { return stiffness.cols(); }
  TermCoefficients range(Eigen::Index first, Eigen::Index count) const {
    return {stiffness.middleCols(first, count), mass.middleCols(first, count)};
  }
};

struct ReducedModelOptions {
  int modes = 10;           ///< wanted of every sample
  int guards = 0;           ///< modes above these that are given without bounds, of small accuracy: at most 4
  double tolerance = 2e-4;  ///< relative, of an eigenvalue: half of it is that of a frequency
  int max_vectors = 400;    ///< largest size of the basis
};

/// Lowest modes of many samples from the reduced model.
struct CertifiedModes {
  Eigen::MatrixXd values;   ///< lambda [mode and guard x sample]; nan where a sample has none
  Eigen::MatrixXd vectors;  ///< coordinates in the basis [vector * (mode and guard) x sample]; phi' M phi = 1
  Eigen::MatrixXd bounds;   ///< e, lambda (1 - e) <= exact <= lambda [mode x sample]; infinite where nothing is known
};

/// Lowest modes of one sample, within the tolerance where `bounds` are.
struct RefinedModes {
  Eigen::VectorXd values;   ///< lambda [mode and guard]
  Eigen::MatrixXd vectors;  ///< phi' M phi = 1, the largest component positive [equation x mode and guard]
  Eigen::VectorXd bounds;   ///< e, lambda (1 - e) <= exact <= lambda [mode]; infinite where nothing is known
};
using RefinedVisitor = std::function<void(Eigen::Index sample, const RefinedModes& modes)>;

/// Reduced model of a family of pencils around one nominal pencil.
///
/// The basis holds the nominal modes and A^-1 r, A the nominal stiffness and r residuals of training samples, chosen by
/// pivoting over sketches of all their residuals, until every training sample is within half the tolerance. Residuals
/// are measured in the norm of A^-1 by a sketch of 80 random directions, with a safety factor, and bounded for a
/// sample's own stiffness by the smallest ratio of its coefficients to the nominal ones. The eigenvalues of modes
/// orthogonal to the basis are bounded from below by comparison with reference pencils of which enough modes are in the
/// basis. Derivation: docs/theory/reduced-model.md.
///
/// Not changed by solve(), which may be called by several threads. Training two copies at once is not allowed.
/// Source: [Kato1949]; [Mathias1998]; reduced bases with residual certificates after [Hesthaven2016]; sketches after
/// [Halko2011].
class ReducedModel {
 public:
  struct Parts;  ///< of the implementation

  /// @param nominal    one sample: where the basis starts
  /// @param stiffness  K there, in a pattern that holds all terms'
  /// @param mass       M there
  /// @throws InvalidInput  shapes that do not fit; a nominal pencil that has no modes
  ReducedModel(const PencilTerms& terms, const TermCoefficients& nominal, const SparseMatrix& stiffness,
               const SparseMatrix& mass, const ReducedModelOptions& options);
  ReducedModel(const ReducedModel& other);
  ReducedModel(ReducedModel&&) noexcept;
  ~ReducedModel();

  /// Adds to the basis until all samples are within half the tolerance or the basis is as large as it may be.
  ///
  /// @param each  called with the number of vectors whenever the basis has grown; what it throws ends the training
  void train(const TermCoefficients& samples, int threads, const std::function<void(Eigen::Index vectors)>& each = {});

  /// Whether the training samples came within the tolerance: false where the largest basis allowed was too small, or
  /// would have been, in which case the training ended early.
  bool reaches_tolerance() const;

  /// Lowest modes of every sample with their error bounds.
  CertifiedModes solve(const TermCoefficients& samples, int threads) const;

  /// Directions of the basis, the nominal modes within their span, that most training samples get by with: coordinates
  /// [vector x direction]. Empty where they would save too little.
  const Eigen::MatrixXd& leading_directions() const;

  /// As solve(), by these directions alone: vectors hold coordinates along them. Cheaper, with larger bounds; samples
  /// whose bounds are above the tolerance are left to solve().
  CertifiedModes solve_leading(const TermCoefficients& samples, int threads) const;

  /// Lowest modes of samples whose bounds from solve() are above the tolerance, in all equations.
  ///
  /// Begins with the reduced model's modes and adds A^-1 r of their residuals r, with Rayleigh-Ritz on all vectors so
  /// far, up to five times, until the bound is within the tolerance. A step costs a sixth of an exact solution of
  /// 20,000 equations, less of larger ones. Where solve() gives no bound (a mode may be missing) no step is taken: the
  /// bounds stay infinite, and there are no vectors.
  ///
  /// @param visit  called once a sample, by any of the threads
  /// Source: preconditioned block steps after [Knyazev2001].
  void refine(const TermCoefficients& samples, int threads, const RefinedVisitor& visit) const;

  /// [equation x vector]
  const Eigen::MatrixXd& basis() const;

  /// Whether a term of K or M is not proven to be positive semidefinite: its effect is then bounded by extreme
  /// eigenvalues, and error bounds may be infinite.
  bool has_indefinite_terms() const;

  /// Of the wanted nominal modes, lambda and how far it may be off since every number of K is rounded, to one in eps:
  /// eps |phi|' |K| |phi| with phi' M phi = 1 [mode x 2]. No solution of the pencil is better, and bounds do not
  /// include it.
  const Eigen::MatrixXd& resolution() const;

  /// Processor time that the exact solution of the nominal pencil took.
  double exact_seconds() const;

 private:
  friend class ReducedModelFile;
  explicit ReducedModel(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace mottle::linalg
