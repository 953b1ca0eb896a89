// Samples of which the reduced model is not sure enough: a few block steps with the nominal factor in the full space.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "blas.hpp"
#include "mottle/core/parallel.hpp"
#include "reduced_model_parts.hpp"
#include "vector_signs.hpp"

namespace mottle {
namespace {

constexpr double k_infinite = std::numeric_limits<double>::infinity();

/// Vectors with what one sample's matrices make of them.
struct Images {
  Eigen::MatrixXd vectors, elastic, inertial;  ///< S, K S, M S [equation x vector]

  Images combined(const Eigen::MatrixXd& weights) const {
    return {product(vectors, weights), product(elastic, weights), product(inertial, weights)};
  }
  void append(const Images& more) {
    const auto widen = [](Eigen::MatrixXd& own, const Eigen::MatrixXd& other) {
      own.conservativeResize(Eigen::NoChange, own.cols() + other.cols());
      own.rightCols(other.cols()) = other;
    };
    widen(vectors, more.vectors);
    widen(elastic, more.elastic);
    widen(inertial, more.inertial);
  }
};

/// The lowest `count` Ritz vectors of a space, ascending, x' M x = 1.
Images ritz_vectors(const Images& space, double shift, Eigen::Index count) {
  // K - s M is definite and M need not be: the largest 1 / (lambda - s) are those sought.
  const Eigen::MatrixXd mass = transposed_product(space.vectors, space.inertial);
  const Eigen::MatrixXd gram = transposed_product(space.vectors, space.elastic) - shift * mass;
  const Eigen::MatrixXd basis = orthonormal_combinations(0.5 * (gram + gram.transpose()), gram.diagonal());
  const Eigen::MatrixXd projected = transposed_product(basis, product(0.5 * (mass + mass.transpose()), basis));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(projected);
  const Eigen::Index found = std::min(count, basis.cols());
  const Eigen::VectorXd flexibilities = solver.eigenvalues().tail(found).reverse().cwiseMax(1e-300);
  return space.combined(product(basis, solver.eigenvectors().rightCols(found).rowwise().reverse()) *
                        flexibilities.cwiseSqrt().cwiseInverse().asDiagonal());
}

/// Those of the first `sharp` columns whose squared residual is above `small`, and the largest of all others until a
/// sweep through the factor is full.
std::vector<Eigen::Index> largest_residuals(const Eigen::VectorXd& squares, Eigen::Index sharp, double small) {
  constexpr Eigen::Index k_sweep = 8;
  const auto matters = [&](Eigen::Index k) { return k < sharp && squares(k) > small; };
  std::vector<Eigen::Index> columns(static_cast<std::size_t>(squares.size()));
  std::iota(columns.begin(), columns.end(), Eigen::Index{0});
  std::stable_sort(columns.begin(), columns.end(), [&](Eigen::Index a, Eigen::Index b) {
    return matters(a) != matters(b) ? matters(a) : squares(a) > squares(b);
  });
  const Eigen::Index large = std::count_if(columns.begin(), columns.end(), matters);
  const Eigen::Index taken =
      std::min((std::max<Eigen::Index>(large, 1) + k_sweep - 1) / k_sweep * k_sweep, squares.size());
  columns.resize(static_cast<std::size_t>(taken));
  return columns;
}

/// Rayleigh quotients.
Eigen::VectorXd values_of(const Images& modes) {
  const Eigen::VectorXd elastic = modes.vectors.cwiseProduct(modes.elastic).colwise().sum().transpose();
  const Eigen::VectorXd inertial = modes.vectors.cwiseProduct(modes.inertial).colwise().sum().transpose();
  return elastic.cwiseQuotient(inertial);
}

}  // namespace

/// One sample's matrices and what its certificate needs.
struct SamplePencil {
  const FullPencils& full;
  Eigen::VectorXd stiffness, mass;  ///< coefficients, the constants' first
  double ratio = 0.0;               ///< smallest eigenvalue of its stiffness against the nominal one
  double unseen = 0.0;              ///< no mode that residuals cannot show is below

  Images images(Eigen::MatrixXd vectors) const {
    const VectorRows rows = to_rows(vectors);
    const Eigen::Index count = vectors.cols();
    const auto image = [&](const std::vector<SupportedMatrix>& terms, const Eigen::VectorXd& coefficients) {
      VectorRows products = VectorRows::Zero(rows.rows(), rows.cols());
      add_weighted_products(terms, coefficients.replicate(1, count), rows, products);
      return to_columns(products, count);
    };
    Images result{std::move(vectors), {}, {}};
    result.elastic = image(full.stiffness, stiffness);
    result.inertial = image(full.mass, mass);
    return result;
  }
};

RefinedModes ReducedModel::Parts::refine(const SamplePencil& sample, const Eigen::MatrixXd& start) const {
  constexpr int k_steps = 5;
  constexpr double k_small = 0.25;  // of the tolerance
  const Eigen::Index wanted = options.modes;
  Images space = sample.images(start);
  Images modes = space;
  RefinedModes result;
  for (int step = 0;; ++step) {
    result.values = values_of(modes);
    const Eigen::MatrixXd residuals = modes.elastic - modes.inertial * result.values.asDiagonal();
    const Eigen::MatrixXd gram = sketched_gram(sketched(full->sketch(), residuals)) / sample.ratio;
    result.bounds = bounds(result.values, gram, sample.unseen, wanted);
    if (result.bounds.maxCoeff() <= options.tolerance || step == k_steps) break;
    const Eigen::VectorXd squares = gram.diagonal().array() / (result.values.array() - full->shift);
    if (!squares.allFinite()) break;
    Eigen::MatrixXd answers =
        residuals(Eigen::all, largest_residuals(squares, wanted + k_sharp_guards, k_small * options.tolerance));
    full->factor().solve(answers);
    space.append(sample.images(std::move(answers)));
    Images next = ritz_vectors(space, full->shift, start.cols());
    if (next.vectors.cols() < start.cols()) break;
    modes = std::move(next);
  }
  result.values = result.values.head(wanted).eval();
  result.vectors = modes.vectors.leftCols(wanted);
  make_largest_component_positive(result.vectors);
  return result;
}

void ReducedModel::refine(const TermCoefficients& samples, int threads, const RefinedVisitor& visit) const {
  const Parts& parts = *parts_;
  const Parts::Solution begin = parts.solve(samples, threads);
  const Eigen::VectorXd ratios = parts.full->smallest_ratios(samples);
  const Eigen::VectorXd unseen = parts.unseen_above(samples);
  const Eigen::Index vectors = parts.basis.cols();
  const Eigen::Index modes = begin.values.rows();
  const Eigen::Index wanted = std::min<Eigen::Index>(parts.options.modes, modes);
  parallel_for(samples.samples(), 1, threads, [&](std::int64_t first, std::int64_t last) {
    for (Eigen::Index s = first; s < last; ++s) {
      // Without any bound the reduced model may miss a mode, and so would steps that begin with its modes.
      if (modes < parts.options.modes || !(begin.bounds.col(s).head(wanted).maxCoeff() < k_infinite)) {
        visit(s, {begin.values.col(s).head(wanted), {}, Eigen::VectorXd::Constant(wanted, k_infinite)});
        continue;
      }
      const SamplePencil pencil{*parts.full, with_constant(samples.stiffness.col(s)),
                                with_constant(samples.mass.col(s)), ratios(s), unseen(s)};
      const Eigen::Map<const Eigen::MatrixXd> coordinates(begin.vectors.col(s).data(), vectors, modes);
      visit(s, parts.refine(pencil, product(parts.basis, coordinates)));
    }
  });
}

}  // namespace mottle
