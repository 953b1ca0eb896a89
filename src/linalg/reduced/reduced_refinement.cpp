// Refinement of samples that the reduced model does not certify: a few block steps with the nominal factor in all
// equations.
#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "linalg/reduced/reduced_model_parts.hpp"
#include "linalg/vector_signs.hpp"
#include "mottle/core/parallel.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/linalg/dense/products.hpp"

namespace mottle::linalg {
namespace {

constexpr double k_infinite = std::numeric_limits<double>::infinity();

/// One sample's matrices and the constants of its error bounds.
struct SamplePencil {
  FullPencils& full;
  Eigen::VectorXd stiffness, mass;  ///< coefficients, the constants' first
  double ratio = 0.0;               ///< smallest eigenvalue of its stiffness against the nominal one
  double complement_bound = 0.0;    ///< lower bound of lambda for modes orthogonal to the basis
};

/// A space S that grows by blocks of vectors, with the projections and sketches that Rayleigh-Ritz and the error bounds
/// need: the cost for each combination of its vectors does not depend on the number of equations.
class GrowingSpace {
 public:
  explicit GrowingSpace(const SamplePencil& sample) : sample_(sample) {}

  /// @param vectors  padded; the first `count` are used
  void append(VectorRows vectors, Eigen::Index count) {
    Block& block = blocks_.emplace_back(Block{std::move(vectors), {}, {}, count});
    block.elastic = image(sample_.full.stiffness, sample_.stiffness, block.vectors);
    block.inertial = image(sample_.full.mass, sample_.mass, block.vectors);
    widen(elastic_sketch, product_of_rows(sample_.full.sketch(), block.elastic).leftCols(count));
    widen(inertial_sketch, product_of_rows(sample_.full.sketch(), block.inertial).leftCols(count));
    extend(elastic, &Block::elastic);
    extend(inertial, &Block::inertial);
  }

  /// (K - lambda M) S weights of some combinations, padded.
  VectorRows residuals(const Eigen::MatrixXd& weights, const Eigen::VectorXd& values) const {
    VectorRows result = VectorRows::Zero(sample_.full.size(), padded_width(weights.cols()));
    // Row by row is the transpose column by column.
    Eigen::Map<Eigen::MatrixXd> columns(result.data(), result.cols(), result.rows());
    visit(weights, [&](const Block& block, const Eigen::MatrixXd& own) {
      const Eigen::MatrixXd negative = values.asDiagonal() * -own.transpose();
      multiply(1.0, own.transpose(), false, columns_of(block.elastic, block.count), 1.0, columns.topRows(own.cols()));
      multiply(1.0, negative, false, columns_of(block.inertial, block.count), 1.0, columns.topRows(own.cols()));
    });
    return result;
  }

  /// S weights.
  Eigen::MatrixXd vectors(const Eigen::MatrixXd& weights) const {
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(sample_.full.size(), weights.cols());
    visit(weights, [&](const Block& block, const Eigen::MatrixXd& own) {
      multiply(1.0, columns_of(block.vectors, block.count), true, own, 1.0, result);
    });
    return result;
  }

  Eigen::MatrixXd elastic, inertial;                ///< S'K S, S'M S
  Eigen::MatrixXd elastic_sketch, inertial_sketch;  ///< W'K S, W'M S

 private:
  struct Block {
    VectorRows vectors, elastic, inertial;  ///< S, K S and M S
    Eigen::Index count = 0;
  };

  static Eigen::Ref<const Eigen::MatrixXd, 0, Eigen::OuterStride<>> columns_of(const VectorRows& rows,
                                                                               Eigen::Index count) {
    return Eigen::Map<const Eigen::MatrixXd>(rows.data(), rows.cols(), rows.rows()).topRows(count);
  }

  static VectorRows image(const std::vector<SupportedMatrix>& terms, const Eigen::VectorXd& coefficients,
                          const VectorRows& vectors) {
    VectorRows result = VectorRows::Zero(vectors.rows(), vectors.cols());
    for (std::size_t t = 0; t < terms.size(); ++t) {
      if (terms[t].is_empty()) continue;
      terms[t].add_rows(coefficients(static_cast<Eigen::Index>(t)), terms[t].local_product(vectors), result);
    }
    return result;
  }

  static void widen(Eigen::MatrixXd& matrix, const Eigen::MatrixXd& more) {
    matrix.conservativeResize(more.rows(), matrix.cols() + more.cols());
    matrix.rightCols(more.cols()) = more;
  }

  /// Enlarges a projection by the newest block.
  void extend(Eigen::MatrixXd& projection, VectorRows Block::*of) const {
    const Block& newest = blocks_.back();
    const Eigen::Index before = projection.cols(), size = before + newest.count;
    projection.conservativeResize(size, size);
    Eigen::Index first = 0;
    for (const Block& block : blocks_) {
      const Eigen::MatrixXd part = product_of_rows(block.vectors, newest.*of).topLeftCorner(block.count, newest.count);
      projection.block(first, before, block.count, newest.count) = part;
      projection.block(before, first, newest.count, block.count) = part.transpose();
      first += block.count;
    }
    auto corner = projection.bottomRightCorner(newest.count, newest.count);
    corner = (0.5 * (corner + corner.transpose())).eval();
  }

  template <typename Visitor>
  void visit(const Eigen::MatrixXd& weights, const Visitor& visitor) const {
    Eigen::Index first = 0;
    for (const Block& block : blocks_) {
      visitor(block, weights.middleRows(first, block.count));
      first += block.count;
    }
  }

  const SamplePencil& sample_;
  std::vector<Block> blocks_;
};

/// Weights of the lowest `count` Ritz vectors of a space, ascending, x' M x = 1.
Eigen::MatrixXd ritz_weights(const GrowingSpace& space, double shift, Eigen::Index count) {
  // K - s M is definite and M need not be: the largest 1 / (lambda - s) are those sought.
  const Eigen::MatrixXd gram = space.elastic - shift * space.inertial;
  const Eigen::MatrixXd basis = orthonormal_combinations(gram, gram.diagonal());
  const SymmetricEigen solver(basis.transpose() * space.inertial * basis);
  const Eigen::Index found = std::min(count, basis.cols());
  const Eigen::VectorXd flexibilities = solver.eigenvalues().tail(found).reverse().cwiseMax(1e-300);
  return basis * solver.eigenvectors().rightCols(found).rowwise().reverse() *
         flexibilities.cwiseSqrt().cwiseInverse().asDiagonal();
}

/// Those of the first `converged` columns whose squared residual is above `small`, and the largest of all others until
/// a sweep through the factor is full.
std::vector<Eigen::Index> largest_residuals(const Eigen::VectorXd& squares, Eigen::Index converged, double small) {
  constexpr Eigen::Index k_sweep = 8;
  const auto matters = [&](Eigen::Index k) { return k < converged && squares(k) > small; };
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

/// Rayleigh quotients of combinations.
Eigen::VectorXd quotients(const GrowingSpace& space, const Eigen::MatrixXd& weights) {
  const Eigen::VectorXd elastic = weights.cwiseProduct(space.elastic * weights).colwise().sum().transpose();
  const Eigen::VectorXd inertial = weights.cwiseProduct(space.inertial * weights).colwise().sum().transpose();
  return elastic.cwiseQuotient(inertial);
}

/// Block steps from a sample's own Ritz vectors [vector x mode and guards].
RefinedModes refine_sample(const ReducedModel::Parts& parts, const SamplePencil& sample, const Eigen::MatrixXd& start) {
  constexpr int k_steps = 5;
  constexpr double k_small = 0.25;  // of the tolerance
  const Eigen::Index wanted = parts.options.modes;
  const double shift = sample.full.shift, tolerance = parts.options.tolerance;
  GrowingSpace space(sample);
  space.append(parts.shapes(start), start.cols());
  Eigen::MatrixXd weights = Eigen::MatrixXd::Identity(start.cols(), start.cols());
  RefinedModes result;
  for (int step = 0;; ++step) {
    result.values = quotients(space, weights);
    const Eigen::MatrixXd residuals =
        space.elastic_sketch * weights - space.inertial_sketch * weights * result.values.asDiagonal();
    const Eigen::VectorXd norms = sketched_squares(residuals) / sample.ratio;
    result.bounds = parts.bounds(result.values, norms, sample.complement_bound, wanted);
    if (result.bounds.maxCoeff() <= tolerance || step == k_steps) break;
    const Eigen::VectorXd squares = norms.array() / parts.sizes(result.values);
    if (!squares.allFinite()) break;
    const auto columns = largest_residuals(squares, wanted + k_converged_guards, k_small * tolerance);
    VectorRows corrections = space.residuals(weights(Eigen::all, columns), result.values(columns));
    sample.full.factor().solve_rows(corrections);
    space.append(std::move(corrections), static_cast<Eigen::Index>(columns.size()));
    Eigen::MatrixXd next = ritz_weights(space, shift, start.cols());
    if (next.cols() < start.cols()) {
      weights.conservativeResizeLike(Eigen::MatrixXd::Zero(next.rows(), weights.cols()));
      break;
    }
    weights = std::move(next);
  }
  const Eigen::Index given = std::min(parts.given_modes(), weights.cols());
  result.values = result.values.head(given).eval();
  result.vectors = space.vectors(weights.leftCols(given));
  make_largest_component_positive(result.vectors);
  return result;
}

}  // namespace

void ReducedModel::refine(const TermCoefficients& samples, int threads, const RefinedVisitor& visit) const {
  const Parts& parts = *parts_;
  const Parts::Solution begin = parts.solve(samples, Purpose::results, threads);
  const Eigen::VectorXd ratios = parts.full->stiffness_lower_ratios(samples);
  const Eigen::VectorXd complement_bound = parts.complement_bounds(samples);
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
                                with_constant(samples.mass.col(s)), ratios(s), complement_bound(s)};
      const Eigen::Map<const Eigen::MatrixXd> coordinates(begin.vectors.col(s).data(), vectors, modes);
      visit(s, refine_sample(parts, pencil, coordinates));
    }
  });
}

}  // namespace mottle::linalg
