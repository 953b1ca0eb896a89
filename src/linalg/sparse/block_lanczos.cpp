#include "linalg/sparse/block_lanczos.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/core/random.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/linalg/dense/products.hpp"

namespace mottle::linalg {
namespace {

constexpr int k_max_restarts = 60;
constexpr double k_deflated =
    1e-11;  // relative length after orthogonalisation below which a vector counts as dependent

/// Block size: up to eight right-hand sides cost as much as eight, and wider blocks need more solutions in all; it
/// should exceed the six rigid-body modes of a free structure.
int first_block(int wanted) {
  constexpr int k_many = 48;
  return wanted < k_many ? std::clamp(wanted / 3, 7, 8) : 16;
}

/// Whether a root is found as many times as the block has vectors: its multiplicity may be higher, and a Krylov space
/// holds no more copies than its first block has vectors. Values descend.
bool may_hide_copies(const Eigen::VectorXd& values, Eigen::Index block, double tolerance) {
  const double equal = std::max(10.0 * tolerance * tolerance, 1e-8);
  for (Eigen::Index i = 0; i + block <= values.size(); ++i) {
    if (values(i) - values(i + block - 1) <= equal * std::abs(values(i))) return true;
  }
  return false;
}

/// The growing basis Q and the projected operator T = Q' M OP Q.
class KrylovBasis {
 public:
  KrylovBasis(const LanczosProblem& problem, int wanted, Eigen::Index block)
      : problem_(problem),
        block_(block),
        max_vectors_(
            std::min<Eigen::Index>(problem.size, std::max<Eigen::Index>(Eigen::Index{2} * wanted + 6 * block_, 80))),
        basis_(problem.size, max_vectors_ + block_),
        projected_(Eigen::MatrixXd::Zero(max_vectors_, max_vectors_)) {}

  /// A new block of random vectors, once through the operator, which purges what lies in the null space of M. Starts
  /// the basis, and goes on when the basis has become invariant: roots repeated more often than the block is wide, or
  /// so high above the others that the operator all but extinguishes them.
  void append_random() {
    Eigen::MatrixXd block(problem_.size, block_);
    for (Eigen::Index j = 0; j < block_; ++j) {
      RandomStream stream({.seed = 0}, random_vectors_++);
      for (Eigen::Index i = 0; i < problem_.size; ++i) block(i, j) = stream.uniform() - 0.5;
    }
    take_out_basis(block);
    block = problem_.weigh(block);
    if (block.cols() > 0) solve(block);
    newest_ = block.cols() > 0 ? orthonormalise(block, nullptr) : 0;
    coupling_.setZero();
    if (newest_ > 0) append(block);
  }

  /// One block step: OP times the newest block, orthogonal to all before.
  void extend() {
    Eigen::MatrixXd block = weighed_;
    solve(block);
    Eigen::MatrixXd coefficients = Eigen::MatrixXd::Zero(size_, block.cols());
    const Eigen::Index next = orthonormalise(block, &coefficients);
    const Eigen::Index first = projected_size_;
    projected_.block(0, first, size_, newest_) = coefficients;
    projected_.block(first, 0, newest_, first) = coefficients.topRows(first).transpose();
    auto diagonal = projected_.block(first, first, newest_, newest_);
    diagonal = (0.5 * (diagonal + diagonal.transpose())).eval();
    projected_size_ = size_;
    newest_ = next;
    if (next > 0) {
      append(block);
    } else {
      append_random();
    }
  }

  bool is_full() const { return projected_size_ + newest_ > max_vectors_; }
  bool is_exhausted() const { return newest_ == 0; }
  Eigen::Index projected_size() const { return projected_size_; }
  int solved_vectors() const { return solved_vectors_; }

  /// Ritz values, descending, and vectors of T.
  void ritz(Eigen::VectorXd& values, Eigen::MatrixXd& vectors) const {
    const SymmetricEigen solver(projected_.topLeftCorner(projected_size_, projected_size_));
    values = solver.eigenvalues().reverse();
    vectors = solver.eigenvectors().rowwise().reverse();
  }

  /// norm(OP y - theta y) in the M inner product of each Ritz pair.
  Eigen::VectorXd residuals(const Eigen::MatrixXd& vectors) const {
    if (is_exhausted()) return Eigen::VectorXd::Zero(vectors.cols());
    return (coupling_ * vectors.bottomRows(coupling_.cols())).colwise().norm().transpose();
  }

  Eigen::MatrixXd combine(const Eigen::Ref<const Eigen::MatrixXd>& weights) const {
    return product(basis_.leftCols(projected_size_), weights);
  }

  /// Keeps the leading Ritz vectors and the newest block, and forgets the rest.
  void restart(const Eigen::VectorXd& values, const Eigen::MatrixXd& vectors, Eigen::Index kept) {
    const Eigen::MatrixXd leading = combine(vectors.leftCols(kept));
    const Eigen::MatrixXd block = basis_.middleCols(projected_size_, newest_);
    basis_.leftCols(kept) = leading;
    projected_.setZero();
    projected_.topLeftCorner(kept, kept) = values.head(kept).asDiagonal();
    projected_size_ = kept;
    size_ = kept;
    append(block);
  }

 private:
  void solve(Eigen::MatrixXd& vectors) {
    problem_.solve(vectors);
    solved_vectors_ += static_cast<int>(vectors.cols());
  }

  /// Takes the known modes out of random vectors before the operator magnifies them; what is left without length has
  /// no mass, and is dropped.
  void take_out_basis(Eigen::MatrixXd& block) const {
    constexpr double k_massless = 1e-7;  // of the length: a part in 1e14 of the mass
    if (size_ == 0) return;
    const auto basis = basis_.leftCols(size_);
    Eigen::MatrixXd weighed = problem_.weigh(block);
    const Eigen::RowVectorXd before = block.cwiseProduct(weighed).colwise().sum();
    for (int sweep = 0; sweep < 2; ++sweep) {
      multiply(-1.0, basis, false, transposed_product(basis, weighed), 1.0, block);
      weighed = problem_.weigh(block);
    }
    const Eigen::RowVectorXd after = block.cwiseProduct(weighed).colwise().sum();
    Eigen::Index kept = 0;
    for (Eigen::Index j = 0; j < block.cols(); ++j) {
      if (after(j) > k_massless * k_massless * before(j)) block.col(kept++) = block.col(j).eval();
    }
    block.conservativeResize(Eigen::NoChange, kept);
  }

  void append(const Eigen::MatrixXd& block) {
    basis_.middleCols(size_, newest_) = block.leftCols(newest_);
    size_ += newest_;
  }

  /// Makes the block M-orthonormal to the basis and within itself; its first columns are the new vectors, their number
  /// is returned. `coefficients` receives Q' M block, coupling_ the triangle-like factor R with block_old = ... + new
  /// R, weighed_ M new.
  Eigen::Index orthonormalise(Eigen::MatrixXd& block, Eigen::MatrixXd* coefficients) {
    constexpr double k_much_lost = 1e-5;
    constexpr double k_half = 0.5;  // of vectors that had length one
    const auto basis = basis_.leftCols(size_);
    const auto take_out = [&] {
      const Eigen::MatrixXd components = transposed_product(basis, weighed_);
      multiply(-1.0, basis, false, components, 1.0, block);
      if (coefficients != nullptr) *coefficients += components;
    };
    weighed_ = problem_.weigh(block);
    require_lengths(block);
    const double before = std::sqrt(block.cwiseProduct(weighed_).colwise().sum().maxCoeff());
    take_out();
    weighed_ = problem_.weigh(block);
    take_out();  // again, for the rounding errors of the first time; too small to change M block
    coupling_ = normalise(block, weighed_, k_deflated * before, k_much_lost * before);
    if (block.cols() == 0) return 0;
    if (min_length_ < k_much_lost * before) {
      // Normalising a short remainder has magnified its rounding errors: orthogonalise again.
      coefficients = nullptr;
      weighed_ = problem_.weigh(block);
      take_out();
      weighed_ = problem_.weigh(block);
      const Eigen::MatrixXd again = normalise(block, weighed_, 0.0, k_half);
      if (block.cols() < coupling_.rows()) coupling_ = again * coupling_;
    }
    return block.cols();
  }

  /// Throws InvalidInput where the mass matrix gives a vector of `block`, whose products are in weighed_, no real
  /// length.
  void require_lengths(const Eigen::MatrixXd& block) const {
    constexpr double k_rounding = 1e-8;
    for (Eigen::Index k = 0; k < block.cols(); ++k) {
      const double square = block.col(k).dot(weighed_.col(k));
      require(square >= -k_rounding * block.col(k).norm() * weighed_.col(k).norm(),
              "the mass matrix is not positive semidefinite, or holds what is not finite");
    }
  }

  /// block = new R by Gram and Schmidt, twice a vector; what becomes shorter than `shortest` is dropped, and what is
  /// shorter than `doubtful` and has no length beyond rounding. A Gram matrix would be cheaper and could not tell 1e-8
  /// from nothing.
  Eigen::MatrixXd normalise(Eigen::MatrixXd& block, Eigen::MatrixXd& weighed, double shortest, double doubtful) {
    Eigen::MatrixXd triangle = Eigen::MatrixXd::Zero(block.cols(), block.cols());
    Eigen::Index kept = 0;
    min_length_ = std::numeric_limits<double>::infinity();
    for (Eigen::Index j = 0; j < block.cols(); ++j) {
      Eigen::VectorXd vector = block.col(j);
      Eigen::VectorXd weighed_vector = weighed.col(j);
      for (int sweep = 0; sweep < 2; ++sweep) {
        const Eigen::VectorXd parts = weighed.leftCols(kept).transpose() * vector;
        vector.noalias() -= block.leftCols(kept) * parts;
        weighed_vector.noalias() -= weighed.leftCols(kept) * parts;
        triangle.col(j).head(kept) += parts;
      }
      const double length = std::sqrt(std::max(0.0, vector.dot(weighed_vector)));
      if (length <= shortest || (length < doubtful && is_rounding(vector, length))) continue;
      triangle(kept, j) = length;
      min_length_ = std::min(min_length_, length);
      block.col(kept) = vector / length;
      weighed.col(kept) = weighed_vector / length;
      ++kept;
    }
    block.conservativeResize(Eigen::NoChange, kept);
    weighed.conservativeResize(Eigen::NoChange, kept);
    return triangle.topRows(kept);
  }

  /// Whether a vector lies in the null space of M but for rounding: where the masses of several equations are those of
  /// fewer motions, no entry of M x is zero then.
  bool is_rounding(const Eigen::VectorXd& vector, double length) const {
    constexpr double k_rounding = 1e-12;
    return length * length <= k_rounding * problem_.sum_of_terms(vector);
  }

  const LanczosProblem& problem_;
  Eigen::Index block_;
  Eigen::Index max_vectors_;
  Eigen::MatrixXd basis_;      // [row x vector]; the first size_ columns are in use
  Eigen::MatrixXd projected_;  // T; the first projected_size_ rows and columns are known
  Eigen::MatrixXd coupling_;   // R of the newest block
  Eigen::MatrixXd weighed_;    // M times the newest block
  double min_length_ = 0.0;    // of the vectors that the last normalise() kept
  Eigen::Index size_ = 0;
  Eigen::Index projected_size_ = 0;  // size_ less the newest block
  Eigen::Index newest_ = 0;
  int solved_vectors_ = 0;
  std::uint32_t random_vectors_ = 0;
};

LanczosPairs pairs_by_block(const LanczosProblem& problem, int wanted, double tolerance, Eigen::Index block) {
  KrylovBasis basis(problem, wanted, block);
  LanczosPairs pairs;
  basis.append_random();
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
  for (int restart = 0; restart <= k_max_restarts && !basis.is_exhausted();) {
    basis.extend();
    if (basis.projected_size() < wanted && !basis.is_exhausted() && !basis.is_full()) continue;
    basis.ritz(values, vectors);
    const Eigen::Index found = std::min<Eigen::Index>(wanted, values.size());
    const Eigen::ArrayXd residuals = basis.residuals(vectors.leftCols(found)).array();
    pairs.is_converged =
        basis.is_exhausted() || (found == wanted && (residuals <= tolerance * values.head(found).array()).all());
    if (pairs.is_converged) break;
    if (basis.is_full()) {
      basis.restart(values, vectors, std::min<Eigen::Index>(values.size() / 2, wanted + wanted / 2 + 4));
      ++restart;
    }
  }
  pairs.solved_vectors = basis.solved_vectors();
  if (basis.projected_size() == 0) return pairs;
  basis.ritz(values, vectors);
  const Eigen::Index found = std::min<Eigen::Index>(wanted, values.size());
  pairs.values = values.head(found);
  pairs.vectors = basis.combine(vectors.leftCols(found));
  return pairs;
}

}  // namespace

LanczosPairs largest_pairs(const LanczosProblem& problem, int wanted, double tolerance) {
  Eigen::Index block = std::min<Eigen::Index>(first_block(wanted), problem.size);
  LanczosPairs pairs = pairs_by_block(problem, wanted, tolerance, block);
  while (pairs.is_converged && block < std::min<Eigen::Index>(wanted, problem.size) &&
         may_hide_copies(pairs.values, block, tolerance)) {
    const int solved = pairs.solved_vectors;
    block = std::min(2 * block, problem.size);
    pairs = pairs_by_block(problem, wanted, tolerance, block);
    pairs.solved_vectors += solved;
  }
  return pairs;
}

}  // namespace mottle::linalg
