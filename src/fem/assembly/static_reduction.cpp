#include "mottle/fem/assembly/static_reduction.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/linalg/sparse/sparse_modes.hpp"
#include "mottle/linalg/sparse/symmetric_factor.hpp"

namespace mottle::fem {
namespace {

/// Rows of the matrices that are kept and that are omitted, ascending.
struct Partition {
  std::vector<int> kept, omitted;
  std::vector<int> place;  ///< of a row in its list
};

/// Some rows of a matrix, and back. Plain loops: of Eigen's indexed views GCC 12 warns falsely at -O3.
Eigen::MatrixXd taken(const Eigen::MatrixXd& matrix, const std::vector<int>& rows) {
  Eigen::MatrixXd result(static_cast<Eigen::Index>(rows.size()), matrix.cols());
  for (std::size_t k = 0; k < rows.size(); ++k) result.row(static_cast<Eigen::Index>(k)) = matrix.row(rows[k]);
  return result;
}

void put(Eigen::MatrixXd& matrix, const std::vector<int>& rows, const Eigen::MatrixXd& values) {
  for (std::size_t k = 0; k < rows.size(); ++k) matrix.row(rows[k]) = values.row(static_cast<Eigen::Index>(k));
}

Partition partition_of(const std::vector<bool>& is_omitted) {
  Partition parts;
  for (std::size_t row = 0; row < is_omitted.size(); ++row) {
    std::vector<int>& list = is_omitted[row] ? parts.omitted : parts.kept;
    parts.place.push_back(static_cast<int>(list.size()));
    list.push_back(static_cast<int>(row));
  }
  return parts;
}

/// Lower triangle of A_oo.
SparseMatrix omitted_block(const SparseMatrix& lower, const std::vector<bool>& is_omitted, const Partition& parts) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const int column : parts.omitted) {
    for (SparseMatrix::InnerIterator entry(lower, column); entry; ++entry) {
      const auto row = static_cast<std::size_t>(entry.row());
      if (is_omitted[row])
        entries.emplace_back(parts.place[row], parts.place[static_cast<std::size_t>(column)], entry.value());
    }
  }
  const auto size = static_cast<Eigen::Index>(parts.omitted.size());
  SparseMatrix block(size, size);
  block.setFromTriplets(entries.begin(), entries.end());
  return block;
}

std::string mechanism(const std::string& where) {
  return fmt::format(
      "ASET, OMIT: the omitted degrees of freedom can move where all others are held ({}); keep one that holds them",
      where);
}

/// Factor of K_oo. Without stiffness K_oo is singular, and where rounding hides that, its solutions are wrong.
std::unique_ptr<DefiniteFactor> factor_of(const SparseMatrix& block, const Partition& parts,
                                          const std::function<std::string(int)>& name) {
  auto factor = make_definite_factor();
  if (!factor->factorise(block)) {
    const int row = factor->failed_column();
    throw InvalidInput(
        mechanism(row < 0 ? "not known where" : "first seen at " + name(parts.omitted[static_cast<std::size_t>(row)])));
  }
  constexpr double k_largest_error = 1e-3;  // of a solution: K_oo is singular but for rounding
  Eigen::MatrixXd known(block.rows(), 1);
  for (Eigen::Index i = 0; i < known.rows(); ++i) {
    known(i) = 1.0 + 0.5 * std::sin(static_cast<double>(i));
    const double diagonal = block.coeff(i, i);
    if (diagonal > 0.0) known(i) /= std::sqrt(diagonal);  // translations and rotations in one size
  }
  Eigen::MatrixXd found = symmetric_product(block, known);
  factor->solve(found);
  Eigen::Index worst = 0;
  const double error = (found - known).cwiseQuotient(known).cwiseAbs().col(0).maxCoeff(&worst);
  require(error <= k_largest_error, "{}",
          mechanism("first seen at " + name(parts.omitted[static_cast<std::size_t>(worst)])));
  return factor;
}

/// [I; -K_oo^-1 K_oa] of some kept rows, or applies its transpose.
class StaticMotion {
 public:
  StaticMotion(const SparseMatrix& stiffness, const Partition& parts, DefiniteFactor& factor)
      : stiffness_(stiffness), parts_(parts), factor_(factor) {}

  Eigen::MatrixXd columns(int first, int count) const {
    Eigen::MatrixXd motion = Eigen::MatrixXd::Zero(stiffness_.rows(), count);
    for (int j = 0; j < count; ++j) motion(parts_.kept[static_cast<std::size_t>(first + j)], j) = 1.0;
    put(motion, parts_.omitted, -inverse_of_omitted(symmetric_product(stiffness_, motion)));
    return motion;
  }

  /// T' of forces [row x column]: [kept row x column].
  Eigen::MatrixXd transposed(const Eigen::MatrixXd& forces) const {
    Eigen::MatrixXd followers = Eigen::MatrixXd::Zero(forces.rows(), forces.cols());
    put(followers, parts_.omitted, inverse_of_omitted(forces));
    return taken(forces - symmetric_product(stiffness_, followers), parts_.kept);
  }

 private:
  Eigen::MatrixXd inverse_of_omitted(const Eigen::MatrixXd& rows) const {
    Eigen::MatrixXd solved = taken(rows, parts_.omitted);
    factor_.solve(solved);
    return solved;
  }

  const SparseMatrix& stiffness_;
  const Partition& parts_;
  DefiniteFactor& factor_;
};

/// Lower triangle of M^: T' M T at the kept rows, a block of columns at a time.
SparseMatrix reduced_mass(const StaticMotion& motion, const SparseMatrix& mass, const Partition& parts) {
  constexpr int k_block = 64;
  const int kept = static_cast<int>(parts.kept.size());
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(kept) * static_cast<std::size_t>(kept + 1) / 2);
  for (int first = 0; first < kept; first += k_block) {
    const int count = std::min(k_block, kept - first);
    const Eigen::MatrixXd block = motion.transposed(symmetric_product(mass, motion.columns(first, count)));
    for (int j = 0; j < count; ++j) {
      for (int i = first + j; i < kept; ++i) {
        entries.emplace_back(parts.kept[static_cast<std::size_t>(i)], parts.kept[static_cast<std::size_t>(first + j)],
                             block(i, j));
      }
    }
  }
  SparseMatrix result(mass.rows(), mass.cols());
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace

bool has_omitted_mass(const SeparableMatrix& mass, const std::vector<bool>& is_omitted) {
  if (std::ranges::none_of(is_omitted, [](bool is) { return is; })) return false;
  std::vector<bool> reaches;  // by position of the pattern
  for (Eigen::Index column = 0; column < mass.pattern.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(mass.pattern, column); entry; ++entry) {
      reaches.push_back(is_omitted[static_cast<std::size_t>(entry.row())] ||
                        is_omitted[static_cast<std::size_t>(column)]);
    }
  }
  return std::ranges::any_of(mass.terms, [&](const SeparableMatrix::Term& term) {
    for (std::size_t k = 0; k < term.positions.size(); ++k) {
      if (reaches[static_cast<std::size_t>(term.positions[k])] && term.values[k] != 0.0) return true;
    }
    return false;
  });
}

void reduce_statically(SparseMatrix& stiffness, SparseMatrix& mass, const std::vector<bool>& is_omitted,
                       const std::function<std::string(int)>& name) {
  const Partition parts = partition_of(is_omitted);
  require(!parts.kept.empty(), "ASET, OMIT: no degree of freedom is kept; keep those whose motion is wanted");
  require(static_cast<int>(parts.kept.size()) <= k_most_kept,
          "ASET, OMIT: {} degrees of freedom are kept, of which the reduced mass is a full matrix; at most {} can be "
          "kept, or all (model.ignore_cards leaves these cards out)",
          parts.kept.size(), k_most_kept);
  const auto factor = factor_of(omitted_block(stiffness, is_omitted, parts), parts, name);
  const SparseMatrix reduced = reduced_mass(StaticMotion(stiffness, parts, *factor), mass, parts);
  mass = SparseMatrix(0.0 * stiffness + reduced);
  stiffness = SparseMatrix(stiffness + 0.0 * reduced);
}

Eigen::MatrixXd static_followers(const SparseMatrix& stiffness, const SparseMatrix& mass,
                                 const std::vector<bool>& is_omitted, const Eigen::MatrixXd& shapes) {
  const Partition parts = partition_of(is_omitted);
  const auto factor =
      factor_of(omitted_block(stiffness, is_omitted, parts), parts, [](int row) { return fmt::format("row {}", row); });
  Eigen::MatrixXd omitted = taken(symmetric_product(mass, shapes), parts.omitted);
  factor->solve(omitted);
  Eigen::MatrixXd followers = Eigen::MatrixXd::Zero(shapes.rows(), shapes.cols());
  put(followers, parts.omitted, omitted);
  return followers;
}

}  // namespace mottle::fem
