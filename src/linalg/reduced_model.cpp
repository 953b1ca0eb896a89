#include "mottle/linalg/reduced_model.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "blas.hpp"
#include "certificate.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/parallel.hpp"
#include "mottle/linalg/batch_eigen.hpp"
#include "reduced_model_parts.hpp"

namespace mottle {
namespace {

constexpr Eigen::Index k_batch = 1024;  // samples whose vectors are held at once: few, so that memory is used again
constexpr Eigen::Index k_grain = 32;

/// The terms side by side, [entries x term].
Eigen::MatrixXd flattened(const std::vector<Eigen::MatrixXd>& terms) {
  Eigen::MatrixXd flat(terms[0].size(), static_cast<Eigen::Index>(terms.size()));
  for (std::size_t t = 0; t < terms.size(); ++t) flat.col(static_cast<Eigen::Index>(t)) = terms[t].reshaped();
  return flat;
}

PencilFamily family_of(const std::vector<Eigen::MatrixXd>& stiffness, const std::vector<Eigen::MatrixXd>& mass) {
  return {stiffness[0], {stiffness.begin() + 1, stiffness.end()}, mass[0], {mass.begin() + 1, mass.end()}};
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

Eigen::MatrixXd orthonormal_combinations(const Eigen::MatrixXd& gram, const Eigen::VectorXd& before) {
  constexpr double k_least = 1e-10;
  const Eigen::VectorXd scales = (gram.diagonal().array() > k_least * before.array())
                                     .select(gram.diagonal().cwiseAbs().cwiseSqrt().cwiseInverse(), 0.0);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scales.asDiagonal() * gram * scales.asDiagonal());
  const Eigen::VectorXd& parts = solver.eigenvalues();
  const Eigen::Index kept = (parts.array() > k_least * parts.maxCoeff()).count();
  return scales.asDiagonal() * solver.eigenvectors().rightCols(kept) *
         parts.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
}

Eigen::Index ReducedModel::Parts::solved_modes() const {
  return std::min<Eigen::Index>(options.modes + k_guard_modes, basis.cols());
}

void ReducedModel::Parts::append(Eigen::MatrixXd block, const Eigen::MatrixXd& weighed, int threads) {
  // A residual is orthogonal to the basis already, so A block hardly changes by taking the basis out of the block.
  const Eigen::VectorXd before = block.cwiseProduct(weighed).colwise().sum().transpose();
  if (basis.cols() > 0) multiply(-1.0, basis, false, transposed_product(basis, weighed), 1.0, block);
  const Eigen::MatrixXd gram = transposed_product(block, weighed);
  const Eigen::MatrixXd combinations = orthonormal_combinations(0.5 * (gram + gram.transpose()), before);
  const Eigen::Index added = combinations.cols();
  basis.conservativeResize(block.rows(), basis.cols() + added);
  multiply(1.0, block, false, combinations, 0.0, basis.rightCols(added));
  project_last(added, threads);
  polish_last(added);
  const Eigen::Index known = floor_modes.rows();
  floor_modes.conservativeResize(basis.cols(), Eigen::NoChange);
  floor_modes.bottomRows(basis.cols() - known).setZero();
}

void ReducedModel::Parts::project_last(Eigen::Index added, int threads) {
  const Eigen::Index size = basis.cols();
  const VectorRows block = to_rows(basis.rightCols(added));
  const auto extend = [&](const SupportedMatrix& term, Eigen::MatrixXd& projected, Eigen::MatrixXd& sketched) {
    const VectorRows image = term.local_product(block);
    const Eigen::MatrixXd columns = term.project(basis, image, added);
    projected.conservativeResize(size, size);
    projected.rightCols(added) = columns;
    projected.bottomRows(added) = columns.transpose();
    projected.bottomRightCorner(added, added) =
        0.5 * (columns.bottomRows(added) + columns.bottomRows(added).transpose());
    sketched.conservativeResize(k_sketch_rows, size);
    sketched.rightCols(added) = term.project(full->sketch(), image, added);
  };
  const std::size_t elastic = stiffness.size();
  parallel_for(static_cast<std::int64_t>(elastic + mass.size()), 1, threads, [&](std::int64_t begin, std::int64_t end) {
    for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
      if (t < elastic) {
        extend(full->stiffness[t], stiffness[t], stiffness_sketch[t]);
      } else {
        extend(full->mass[t - elastic], mass[t - elastic], mass_sketch[t - elastic]);
      }
    }
  });
}

void ReducedModel::Parts::polish_last(Eigen::Index added) {
  const Eigen::Index before = basis.cols() - added;
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(basis.cols(), added);  // V' A V, last columns
  for (std::size_t t = 0; t < stiffness.size(); ++t) {
    gram += full->nominal_stiffness(static_cast<Eigen::Index>(t)) * stiffness[t].rightCols(added);
  }
  for (std::size_t t = 0; t < mass.size(); ++t) {
    gram -= full->shift * full->nominal_mass(static_cast<Eigen::Index>(t)) * mass[t].rightCols(added);
  }
  const Eigen::MatrixXd inside = gram.topRows(before);
  const Eigen::MatrixXd rest = gram.bottomRows(added) - inside.transpose() * inside;
  const Eigen::LLT<Eigen::MatrixXd> factor(rest);
  Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(basis.cols(), added);
  turn.bottomRows(added) = factor.matrixU().solve(Eigen::MatrixXd::Identity(added, added));
  turn.topRows(before) = -inside * turn.bottomRows(added);
  basis.rightCols(added) = product(basis, turn);
  const auto polish = [&](Eigen::MatrixXd& projected, Eigen::MatrixXd& sketched) {
    const Eigen::MatrixXd columns = product(projected, turn);
    const Eigen::MatrixXd corner = transposed_product(turn, columns);
    projected.topRightCorner(before, added) = columns.topRows(before);
    projected.bottomLeftCorner(added, before) = columns.topRows(before).transpose();
    projected.bottomRightCorner(added, added) = 0.5 * (corner + corner.transpose());
    sketched.rightCols(added) = product(sketched, turn);
  };
  for (std::size_t t = 0; t < stiffness.size(); ++t) polish(stiffness[t], stiffness_sketch[t]);
  for (std::size_t t = 0; t < mass.size(); ++t) polish(mass[t], mass_sketch[t]);
}

void ReducedModel::Parts::rotate(const Eigen::MatrixXd& q) {
  constexpr Eigen::Index k_rows = 4096;  // at a time: a large basis is not held twice
  for (Eigen::Index first = 0; first < basis.rows(); first += k_rows) {
    const Eigen::Index count = std::min(k_rows, basis.rows() - first);
    basis.block(first, 0, count, q.cols()) = product(basis.middleRows(first, count), q);
  }
  basis.conservativeResize(Eigen::NoChange, q.cols());
  floor_modes = transposed_product(q, floor_modes);
  for (auto* terms : {&stiffness, &mass}) {
    for (Eigen::MatrixXd& term : *terms) {
      const Eigen::MatrixXd turned = transposed_product(q, product(term, q));
      term = 0.5 * (turned + turned.transpose());
    }
  }
  for (auto* terms : {&stiffness_sketch, &mass_sketch}) {
    for (Eigen::MatrixXd& term : *terms) term = product(term, q);
  }
}

Eigen::MatrixXd sketched_gram(const Eigen::MatrixXd& sketched) {
  constexpr double k_reserve = 3.0;  // a sketch of 64 rows shows less than a third of a square once in 1e7
  return transposed_product(sketched, sketched) * (k_reserve / static_cast<double>(k_sketch_rows));
}

Eigen::VectorXd ReducedModel::Parts::bounds(const Eigen::Ref<const Eigen::VectorXd>& lambda,
                                            const Eigen::MatrixXd& gram, double unseen, Eigen::Index wanted) const {
  const Eigen::VectorXd mu = lambda.array() - full->shift;
  const auto values = lambda.head(wanted).array();
  Eigen::ArrayXd errors = error_bounds(mu, gram, wanted);
  errors = (values < unseen).select(errors, std::numeric_limits<double>::infinity());
  // Of lambda instead of mu; modes near the shift are those of a body that moves as one.
  return errors * mu.head(wanted).array() / values.max(std::abs(full->shift));
}

ReducedModel::Parts::Solution ReducedModel::Parts::solve(const TermCoefficients& samples, bool keeps_residuals,
                                                         int threads) const {
  const Eigen::Index modes = solved_modes();
  const Eigen::Index wanted = std::min<Eigen::Index>(options.modes + k_sharp_guards, modes);
  const Eigen::Index vectors = basis.cols();
  const BatchModes found = solve_batch(family_of(stiffness, mass), samples.stiffness, samples.mass,
                                       {.modes = static_cast<int>(modes), .vectors = true, .threads = threads});
  Solution result{found.values,
                  found.vectors,
                  Eigen::MatrixXd::Constant(wanted, samples.samples(), std::numeric_limits<double>::infinity()),
                  {}};
  if (keeps_residuals) result.residuals.setZero(k_sketch_rows, modes * samples.samples());
  const Eigen::VectorXd ratios = full->smallest_ratios(samples);
  const Eigen::VectorXd unseen = unseen_above(samples);
  const Eigen::MatrixXd stiffness_terms = flattened(stiffness_sketch);
  const Eigen::MatrixXd mass_terms = flattened(mass_sketch);
  parallel_for(samples.samples(), k_grain, threads, [&](std::int64_t begin, std::int64_t end) {
    const Eigen::Index count = end - begin;
    const Eigen::MatrixXd elastic = combined(stiffness_terms, samples.stiffness, begin, count);
    const Eigen::MatrixXd inertial = combined(mass_terms, samples.mass, begin, count);
    Eigen::MatrixXd residuals(k_sketch_rows, modes);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index s = begin + i;
      if (found.failed[static_cast<std::size_t>(s)] != 0 || !(ratios(s) > 0.0)) continue;
      const auto y = found.sample_vectors(s);
      const auto lambda = found.values.col(s);
      multiply(1.0, elastic.col(std::min(i, elastic.cols() - 1)).reshaped(k_sketch_rows, vectors), false, y, 0.0,
               residuals);
      multiply(-1.0, inertial.col(std::min(i, inertial.cols() - 1)).reshaped(k_sketch_rows, vectors), false,
               y * lambda.asDiagonal(), 1.0, residuals);
      const Eigen::VectorXd mu = lambda.array() - full->shift;
      if (!(mu(0) > 0.0)) continue;
      result.bounds.col(s) = bounds(lambda, sketched_gram(residuals) / ratios(s), unseen(s), wanted);
      if (keeps_residuals) {
        result.residuals.middleCols(s * modes, modes) =
            residuals * (k_sketch_rows * ratios(s) * mu).cwiseSqrt().cwiseInverse().asDiagonal();
      }
    }
  });
  return result;
}

ReducedModel::ReducedModel(const PencilTerms& terms, const TermCoefficients& nominal, const SparseMatrix& stiffness,
                           const SparseMatrix& mass, const ReducedModelOptions& options)
    : parts_(std::make_unique<Parts>()) {
  require(options.modes >= 1, "modes: {} asked for, need at least 1", options.modes);
  parts_->options = options;
  parts_->full = std::make_shared<FullPencils>(terms, nominal, stiffness, mass, options);
  parts_->stiffness.resize(terms.stiffness.size() + 1);
  parts_->mass.resize(terms.mass.size() + 1);
  parts_->stiffness_sketch.resize(terms.stiffness.size() + 1);
  parts_->mass_sketch.resize(terms.mass.size() + 1);
  const FullPencils& full = *parts_->full;
  const Eigen::MatrixXd modes = std::move(parts_->full->modes);  // the basis holds them from here on
  parts_->add_floor({full.nominal_stiffness, full.nominal_mass, full.highest_mode}, modes, 1);
}

ReducedModel::ReducedModel(const ReducedModel& other) : parts_(std::make_unique<Parts>(*other.parts_)) {}
ReducedModel::ReducedModel(ReducedModel&&) noexcept = default;
ReducedModel::~ReducedModel() = default;

CertifiedModes ReducedModel::solve(const TermCoefficients& samples, int threads) const {
  const Eigen::Index wanted = std::min<Eigen::Index>(parts_->options.modes, parts_->solved_modes());
  const Eigen::Index vectors = parts_->basis.cols();
  CertifiedModes result{Eigen::MatrixXd(wanted, samples.samples()),
                        Eigen::MatrixXd(vectors * wanted, samples.samples()),
                        Eigen::MatrixXd(wanted, samples.samples())};
  for (Eigen::Index first = 0; first < samples.samples(); first += k_batch) {
    const Eigen::Index count = std::min(k_batch, samples.samples() - first);
    const Parts::Solution part = parts_->solve(samples.range(first, count), false, threads);
    result.values.middleCols(first, count) = part.values.topRows(wanted);
    result.vectors.middleCols(first, count) = part.vectors.topRows(vectors * wanted);
    result.bounds.middleCols(first, count) = part.bounds.topRows(wanted);
  }
  return result;
}

const Eigen::MatrixXd& ReducedModel::basis() const {
  return parts_->basis;
}

double ReducedModel::exact_seconds() const {
  return parts_->full->exact_seconds;
}

}  // namespace mottle
