#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/core/random.hpp"
#include "reduced_model_parts.hpp"

namespace mottle {
namespace {

/// Entries of +1 and -1 at random.
VectorRows random_signs(Eigen::Index rows, Eigen::Index columns) {
  constexpr Eigen::Index k_bits = 64;
  VectorRows matrix(rows, columns);
  std::vector<RandomStream> streams;
  for (Eigen::Index j = 0; j < columns; ++j) {
    streams.emplace_back(StreamKey{.seed = 0, .purpose = StreamPurpose::residual_sketch},
                         static_cast<std::uint32_t>(j));
  }
  for (Eigen::Index first = 0; first < rows; first += k_bits) {
    const Eigen::Index count = std::min(k_bits, rows - first);
    for (Eigen::Index j = 0; j < columns; ++j) {
      std::uint64_t bits = streams[static_cast<std::size_t>(j)].bits();
      for (Eigen::Index i = first; i < first + count; ++i, bits >>= 1) matrix(i, j) = (bits & 1) != 0 ? 1.0 : -1.0;
    }
  }
  return matrix;
}

std::vector<SupportedMatrix> terms_of(const SparseMatrix& constant, const std::vector<SparseMatrix>& terms) {
  std::vector<SupportedMatrix> result{SupportedMatrix(constant)};
  for (const SparseMatrix& term : terms) result.emplace_back(term);
  return result;
}

void check(const PencilTerms& terms, const TermCoefficients& nominal) {
  const Eigen::Index order = terms.stiffness_constant.rows();
  const auto fits = [&](const SparseMatrix& matrix) { return matrix.rows() == order && matrix.cols() == order; };
  require(order > 0 && fits(terms.stiffness_constant) && fits(terms.mass_constant) &&
              std::all_of(terms.stiffness.begin(), terms.stiffness.end(), fits) &&
              std::all_of(terms.mass.begin(), terms.mass.end(), fits),
          "reduced model: all terms must be square and of one size, {}", order);
  require(nominal.stiffness.rows() == static_cast<Eigen::Index>(terms.stiffness.size()) &&
              nominal.mass.rows() == static_cast<Eigen::Index>(terms.mass.size()) && nominal.samples() == 1 &&
              nominal.mass.cols() == 1,
          "reduced model: the nominal sample needs {} and {} coefficients", terms.stiffness.size(), terms.mass.size());
}

/// The largest |x' K_t x| / x' A x, by a few steps of the block power method.
double largest_ratio(const SupportedMatrix& term, FullPencils& full) {
  constexpr int k_steps = 6;
  constexpr Eigen::Index k_vectors = 4;
  VectorRows block = to_rows(full.sketch().leftCols(k_vectors));
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(block.cols());
  double ratio = 0.0;
  for (int step = 0; step < k_steps; ++step) {
    VectorRows moved = VectorRows::Zero(block.rows(), block.cols());
    term.add_scaled_product(block, ones, moved);
    const VectorRows weighed = product_rows(full.shifted, block);
    VectorRows answer = moved;
    full.factor().solve_rows(answer.leftCols(k_vectors));
    for (Eigen::Index j = 0; j < k_vectors; ++j) {
      const double length = std::sqrt(block.col(j).dot(weighed.col(j)));
      ratio = std::max(ratio, std::sqrt(std::abs(answer.col(j).dot(moved.col(j)))) / length);
      block.col(j) = answer.col(j) / std::max(answer.col(j).norm(), std::numeric_limits<double>::min());
    }
  }
  return ratio;
}

bool is_semidefinite(const SupportedMatrix& term, const VectorRows& probes) {
  const Eigen::VectorXd squares = term.project(probes, term.local_product(probes)).diagonal();
  return squares.minCoeff() >= -1e-10 * squares.cwiseAbs().maxCoeff();
}

}  // namespace

FullPencils::FullPencils(const PencilTerms& terms, const TermCoefficients& nominal, const SparseMatrix& nominal_k,
                         const SparseMatrix& nominal_m, const ReducedModelOptions& options)
    : nominal_stiffness((check(terms, nominal), with_constant(nominal.stiffness.col(0)))),
      nominal_mass(with_constant(nominal.mass.col(0))) {
  constexpr int k_more_modes = 4;  // that keep unseen modes away, see Floor
  constexpr double k_free = 1e3;
  // The modes need not be exact: they only begin the basis.
  const std::clock_t begin = std::clock();
  SparseModes found =
      solver_.solve(nominal_k, nominal_m,
                    {.modes = options.modes + k_guard_modes + k_more_modes, .tolerance = 1e-3, .measures = false});
  exact_seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  require(found.failure.empty() && found.values.size() > 0, "the nominal model has no modes: {}", found.failure);
  shift = found.shift;
  highest_mode = found.values(found.values.size() - 1);
  modes = std::move(found.vectors);
  is_free = found.values(0) < k_free * std::abs(shift);
  take(terms, nominal_k, nominal_m);
  std::call_once(is_ready_, [this] { make_sketch(); });
  constexpr Eigen::Index k_probes = 8;
  const VectorRows probes = sketch_.leftCols(k_probes);
  for (std::size_t t = 0; t < stiffness.size(); ++t) {
    const double coefficient = nominal_stiffness(static_cast<Eigen::Index>(t));
    const bool adds = coefficient >= 0.0 && is_semidefinite(stiffness[t], probes);
    indefinite.push_back(adds ? 0.0 : 1.1 * std::abs(coefficient) * largest_ratio(stiffness[t], *this));
  }
}

FullPencils::FullPencils(const PencilTerms& terms, const TermCoefficients& nominal, const SparseMatrix& nominal_k,
                         const SparseMatrix& nominal_m, NominalFacts facts)
    : NominalFacts(std::move(facts)),
      nominal_stiffness((check(terms, nominal), with_constant(nominal.stiffness.col(0)))),
      nominal_mass(with_constant(nominal.mass.col(0))),
      nominal_k_(nominal_k),
      nominal_m_(nominal_m) {
  take(terms, nominal_k, nominal_m);
}

void FullPencils::take(const PencilTerms& terms, const SparseMatrix& nominal_k, const SparseMatrix& nominal_m) {
  shifted = nominal_k - shift * nominal_m;
  shifted.makeCompressed();
  stiffness = terms_of(terms.stiffness_constant, terms.stiffness);
  mass = terms_of(terms.mass_constant, terms.mass);
}

void FullPencils::make_sketch() {
  sketch_ = random_signs(shifted.rows(), k_sketch_rows);
  solver_.factor().solve_root(sketch_);
}

void FullPencils::catch_up() {
  std::call_once(is_ready_, [this] {
    if (solver_.factorise(nominal_k_, nominal_m_) != shift) {
      throw SystemFailure("the nominal stiffness has another factor than when the reduced model was trained");
    }
    make_sketch();
    nominal_k_ = SparseMatrix();
    nominal_m_ = SparseMatrix();
  });
}

DefiniteFactor& FullPencils::factor() {
  catch_up();
  return solver_.factor();
}

const VectorRows& FullPencils::sketch() {
  catch_up();
  return sketch_;
}

SparseMatrix FullPencils::sum(const std::vector<SupportedMatrix>& terms, const Eigen::VectorXd& coefficients) const {
  SparseMatrix result = shifted;
  result.coeffs().setZero();
  for (std::size_t t = 0; t < terms.size(); ++t) terms[t].add_to(result, coefficients(static_cast<Eigen::Index>(t)));
  return result;
}

Eigen::VectorXd FullPencils::smallest_ratios(const TermCoefficients& samples) const {
  // K(s) - r K = sum over the semidefinite terms (>= 0) + sum over the others, at least -|a_t(s) / a_t - r| |a_t K_t|.
  Eigen::VectorXd result(samples.samples());
  const auto lowest = [](double ratio, double coefficient, double nominal) {
    if (nominal != 0.0) return std::min(ratio, coefficient / nominal);
    return coefficient >= 0.0 ? ratio : -std::numeric_limits<double>::infinity();
  };
  const auto is_indefinite = [&](Eigen::Index t) { return indefinite[static_cast<std::size_t>(t)] > 0.0; };
  for (Eigen::Index s = 0; s < result.size(); ++s) {
    const bool has_floor = !stiffness[0].is_empty() && !is_indefinite(0);
    double ratio = has_floor ? 1.0 : std::numeric_limits<double>::infinity();
    for (Eigen::Index t = 0; t < samples.stiffness.rows(); ++t) {
      if (!is_indefinite(t + 1)) ratio = lowest(ratio, samples.stiffness(t, s), nominal_stiffness(t + 1));
    }
    for (Eigen::Index t = 0; is_free && t < samples.mass.rows(); ++t) {
      ratio = lowest(ratio, samples.mass(t, s), nominal_mass(t + 1));
    }
    if (std::isinf(ratio)) ratio = ratio > 0.0 ? 1.0 : ratio;
    double lost = 0.0;
    for (Eigen::Index t = 0; t < nominal_stiffness.size(); ++t) {
      if (!is_indefinite(t)) continue;
      const double own = t == 0 ? 1.0 : samples.stiffness(t - 1, s) / nominal_stiffness(t);
      lost += std::abs(own - ratio) * indefinite[static_cast<std::size_t>(t)];
    }
    result(s) = ratio - lost;
  }
  return result;
}

}  // namespace mottle
