#include "mottle/linalg/sparse/sparse_modes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "linalg/sparse/block_lanczos.hpp"
#include "linalg/vector_signs.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/run_context.hpp"

namespace mottle::linalg {
namespace {

/// K_ii / M_ii of the equations that have mass: without those far above the others that have next to nothing of all
/// mass.
std::vector<double> ratios_with_mass(const SparseMatrix& stiffness, const SparseMatrix& mass) {
  constexpr double k_far = 1e6;               // above n / sum(M_ii / K_ii)
  constexpr double k_next_to_nothing = 1e-9;  // of all mass; more than a structure has beside a heavy base
  const Eigen::ArrayXd k = stiffness.diagonal();
  const Eigen::ArrayXd m = mass.diagonal();
  const Eigen::Array<bool, Eigen::Dynamic, 1> has_both = k > 0.0 && m > 0.0;
  const double typical = static_cast<double>(has_both.count()) / has_both.select(m / k, 0.0).sum();
  const Eigen::Array<bool, Eigen::Dynamic, 1> is_far = has_both && k / m > k_far * typical;
  const bool leaves_out = is_far.select(m, 0.0).sum() < k_next_to_nothing * has_both.select(m, 0.0).sum();
  std::vector<double> ratios;
  for (Eigen::Index i = 0; i < k.size(); ++i) {
    if (has_both(i) && !(leaves_out && is_far(i))) ratios.push_back(k(i) / m(i));
  }
  return ratios;
}

/// A shift below all modes: a small fraction of the median K_ii / M_ii, which is near the highest eigenvalues. Small
/// against the lowest elastic modes, large enough that K - s M is definite beyond rounding for a free structure.
double default_shift(const SparseMatrix& stiffness, const SparseMatrix& mass) {
  constexpr double k_fraction_of_typical = 1e-9;
  std::vector<double> ratios = ratios_with_mass(stiffness, mass);
  if (ratios.empty()) return -1.0;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return -k_fraction_of_typical * *middle;
}

/// View of a matrix's sparsity pattern.
struct Pattern {
  std::span<const int> starts, rows;

  bool operator==(const Pattern& other) const {
    return std::ranges::equal(starts, other.starts) && std::ranges::equal(rows, other.rows);
  }
};

Pattern pattern_of(const SparseMatrix& matrix) {
  return {{matrix.outerIndexPtr(), static_cast<std::size_t>(matrix.outerSize()) + 1},
          {matrix.innerIndexPtr(), static_cast<std::size_t>(matrix.nonZeros())}};
}

SparseMatrix shifted(const SparseMatrix& stiffness, const SparseMatrix& mass, double shift) {
  if (pattern_of(stiffness) == pattern_of(mass)) {
    SparseMatrix result = stiffness;
    result.coeffs() -= shift * mass.coeffs();
    return result;
  }
  SparseMatrix result = stiffness - shift * mass;
  result.makeCompressed();
  return result;
}

/// norm(K x - lambda M x) against the size of the terms that cancel in it.
Eigen::VectorXd relative_residuals(const SparseMatrix& stiffness, const SparseMatrix& mass, const SparseModes& modes) {
  const Eigen::MatrixXd elastic = symmetric_product(stiffness, modes.vectors);
  const Eigen::MatrixXd inertial = symmetric_product(mass, modes.vectors) * modes.values.asDiagonal();
  const Eigen::MatrixXd sizes = symmetric_product(stiffness.cwiseAbs(), modes.vectors.cwiseAbs());
  Eigen::VectorXd residuals(modes.values.size());
  for (Eigen::Index r = 0; r < residuals.size(); ++r) {
    const double scale = sizes.col(r).norm() + inertial.col(r).norm();
    residuals(r) = scale > 0.0 ? (elastic.col(r) - inertial.col(r)).norm() / scale : 0.0;
  }
  return residuals;
}

/// Where to count: the number of values below a wide gap at or after the first `wanted` of them, or before it where a
/// repeated root continues beyond the known values.
Eigen::Index cut_position(const Eigen::VectorXd& values, Eigen::Index wanted, double shift) {
  constexpr double k_wide = 1e-3;
  constexpr double k_one_root = 1e-6;  // relative distance that the inertia count resolves
  // Against the distance from the shift, by which values are exact: those of rigid-body modes are zero but for
  // rounding.
  const auto gap_before = [&](Eigen::Index i) { return (values(i) - values(i - 1)) / (values(i) - shift); };
  Eigen::Index best = wanted;
  double widest = -1.0;
  for (Eigen::Index i = wanted; i < values.size(); ++i) {
    if (gap_before(i) <= widest) continue;
    widest = gap_before(i);
    best = i;
    if (widest > k_wide) break;  // wide enough; the first one, since higher values are less accurate
  }
  if (wanted == values.size() || widest > k_one_root) return best;
  for (best = wanted - 1; best > 0 && gap_before(best) <= k_one_root; --best) continue;
  return best;
}

using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// Phi' K Phi in extended precision.
LongMatrix projected_stiffness(const SparseMatrix& lower, const Eigen::MatrixXd& vectors) {
  LongMatrix product = LongMatrix::Zero(vectors.cols(), vectors.rows());  // by equation, for one pass over the matrix
  const Eigen::MatrixXd by_row = vectors.transpose();
  for (int j = 0; j < lower.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator entry(lower, j); entry; ++entry) {
      const auto value = static_cast<long double>(entry.value());
      product.col(entry.row()) += value * by_row.col(j).cast<long double>();
      if (entry.row() != j) product.col(j) += value * by_row.col(entry.row()).cast<long double>();
    }
  }
  const LongMatrix result = product * vectors.cast<long double>();
  return 0.5L * (result + result.transpose());
}

/// Modes far below the shift (of a soft suspension) are mixed by the rounding errors of the factor, which scale with
/// the stiffest elements. The space that they span is accurate: Rayleigh-Ritz separates them, in extended precision
/// where terms cancel, which those of the mass do not.
void refine_soft_modes(const SparseMatrix& stiffness, const SparseMatrix& mass, double shift, Eigen::VectorXd& values,
                       Eigen::MatrixXd& vectors) {
  constexpr double k_soft = 100.0;
  const Eigen::Index soft = (values.array() <= k_soft * std::abs(shift)).count();
  if (soft == 0) return;
  const Eigen::MatrixXd basis = vectors.leftCols(soft);
  const Eigen::MatrixXd masses = basis.transpose() * symmetric_product(mass, basis);
  const Eigen::GeneralizedSelfAdjointEigenSolver<LongMatrix> solver(projected_stiffness(stiffness, basis),
                                                                    masses.cast<long double>());
  values.head(soft) = solver.eigenvalues().cast<double>();
  vectors.leftCols(soft) = (basis.cast<long double>() * solver.eigenvectors()).cast<double>();
}

}  // namespace

struct SparseModeSolver::Factors {
  std::unique_ptr<DefiniteFactor> definite = make_definite_factor();
  std::unique_ptr<SymmetricFactor> indefinite;

  std::vector<int> starts, rows;  ///< pattern of which the symbolic factorisations are

  /// Repeats the symbolic factorisation if the pattern has changed: a moved node may fill an entry that was zero.
  void keep_pattern(const SparseMatrix& lower) {
    const Pattern pattern = pattern_of(lower);
    if (pattern == Pattern{starts, rows}) return;
    if (!starts.empty()) {
      definite = make_definite_factor();
      indefinite.reset();
    }
    starts.assign(pattern.starts.begin(), pattern.starts.end());
    rows.assign(pattern.rows.begin(), pattern.rows.end());
  }

  /// Factorises K - s M at the first shift that makes it definite; the shift, or 0 where none does.
  double factorise_below(const SparseMatrix& stiffness, const SparseMatrix& mass) {
    constexpr int k_attempts = 3;
    constexpr double k_farther = 100.0;
    double shift = default_shift(stiffness, mass);
    for (int attempt = 0; attempt < k_attempts; ++attempt, shift *= k_farther) {
      const SparseMatrix matrix = shifted(stiffness, mass, shift);
      keep_pattern(matrix);
      if (definite->factorise(matrix)) return shift;
    }
    return 0.0;
  }

  int count_below(const SparseMatrix& stiffness, const SparseMatrix& mass, double shift) {
    if (indefinite == nullptr) indefinite = make_indefinite_factor();
    return indefinite->factorise(shifted(stiffness, mass, shift)) ? indefinite->negative_eigenvalues() : -1;
  }
};

int count_eigenvalues_below(const SparseMatrix& stiffness, const SparseMatrix& mass, double value) {
  const std::unique_ptr<SymmetricFactor> factor = make_indefinite_factor();
  return factor->factorise(shifted(stiffness, mass, value)) ? factor->negative_eigenvalues() : -1;
}

SparseModeSolver::SparseModeSolver() : factors_(std::make_unique<Factors>()) {}
SparseModeSolver::SparseModeSolver(SparseModeSolver&&) noexcept = default;
SparseModeSolver& SparseModeSolver::operator=(SparseModeSolver&&) noexcept = default;
SparseModeSolver::~SparseModeSolver() = default;

double SparseModeSolver::factorise(const SparseMatrix& stiffness, const SparseMatrix& mass) {
  return factors_->factorise_below(stiffness, mass);
}

bool SparseModeSolver::factorise_stiffness(const SparseMatrix& stiffness) {
  factors_->keep_pattern(stiffness);
  return factors_->definite->factorise(stiffness);
}

DefiniteFactor& SparseModeSolver::factor() {
  return *factors_->definite;
}

SparseModes SparseModeSolver::solve(const SparseMatrix& stiffness, const SparseMatrix& mass,
                                    const SparseModesOptions& options) {
  require(stiffness.rows() == stiffness.cols() && mass.rows() == stiffness.rows() && mass.cols() == stiffness.cols(),
          "stiffness is {} x {}, mass is {} x {}; both must be square and of one size", stiffness.rows(),
          stiffness.cols(), mass.rows(), mass.cols());
  require(options.modes >= 1, "modes: {} asked for, need at least 1", options.modes);
  SparseModes result;
  if (mass.nonZeros() == 0 || mass.coeffs().isZero(0.0)) {
    result.failure =
        "the model has no mass, and so no natural modes; give its materials a density or its points masses";
    return result;
  }
  const RunContext context{.stop = options.stop};
  const auto begin = std::chrono::steady_clock::now();
  result.shift = factors_->factorise_below(stiffness, mass);
  result.factor_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (!options.is_mass_semidefinite) {
    result.negative_mass = find_negative_mass(stiffness, mass, factors_->definite->order());
  }
  if (result.negative_mass) {
    result.failed_row = result.negative_mass->row;
    result.failure = describe(*result.negative_mass, std::to_string(result.failed_row + 1));
    return result;
  }
  if (result.shift == 0.0) {
    result.failure = "the stiffness is not positive semidefinite, or a part can move without stiffness and mass";
    result.failed_row = factors_->definite->failed_column();
    result.is_massless = result.failed_row >= 0 && mass.coeff(result.failed_row, result.failed_row) == 0.0;
    return result;
  }
  const SparseMatrix lean_mass = mass.pruned(0.0, 0.0);
  // Two more than wanted: a gap above the last wanted one is needed for the count.
  const int sought = options.modes + (options.counts_below ? 2 : 0);
  LanczosPairs pairs = largest_pairs(
      {.size = stiffness.rows(),
       .solve =
           [&](Eigen::Ref<Eigen::MatrixXd> vectors) {  // NOLINT(performance-unnecessary-value-param): a Ref is a view
             context.throw_if_stopped();
             factors_->definite->solve(vectors);
           },
       .weigh = [&](const Eigen::Ref<const Eigen::MatrixXd>& vectors) { return symmetric_product(lean_mass, vectors); },
       .sum_of_terms = [&](const Eigen::VectorXd& vector) { return sums_of_terms(lean_mass, vector)(0); }},
      sought, options.tolerance);
  result.basis_vectors = pairs.solved_vectors;
  if (!pairs.is_converged) {
    result.failure =
        fmt::format("the {} lowest modes did not converge in {} solutions", options.modes, pairs.solved_vectors);
    return result;
  }
  Eigen::VectorXd values = pairs.values.cwiseInverse().array() + result.shift;
  Eigen::MatrixXd vectors = std::move(pairs.vectors);
  refine_soft_modes(stiffness, mass, result.shift, values, vectors);
  const Eigen::Index found = std::min<Eigen::Index>(options.modes, values.size());
  result.values = values.head(found);
  result.vectors = vectors.leftCols(found);
  make_largest_component_positive(result.vectors);
  if (options.measures) result.residuals = relative_residuals(stiffness, mass, result);
  if (options.counts_below && found > 0) {
    context.throw_if_stopped();
    const Eigen::Index cut = cut_position(values, found, result.shift);
    const double below = cut > 0 ? values(cut - 1) : result.shift;
    result.counted_at = cut < values.size() ? 0.5 * (below + values(cut)) : below + 1e-3 * (below - result.shift);
    const int counted = factors_->count_below(stiffness, mass, result.counted_at);
    if (counted < 0) result.failure = "the modes below the last one cannot be counted: the factorisation failed";
    // Modes between the last wanted one and the cut are known: taken off again, or added where the cut lies lower.
    result.counted_below = counted < 0 ? -1 : counted - static_cast<int>(cut - found);
  }
  return result;
}

}  // namespace mottle::linalg
