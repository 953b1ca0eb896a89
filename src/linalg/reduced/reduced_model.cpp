#include "mottle/linalg/reduced/reduced_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/reduced/batched_davidson.hpp"
#include "linalg/reduced/certificate.hpp"
#include "linalg/reduced/reduced_model_parts.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/parallel.hpp"
#include "mottle/linalg/batched/batch_eigen.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/linalg/dense/products.hpp"

namespace mottle::linalg {
namespace {

constexpr Eigen::Index k_batch = 1024;  // samples whose vectors are held at once: few, so that memory is reused
constexpr Eigen::Index k_grain = 32;
constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

/// The terms side by side, [entries x term].
Eigen::MatrixXd flattened(const std::vector<Eigen::MatrixXd>& terms) {
  Eigen::MatrixXd flat(terms[0].size(), static_cast<Eigen::Index>(terms.size()));
  for (std::size_t t = 0; t < terms.size(); ++t) flat.col(static_cast<Eigen::Index>(t)) = terms[t].reshaped();
  return flat;
}

/// The pencils (-M, K - shift M).
PencilFamily inverse_family(const std::vector<Eigen::MatrixXd>& stiffness, const std::vector<Eigen::MatrixXd>& mass,
                            double shift) {
  PencilFamily family{.stiffness_constant = -mass[0],
                      .stiffness_terms = {},
                      .mass_constant = stiffness[0] - shift * mass[0],
                      .mass_terms = {stiffness.begin() + 1, stiffness.end()}};
  for (std::size_t t = 1; t < mass.size(); ++t) {
    family.stiffness_terms.emplace_back(-mass[t]);
    family.mass_terms.emplace_back(-shift * mass[t]);
  }
  return family;
}

/// The terms at some samples [entries x sample]; one column for all where only the constant is there.
Eigen::MatrixXd combined(const Eigen::MatrixXd& terms, const Eigen::MatrixXd& coefficients, Eigen::Index begin,
                         Eigen::Index count) {
  if (coefficients.rows() == 0) return terms;
  Eigen::MatrixXd with_constant(coefficients.rows() + 1, count);
  with_constant.row(0).setOnes();
  with_constant.bottomRows(coefficients.rows()) = coefficients.middleCols(begin, count);
  return product(terms, with_constant);
}

}  // namespace

Eigen::Index ReducedModel::Parts::solved_modes() const {
  return std::min<Eigen::Index>(options.modes + k_guard_modes, vectors());
}

Eigen::Index ReducedModel::Parts::converged_modes() const {
  return std::min<Eigen::Index>(options.modes + k_converged_guards, solved_modes());
}

Eigen::VectorXd sketched_squares(const Eigen::Ref<const Eigen::MatrixXd>& sketched) {
  return sketched.colwise().squaredNorm().transpose() * (k_sketch_reserve / k_sketch_rows);
}

Eigen::VectorXd ReducedModel::Parts::bounds(const Eigen::Ref<const Eigen::VectorXd>& lambda,
                                            const Eigen::VectorXd& squares, double complement_bound,
                                            Eigen::Index wanted, double enough) const {
  const Eigen::VectorXd mu = lambda.array() - full->shift;
  const Eigen::ArrayXd relative = mu.head(wanted).array() / sizes(lambda.head(wanted));
  return relative * error_bounds(mu, squares.cwiseQuotient(mu), complement_bound - full->shift, wanted,
                                 enough * options.tolerance / relative.maxCoeff())
                        .array();
}

double ReducedModel::Parts::smallest_size() const {
  constexpr double k_resolved = 1e-8;  // a frequency 10^-4 of the highest: rounding errors are larger than tolerances
  return k_resolved * std::max(full->highest_mode, std::abs(full->shift));
}

Eigen::ArrayXd ReducedModel::Parts::sizes(const Eigen::Ref<const Eigen::VectorXd>& lambda) const {
  return lambda.array().max(smallest_size());
}

Eigen::MatrixXd ReducedModel::Parts::sketched_residuals(const TermCoefficients& samples, const BatchModes& found,
                                                        int threads) const {
  const Eigen::Index modes = found.values.rows(), rows = vectors();
  Eigen::MatrixXd result(k_sketch_rows, modes * samples.samples());
  const Eigen::MatrixXd stiffness_terms = flattened(stiffness_sketch);
  const Eigen::MatrixXd mass_terms = flattened(mass_sketch);
  parallel_for(samples.samples(), k_grain, threads, [&](std::int64_t begin, std::int64_t end) {
    const Eigen::Index count = end - begin;
    const Eigen::MatrixXd elastic = combined(stiffness_terms, samples.stiffness, begin, count);
    const Eigen::MatrixXd inertial = combined(mass_terms, samples.mass, begin, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index s = begin + i;
      const auto y = found.sample_vectors(s);
      const auto residuals = result.middleCols(s * modes, modes);
      multiply(1.0, elastic.col(std::min(i, elastic.cols() - 1)).reshaped(k_sketch_rows, rows), false, y, 0.0,
               residuals);
      multiply(-1.0, inertial.col(std::min(i, inertial.cols() - 1)).reshaped(k_sketch_rows, rows), false,
               y * found.values.col(s).asDiagonal(), 1.0, residuals);
    }
  });
  return result;
}

void ReducedModel::Parts::solve_soft_modes(const TermCoefficients& samples, int threads, BatchModes& found) const {
  constexpr double k_soft = 100.0;
  constexpr Eigen::Index k_together = 8;  // samples whose matrices are summed at once
  const auto count_soft = [&](Eigen::Index s) {
    const bool is_solved = found.failed[static_cast<std::size_t>(s)] == 0;
    return is_solved ? (found.values.col(s).array() <= k_soft * std::abs(full->shift)).count() : 0;
  };
  const Eigen::MatrixXd stiffness_terms = flattened(stiffness), mass_terms = flattened(mass);
  const Eigen::Index rows = vectors();
  parallel_for(samples.samples(), k_together, threads, [&](std::int64_t begin, std::int64_t end) {
    Eigen::Index most = 0;
    for (Eigen::Index s = begin; s < end; ++s) most = std::max(most, count_soft(s));
    if (most == 0) return;
    const Eigen::MatrixXd stiffnesses = combined(stiffness_terms, samples.stiffness, begin, end - begin);
    const Eigen::MatrixXd masses = combined(mass_terms, samples.mass, begin, end - begin);
    for (Eigen::Index s = begin; s < end; ++s) {
      const Eigen::Index soft = count_soft(s);
      if (soft == 0) continue;
      const Eigen::MatrixXd y = found.sample_vectors(s).leftCols(soft);
      const auto form = [&](const Eigen::MatrixXd& matrices) {
        const Eigen::Index column = std::min<Eigen::Index>(s - begin, matrices.cols() - 1);
        return transposed_product(y, product(matrices.col(column).reshaped(rows, rows), y));
      };
      const CholeskyFactor inertial(form(masses));
      const Eigen::MatrixXd half = inertial.solve_lower(form(stiffnesses));
      const SymmetricEigen solver(inertial.solve_lower(half.transpose()));
      Eigen::MatrixXd weights = solver.eigenvectors();
      inertial.solve_upper_in_place(weights);
      found.values.col(s).head(soft) = solver.eigenvalues();
      found.vectors.col(s).head(rows * soft) = product(y, weights).reshaped();
    }
  });
}

const BatchedDavidson& ReducedModel::Parts::batched_davidson() const {
  std::call_once(prepared->is_made, [&] {
    const Eigen::Index modes = solved_modes();
    prepared->modes =
        std::make_unique<BatchedDavidson>(DavidsonPencils{stiffness, mass, full->nominal_stiffness, full->nominal_mass,
                                                          full->shift, smallest_size(), stiffness_sketch, mass_sketch},
                                          DavidsonOptions{.modes = modes, .converged = converged_modes()});
  });
  return *prepared->modes;
}

BatchModes ReducedModel::Parts::whole_modes(const TermCoefficients& samples, int threads) const {
  Eigen::MatrixXd coefficients(samples.stiffness.rows() + samples.mass.rows(), samples.samples());
  coefficients << samples.stiffness, samples.mass;
  BatchModes found = solve_batch(inverse_family(stiffness, mass, full->shift), samples.mass, coefficients,
                                 {.modes = static_cast<int>(solved_modes()), .vectors = true, .threads = threads});
  for (Eigen::Index s = 0; s < samples.samples(); ++s) {
    std::uint8_t& failed = found.failed[static_cast<std::size_t>(s)];
    if (failed == 0 && found.values.col(s).maxCoeff() < 0.0) {
      const Eigen::RowVectorXd lengths = (-found.values.col(s)).cwiseSqrt().transpose();  // y'My = 1 / (lambda - shift)
      found.vectors.col(s).reshaped(vectors(), lengths.size()) *= lengths.cwiseInverse().asDiagonal();
      found.values.col(s) = full->shift - found.values.col(s).cwiseInverse().array();
    } else {
      failed = 1;
      found.values.col(s).setConstant(k_nan);
      found.vectors.col(s).setConstant(k_nan);
    }
  }
  return found;
}

SketchedModes ReducedModel::Parts::reduced_modes(const TermCoefficients& samples, const Eigen::VectorXd& ratios,
                                                 double inside, int threads) const {
  const Eigen::Index modes = solved_modes();
  SketchedModes result = batched_davidson().solve(samples, {ratios, full->mass_upper_ratios(samples)},
                                                  inside * options.tolerance, threads);
  std::vector<Eigen::Index> rest;
  for (Eigen::Index s = 0; s < samples.samples(); ++s) {
    if (result.modes.failed[static_cast<std::size_t>(s)] != 0) rest.push_back(s);
  }
  if (rest.empty()) return result;
  const TermCoefficients others{samples.stiffness(Eigen::all, rest), samples.mass(Eigen::all, rest)};
  BatchModes found = whole_modes(others, threads);
  solve_soft_modes(others, threads, found);
  const Eigen::MatrixXd residuals = sketched_residuals(others, found, threads);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const auto from = static_cast<Eigen::Index>(i);
    result.modes.failed[static_cast<std::size_t>(rest[i])] = found.failed[i];
    result.modes.values.col(rest[i]) = found.values.col(from);
    result.modes.vectors.col(rest[i]) = found.vectors.col(from);
    result.residuals.middleCols(rest[i] * modes, modes) = residuals.middleCols(from * modes, modes);
  }
  return result;
}

ReducedModel::Parts::Solution ReducedModel::Parts::solve(const TermCoefficients& samples, Purpose purpose,
                                                         int threads) const {
  constexpr double k_infinite = std::numeric_limits<double>::infinity();
  constexpr double k_inside = 0.05, k_inside_training = 0.002, k_enough = 0.25;  // of the tolerance
  const bool is_training = purpose == Purpose::training;
  const Eigen::Index modes = solved_modes();
  const Eigen::Index wanted = converged_modes();
  const Eigen::VectorXd ratios = full->stiffness_lower_ratios(samples);
  const Eigen::VectorXd masses = full->mass_lower_ratios(samples);  // below zero: M may be indefinite
  SketchedModes found = reduced_modes(samples, ratios, is_training ? k_inside_training : k_inside, threads);
  Solution result{std::move(found.modes.values), std::move(found.modes.vectors),
                  Eigen::MatrixXd::Constant(wanted, samples.samples(), k_infinite), std::move(found.residuals)};
  const Eigen::VectorXd complement_bound =
      is_training ? Eigen::VectorXd::Constant(samples.samples(), k_infinite) : complement_bounds(samples);
  parallel_for(samples.samples(), k_grain, threads, [&](std::int64_t begin, std::int64_t end) {
    for (Eigen::Index s = begin; s < end; ++s) {
      auto residuals = result.residuals.middleCols(s * modes, modes);
      const auto lambda = result.values.col(s);
      const Eigen::VectorXd mu = lambda.array() - full->shift;
      if (found.modes.failed[static_cast<std::size_t>(s)] != 0 || !(ratios(s) > 0.0) || !(masses(s) >= 0.0) ||
          !(mu(0) > 0.0)) {
        residuals.setZero();
        continue;
      }
      result.bounds.col(s) = bounds(lambda, sketched_squares(residuals) / ratios(s), complement_bound(s), wanted,
                                    is_training ? 0.0 : k_enough);
      if (is_training) residuals *= (k_sketch_rows * ratios(s) * mu).cwiseSqrt().cwiseInverse().asDiagonal();
    }
  });
  return result;
}

ReducedModel::ReducedModel(const PencilTerms& terms, const TermCoefficients& nominal, const SparseMatrix& stiffness,
                           const SparseMatrix& mass, const ReducedModelOptions& options)
    : parts_(std::make_unique<Parts>()) {
  require(options.modes >= 1, "modes: {} asked for, need at least 1", options.modes);
  require(options.guards >= 0 && options.guards <= k_guard_modes, "guards: {} asked for, allowed are 0 to {}",
          options.guards, k_guard_modes);
  parts_->options = options;
  parts_->full = std::make_shared<FullPencils>(terms, nominal, stiffness, mass, options);
  parts_->stiffness.resize(terms.stiffness.size() + 1);
  parts_->mass.resize(terms.mass.size() + 1);
  parts_->stiffness_sketch.resize(terms.stiffness.size() + 1);
  parts_->mass_sketch.resize(terms.mass.size() + 1);
  const FullPencils& full = *parts_->full;
  const Eigen::MatrixXd modes = std::move(parts_->full->modes);  // the basis holds them from here on
  parts_->add_reference_pencil({full.nominal_stiffness, full.nominal_mass, full.highest_mode}, modes, 1);
}

ReducedModel::ReducedModel(const ReducedModel& other) : parts_(std::make_unique<Parts>(*other.parts_)) {}
ReducedModel::ReducedModel(ReducedModel&&) noexcept = default;
ReducedModel::~ReducedModel() = default;

CertifiedModes ReducedModel::Parts::certified(const TermCoefficients& samples, int threads) const {
  const Eigen::Index wanted = wanted_modes(), given = given_modes();
  CertifiedModes result{Eigen::MatrixXd(given, samples.samples()),
                        Eigen::MatrixXd(vectors() * given, samples.samples()),
                        Eigen::MatrixXd(wanted, samples.samples())};
  for (Eigen::Index first = 0; first < samples.samples(); first += k_batch) {
    const Eigen::Index count = std::min(k_batch, samples.samples() - first);
    const Solution part = solve(samples.range(first, count), Purpose::results, threads);
    result.values.middleCols(first, count) = part.values.topRows(given);
    result.vectors.middleCols(first, count) = part.vectors.topRows(vectors() * given);
    result.bounds.middleCols(first, count) = part.bounds.topRows(wanted);
  }
  return result;
}

CertifiedModes ReducedModel::solve(const TermCoefficients& samples, int threads) const {
  return parts_->certified(samples, threads);
}

CertifiedModes ReducedModel::solve_leading(const TermCoefficients& samples, int threads) const {
  require(parts_->leading != nullptr, "the reduced model has no leading directions");
  return parts_->leading->certified(samples, threads);
}

const Eigen::MatrixXd& ReducedModel::leading_directions() const {
  return parts_->leading_directions;
}

const Eigen::MatrixXd& ReducedModel::basis() const {
  return parts_->basis;
}

bool ReducedModel::has_indefinite_terms() const {
  return parts_->full->has_indefinite_terms();
}

const Eigen::MatrixXd& ReducedModel::resolution() const {
  return parts_->full->resolution;
}

double ReducedModel::exact_seconds() const {
  return parts_->full->exact_seconds;
}

}  // namespace mottle::linalg
