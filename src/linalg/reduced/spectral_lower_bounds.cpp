// Lower bounds of the spectrum for modes that are orthogonal to the basis, from reference pencils.
#include <algorithm>
#include <functional>
#include <limits>

#include "linalg/reduced/form_bounds.hpp"
#include "linalg/reduced/reduced_model_parts.hpp"
#include "mottle/linalg/dense/products.hpp"

namespace mottle::linalg {
namespace {

constexpr double k_infinite = std::numeric_limits<double>::infinity();
constexpr double k_level = 0.99;  // reference modes are exact to 1e-3 at worst, their eigenvalues to its square

/// Smallest or largest of value / reference over the terms that are there; the constant's is 1.
template <typename Compare>
double extreme_ratio(const std::vector<SupportedMatrix>& terms, const Eigen::VectorXd& reference,
                     const Eigen::Ref<const Eigen::VectorXd>& values, double start, Compare is_worse) {
  double ratio = start;
  for (std::size_t t = 0; t < terms.size(); ++t) {
    if (terms[t].is_empty()) continue;
    const auto k = static_cast<Eigen::Index>(t);
    const double own = t == 0 ? 1.0 : values(k - 1) / reference(k);
    if (is_worse(own, ratio) || own != own) ratio = own;
  }
  return ratio;
}

/// What the negative parts of terms may take away, in multiples of the form that their bounds refer to: the sum of
/// change_t max(-l_t, 0), changes not negative.
double negative_part(const Eigen::VectorXd& changes, const Eigen::MatrixXd& bounds) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < changes.size(); ++t) {
    if (bounds(t, 0) < 0.0 && changes(t) > 0.0) sum -= changes(t) * bounds(t, 0);
  }
  return sum;
}

/// A bound of M(s) against M for each sample.
Eigen::VectorXd mass_ratios(const FullPencils& pencils, const TermCoefficients& samples, decltype(lower_ratio)& bound) {
  Eigen::VectorXd result = Eigen::VectorXd::Ones(samples.samples());
  if (samples.mass.rows() == 0) return result;
  Eigen::VectorXd values = pencils.nominal_mass;
  for (Eigen::Index s = 0; s < result.size(); ++s) {
    values.tail(samples.mass.rows()) = samples.mass.col(s);
    result(s) = bound(values, pencils.nominal_mass, pencils.mass_bounds);
  }
  return result;
}

}  // namespace

Eigen::VectorXd FullPencils::mass_upper_ratios(const TermCoefficients& samples) const {
  return mass_ratios(*this, samples, upper_ratio);
}

Eigen::VectorXd FullPencils::mass_lower_ratios(const TermCoefficients& samples) const {
  return mass_ratios(*this, samples, lower_ratio);
}

Eigen::VectorXd FullPencils::stiffness_lower_ratios(const TermCoefficients& samples) const {
  // The shifted mass is one term more: between zero and its share of A, its value a bound of M(s) against M.
  const Eigen::Index terms = nominal_stiffness.size();
  Eigen::MatrixXd bounds(terms + 1, 2);
  bounds << stiffness_bounds, 0.0, mass_fraction;
  Eigen::VectorXd reference(terms + 1), values(terms + 1);
  reference << nominal_stiffness, 1.0;
  values = reference;
  const Eigen::VectorXd masses = mass_lower_ratios(samples);
  Eigen::VectorXd result(samples.samples());
  for (Eigen::Index s = 0; s < result.size(); ++s) {
    values.segment(1, terms - 1) = samples.stiffness.col(s);
    values(terms) = masses(s);
    result(s) = lower_ratio(values, reference, bounds);
  }
  return result;
}

double ReducedModel::Parts::reference_bound(const ReferencePencil& reference, const TermCoefficients& sample,
                                            double stiffness_ratio) const {
  const double soft =
      extreme_ratio(full->stiffness, reference.stiffness, sample.stiffness.col(0), k_infinite, std::less<>());
  const double heavy = extreme_ratio(full->mass, reference.mass, sample.mass.col(0), 0.0, std::greater<>());
  if (!(soft > 0.0) || !(heavy > 0.0) || !(stiffness_ratio > 0.0)) return 0.0;
  const Eigen::VectorXd masses = with_constant(sample.mass.col(0));
  const double elastic =
      negative_part(with_constant(sample.stiffness.col(0)) - soft * reference.stiffness, full->stiffness_bounds) /
      stiffness_ratio;
  const double inertial = negative_part(heavy * reference.mass - masses, full->mass_bounds);
  const double mass_ratio = inertial > 0.0 ? lower_ratio(masses, full->nominal_mass, full->mass_bounds) : 1.0;
  if (!(elastic < k_infinite) || !(inertial < mass_ratio)) return 0.0;
  const double bound = soft / heavy * (1.0 - inertial / mass_ratio) * k_level * reference.complete_to;
  return (bound + elastic * full->shift) / (1.0 + elastic);
}

Eigen::VectorXd ReducedModel::Parts::complement_bounds(const TermCoefficients& samples) const {
  const Eigen::VectorXd softest = full->stiffness_lower_ratios(samples);
  const Eigen::VectorXd heaviest = full->mass_upper_ratios(samples);
  Eigen::VectorXd result(samples.samples());
  for (Eigen::Index s = 0; s < result.size(); ++s) {
    const double ratio = heaviest(s) > 0.0 ? std::max(softest(s), 0.0) / heaviest(s) : 0.0;
    result(s) = ratio * (k_level * reference_pencils[0].complete_to - full->shift) + full->shift;
    for (std::size_t f = 1; f < reference_pencils.size(); ++f) {
      result(s) = std::max(result(s), reference_bound(reference_pencils[f], samples.range(s, 1), softest(s)));
    }
  }
  return result;
}

void ReducedModel::Parts::add_reference_pencil(ReferencePencil reference, const Eigen::MatrixXd& modes, int threads) {
  const VectorRows block = to_rows(modes);
  const Eigen::MatrixXd weighed = to_columns(product_rows(full->shifted, block), modes.cols());
  append(block, modes.cols(), threads);
  apply_pending();
  const Eigen::Index known = reference_modes.cols();
  reference_modes.conservativeResize(basis.cols(), known + modes.cols());
  reference_modes.rightCols(modes.cols()) = transposed_product(basis, weighed);
  reference_modes.rightCols(modes.cols()).colwise().normalize();
  reference.modes = modes.cols();
  reference_pencils.push_back(std::move(reference));
}

void ReducedModel::Parts::add_reference_below(const TermCoefficients& samples, int threads) {
  constexpr double k_margin = 1.1;       // for samples that lie outside the range of the training samples
  constexpr double k_left_out = 0.0025;  // fraction of the samples that may be left to the exact solution
  const Eigen::VectorXd softest = with_constant(samples.stiffness.rowwise().minCoeff());
  const Eigen::VectorXd heaviest = with_constant(samples.mass.rowwise().maxCoeff());
  if (softest.minCoeff() < 0.0) return;
  const Eigen::Index max_modes = Eigen::Index{4} * options.modes + 16;
  for (Eigen::Index modes = options.modes + 8; modes <= max_modes; modes *= 2) {
    const Solution solution = solve(samples, Purpose::training, threads);
    const Eigen::ArrayXd needed = k_margin * solution.values.row(solution.bounds.rows() - 1).transpose().array();
    const auto unsafe = static_cast<double>((needed >= complement_bounds(samples).array()).count());
    if (unsafe <= k_left_out * static_cast<double>(samples.samples())) return;
    if (basis.cols() + modes > options.max_vectors) return;
    SparseModeSolver solver;
    const SparseModes found = solver.solve(
        full->stiffness_at(softest), full->mass_at(heaviest),
        {.modes = static_cast<int>(modes),
         .tolerance = 1e-4,
         .measures = false,
         .is_mass_semidefinite = heaviest.minCoeff() >= 0.0 && full->mass_bounds.col(0).minCoeff() >= 0.0});
    if (!found.failure.empty() || found.values.size() == 0) return;
    add_reference_pencil({softest, heaviest, found.values(found.values.size() - 1)}, found.vectors, threads);
  }
}

}  // namespace mottle::linalg
