#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <numbers>
#include <optional>

#include "linalg/reduced/form_bounds.hpp"
#include "linalg/reduced/reduced_model_parts.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/process_mutex.hpp"
#include "mottle/core/random.hpp"

namespace mottle::linalg {
namespace {

constexpr double k_infinite = std::numeric_limits<double>::infinity();

/// Quantiles of the normal distribution at the midpoints of 4096 equal probabilities, scaled to unit variance: twelve
/// random bits choose one.
const std::vector<double>& normal_quantiles() {
  const NoFork no_fork;
  static const std::vector<double> quantiles = [] {
    constexpr int k_parts = 1 << 12;
    std::vector<double> result(k_parts);
    double squares = 0.0;
    double x = -4.0;
    for (int i = 0; i < k_parts / 2; ++i) {
      const double probability = (i + 0.5) / k_parts;
      for (double step = 1.0; std::abs(step) > 1e-12; x -= step) {  // Newton's method, from the quantile before
        const double density = std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
        step = (0.5 * std::erfc(-x / std::numbers::sqrt2) - probability) / density;
      }
      result[static_cast<std::size_t>(i)] = x;
      result[static_cast<std::size_t>(k_parts - 1 - i)] = -x;
      squares += 2.0 * x * x;
    }
    for (double& value : result) value /= std::sqrt(squares / k_parts);
    return result;
  }();
  return quantiles;
}

/// Independent normal deviates.
VectorRows random_normals(Eigen::Index rows, Eigen::Index columns) {
  constexpr Eigen::Index k_in_word = 5;  // of twelve bits
  const std::vector<double>& quantiles = normal_quantiles();
  VectorRows matrix(rows, columns);
  std::vector<RandomStream> streams;
  for (Eigen::Index j = 0; j < columns; ++j) {
    streams.emplace_back(StreamKey{.seed = 0, .purpose = StreamPurpose::residual_sketch},
                         static_cast<std::uint32_t>(j));
  }
  for (Eigen::Index first = 0; first < rows; first += k_in_word) {
    const Eigen::Index count = std::min(k_in_word, rows - first);
    for (Eigen::Index j = 0; j < columns; ++j) {
      std::uint64_t bits = streams[static_cast<std::size_t>(j)].bits();
      for (Eigen::Index i = first; i < first + count; ++i, bits >>= 12) matrix(i, j) = quantiles[bits & 4095];
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

/// Bound p of a term's negative part that k_inertia_tolerance leaves: T >= -p A, since diag(T) <= trace(A^-1 diag(T))
/// A.
///
/// @param flexibility  upper estimate of the diagonal of A^-1
double negative_part(const SparseMatrix& term, const Eigen::VectorXd& flexibility) {
  return 2.0 * k_inertia_tolerance * flexibility.dot(Eigen::VectorXd(term.diagonal()).cwiseAbs());
}

/// See ReducedModel::resolution().
Eigen::MatrixXd resolution_of(const SparseMatrix& stiffness, const Eigen::VectorXd& values,
                              const Eigen::MatrixXd& modes) {
  Eigen::MatrixXd result(values.size(), 2);
  const Eigen::MatrixXd sizes = modes.leftCols(values.size()).cwiseAbs();
  result.col(0) = values;
  result.col(1) = std::numeric_limits<double>::epsilon() *
                  sizes.cwiseProduct(symmetric_product(stiffness.cwiseAbs(), sizes)).colwise().sum().transpose();
  return result;
}

bool is_known(const std::vector<bool>& is_semidefinite, Eigen::Index term) {
  const auto t = static_cast<std::size_t>(term);
  return t < is_semidefinite.size() && is_semidefinite[t];
}

/// Whether M is known to be semidefinite at these coefficients, the constant's first.
bool is_mass_known(const PencilTerms& terms, const Eigen::VectorXd& coefficients) {
  for (Eigen::Index t = 0; t < coefficients.size(); ++t) {
    if (!(coefficients(t) >= 0.0 && is_known(terms.is_mass_semidefinite, t))) return false;
  }
  return true;
}

}  // namespace

FullPencils::FullPencils(const PencilTerms& terms, const TermCoefficients& nominal, const SparseMatrix& nominal_k,
                         const SparseMatrix& nominal_m, const ReducedModelOptions& options)
    : nominal_stiffness((check(terms, nominal), with_constant(nominal.stiffness.col(0)))),
      nominal_mass(with_constant(nominal.mass.col(0))) {
  constexpr int k_more_modes = 4;  // raise the bound for modes orthogonal to the basis, see ReferencePencil
  // The modes need not be exact: they are the first vectors of the basis only.
  const std::clock_t begin = std::clock();
  SparseModes found = solver_.solve(nominal_k, nominal_m,
                                    {.modes = options.modes + k_guard_modes + k_more_modes,
                                     .tolerance = 1e-3,
                                     .measures = false,
                                     .is_mass_semidefinite = is_mass_known(terms, nominal_mass)});
  exact_seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  require(found.failure.empty() && found.values.size() > 0, "the nominal model has no modes: {}", found.failure);
  shift = found.shift;
  highest_mode = found.values(found.values.size() - 1);
  modes = std::move(found.vectors);
  resolution = resolution_of(nominal_k, found.values.head(std::min<Eigen::Index>(options.modes, modes.cols())), modes);
  // Upper bound of the shifted mass' fraction of A: Ritz values of this tolerance are exact to its square.
  constexpr double k_above_exact = 1.01;
  mass_fraction = std::min(1.0, k_above_exact * std::abs(shift) / (found.values(0) - shift));
  set_terms(terms, nominal_k, nominal_m);
  std::call_once(is_ready_, [this] { make_sketch(); });
  const Eigen::VectorXd flexibility = sketch_.rowwise().squaredNorm() * (k_sketch_reserve / k_sketch_rows);
  bound_stiffness(terms, flexibility);
  bound_mass(terms, flexibility);
}

FullPencils::FullPencils(const PencilTerms& terms, const TermCoefficients& nominal, const SparseMatrix& nominal_k,
                         const SparseMatrix& nominal_m, NominalFacts facts)
    : NominalFacts(std::move(facts)),
      nominal_stiffness((check(terms, nominal), with_constant(nominal.stiffness.col(0)))),
      nominal_mass(with_constant(nominal.mass.col(0))),
      nominal_k_(nominal_k),
      nominal_m_(nominal_m) {
  set_terms(terms, nominal_k, nominal_m);
}

void FullPencils::set_terms(const PencilTerms& terms, const SparseMatrix& nominal_k, const SparseMatrix& nominal_m) {
  shifted = nominal_k - shift * nominal_m;
  shifted.makeCompressed();
  stiffness = terms_of(terms.stiffness_constant, terms.stiffness);
  mass = terms_of(terms.mass_constant, terms.mass);
}

void FullPencils::make_sketch() {
  sketch_ = random_normals(shifted.rows(), k_sketch_rows);
  solver_.factor().solve_root(sketch_);
}

void FullPencils::make_factor() {
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
  make_factor();
  return solver_.factor();
}

const VectorRows& FullPencils::sketch() {
  make_factor();
  return sketch_;
}

SparseMatrix FullPencils::sum(const std::vector<SupportedMatrix>& terms, const Eigen::VectorXd& coefficients) const {
  SparseMatrix result = shifted;
  result.coeffs().setZero();
  for (std::size_t t = 0; t < terms.size(); ++t) terms[t].add_to(result, coefficients(static_cast<Eigen::Index>(t)));
  return result;
}

void FullPencils::bound_stiffness(const PencilTerms& terms, const Eigen::VectorXd& flexibility) {
  constexpr double k_negligible = 1e-3;  // of A
  const std::vector<int> order = solver_.factor().order();
  stiffness_bounds.resize(nominal_stiffness.size(), 2);
  for (Eigen::Index t = 0; t < nominal_stiffness.size(); ++t) {
    const SparseMatrix& term = t == 0 ? terms.stiffness_constant : terms.stiffness[static_cast<std::size_t>(t - 1)];
    const SupportedMatrix& local = stiffness[static_cast<std::size_t>(t)];
    const double negative = negative_part(term, flexibility);
    if (local.is_empty()) {
      stiffness_bounds.row(t).setZero();
    } else if (nominal_stiffness(t) > 0.0 && negative <= k_negligible &&
               (is_known(terms.is_stiffness_semidefinite, t) || is_semidefinite(local, order))) {
      stiffness_bounds.row(t) << -negative, k_infinite;
    } else {
      const FormBounds bounds = verified_bounds(term, shifted, solver_.factor(), sketch_.col(0));
      stiffness_bounds.row(t) << bounds.lower, bounds.upper;
    }
  }
}

namespace {

/// Whether what k_inertia_tolerance leaves of the terms' negative parts is at most `negligible` of the mass for all
/// motions with y'A y <= highest y'M y: M + A / highest - (4 k_inertia_tolerance / negligible) D is definite, with D
/// the sum of |b_t| |diag(M_t)|.
bool is_above_rounding(const FullPencils& full, const PencilTerms& terms, double highest, double negligible) {
  Eigen::VectorXd diagonal = terms.mass_constant.diagonal().cwiseAbs();
  for (std::size_t t = 0; t < terms.mass.size(); ++t) {
    diagonal += std::abs(full.nominal_mass(static_cast<Eigen::Index>(t) + 1)) * terms.mass[t].diagonal().cwiseAbs();
  }
  SparseMatrix form = full.mass_at(full.nominal_mass) + full.shifted / highest;
  const double multiple = 4.0 * k_inertia_tolerance / negligible;
  for (Eigen::Index i = 0; i < form.rows(); ++i) form.coeffRef(i, i) -= multiple * diagonal(i);
  form.makeCompressed();
  return make_definite_factor()->factorise(form);
}

}  // namespace

void FullPencils::bound_mass(const PencilTerms& terms, const Eigen::VectorXd& flexibility) {
  constexpr double k_negligible = 1e-6;  // of the mass, for the modes that are followed
  mass_bounds = Eigen::MatrixXd::Zero(nominal_mass.size(), 2);
  if (terms.mass.empty()) return;  // M is the same everywhere
  const std::vector<int> order = solver_.factor().order();
  std::optional<bool> are_all_negligible;
  const auto is_negligible = [&](const SparseMatrix& term) {  // for the modes that are followed
    const double highest = highest_mode - shift;
    if (negative_part(term, flexibility) * highest <= k_negligible) return true;
    if (!are_all_negligible) are_all_negligible = is_above_rounding(*this, terms, highest, k_negligible);
    return *are_all_negligible;
  };
  std::unique_ptr<DefiniteFactor> factor;
  SparseMatrix form;
  for (Eigen::Index t = 0; t < nominal_mass.size(); ++t) {
    const SparseMatrix& term = t == 0 ? terms.mass_constant : terms.mass[static_cast<std::size_t>(t - 1)];
    const SupportedMatrix& local = mass[static_cast<std::size_t>(t)];
    if (local.is_empty()) continue;
    if (nominal_mass(t) > 0.0 && is_negligible(term) &&
        (is_known(terms.is_mass_semidefinite, t) || is_semidefinite(local, order))) {
      mass_bounds(t, 1) = k_infinite;
      continue;
    }
    if (factor == nullptr) {
      factor = make_definite_factor();
      form = mass_at(nominal_mass);
      for (Eigen::Index i = 0; i < form.rows(); ++i) {  // massless equations, where terms have nothing either
        if (form.coeff(i, i) == 0.0) form.coeffRef(i, i) = 1.0;
      }
    }
    if (!factor->factorise(form)) {
      mass_bounds.row(t) << -k_infinite, k_infinite;
      continue;
    }
    Eigen::VectorXd start = sketch_.col(0);
    const FormBounds bounds = verified_bounds(term, form, *factor, start);
    mass_bounds.row(t) << bounds.lower, bounds.upper;
  }
}

bool FullPencils::has_indefinite_terms() const {
  const auto is_bounded_above = [](const Eigen::MatrixXd& bounds) {
    return ((bounds.col(1).array() < std::numeric_limits<double>::infinity()) && (bounds.col(1).array() != 0.0))
               .any() ||
           (bounds.col(0).array() == -std::numeric_limits<double>::infinity()).any();
  };
  return is_bounded_above(stiffness_bounds) || is_bounded_above(mass_bounds);
}

}  // namespace mottle::linalg
