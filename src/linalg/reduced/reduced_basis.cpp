// Growth, orthonormalisation and rotation of a reduced model's basis, with its projections.
#include <Eigen/Core>

#include "linalg/reduced/reduced_model_parts.hpp"
#include "mottle/core/parallel.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/linalg/dense/products.hpp"

namespace mottle::linalg {
namespace {

/// q'Tq of symmetric terms.
std::vector<Eigen::MatrixXd> projections(const std::vector<Eigen::MatrixXd>& terms, const Eigen::MatrixXd& q) {
  std::vector<Eigen::MatrixXd> result;
  for (const Eigen::MatrixXd& term : terms) {
    const Eigen::MatrixXd projected = transposed_product(q, product(term, q));
    result.emplace_back(0.5 * (projected + projected.transpose()));
  }
  return result;
}

std::vector<Eigen::MatrixXd> products(const std::vector<Eigen::MatrixXd>& sketches, const Eigen::MatrixXd& q) {
  std::vector<Eigen::MatrixXd> result;
  for (const Eigen::MatrixXd& sketch : sketches) result.push_back(product(sketch, q));
  return result;
}

}  // namespace

Eigen::MatrixXd orthonormal_combinations(const Eigen::MatrixXd& gram, const Eigen::VectorXd& before) {
  constexpr double k_min = 1e-10;
  const Eigen::VectorXd scales = (gram.diagonal().array() > k_min * before.array())
                                     .select(gram.diagonal().cwiseAbs().cwiseSqrt().cwiseInverse(), 0.0);
  const SymmetricEigen solver(scales.asDiagonal() * gram * scales.asDiagonal());
  const Eigen::VectorXd& parts = solver.eigenvalues();
  const Eigen::Index kept = (parts.array() > k_min * parts.maxCoeff()).count();
  return scales.asDiagonal() * solver.eigenvectors().rightCols(kept) *
         parts.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
}

std::vector<ReferencePencil> with_levels(std::vector<ReferencePencil> pencils, const Eigen::VectorXd& levels) {
  for (std::size_t f = 0; f < pencils.size(); ++f) pencils[f].complete_to = levels(static_cast<Eigen::Index>(f));
  return pencils;
}

void ReducedModel::Parts::forget_derived() {
  prepared = std::make_shared<PreparedModes>();
  leading_directions.resize(0, 0);
  leading_levels.resize(0);
  leading.reset();
}

VectorRows ReducedModel::Parts::shapes(const Eigen::MatrixXd& coordinates) const {
  const Eigen::MatrixXd padded = to_rows(coordinates);
  return product_by_rows(basis, pending.size() > 0 ? product(pending, padded) : padded);
}

void ReducedModel::Parts::append(const VectorRows& block, Eigen::Index count, int threads) {
  constexpr int k_max_passes = 3;
  constexpr double k_rounding = 1e-12;
  forget_derived();
  Eigen::Index added = count;
  basis.conservativeResize(block.rows(), basis.cols() + added);
  basis.rightCols(added) = to_columns(block, added);
  for (int pass = 0; pass < k_max_passes; ++pass) {
    pending.conservativeResizeLike(Eigen::MatrixXd::Identity(basis.cols(), basis.cols()));
    project_last(pass == 0 ? block : to_rows(basis.rightCols(added)), added, threads);
    added = orthonormalise_last(added);
    if (added == 0) break;
    Eigen::MatrixXd gram = nominal_columns(added);
    gram.bottomRows(added).diagonal().array() -= 1.0;
    // Cancellation: where the block lay nearly in the basis, rounding errors remain after projection, so project again.
    if (gram.cwiseAbs().maxCoeff() <= k_rounding) break;
    apply_pending();
  }
  const Eigen::Index known = reference_modes.rows();
  reference_modes.conservativeResize(basis.cols(), Eigen::NoChange);
  reference_modes.bottomRows(basis.cols() - known).setZero();
}

void ReducedModel::Parts::project_last(const VectorRows& block, Eigen::Index added, int threads) {
  const Eigen::Index size = basis.cols();
  const auto extend = [&](const SupportedMatrix& term, Eigen::MatrixXd& projected, Eigen::MatrixXd& sketched) {
    const VectorRows image = term.local_product(block);
    const Eigen::MatrixXd columns = transposed_product(pending, term.project(basis, image).leftCols(added));
    projected.conservativeResize(size, size);
    projected.rightCols(added) = columns;
    projected.bottomRows(added) = columns.transpose();
    projected.bottomRightCorner(added, added) =
        0.5 * (columns.bottomRows(added) + columns.bottomRows(added).transpose());
    sketched.conservativeResize(k_sketch_rows, size);
    sketched.rightCols(added) = term.project(full->sketch(), image).leftCols(added);
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

Eigen::MatrixXd ReducedModel::Parts::nominal_columns(Eigen::Index count) const {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(mass[0].rows(), count);
  for (std::size_t t = 0; t < stiffness.size(); ++t) {
    columns += full->nominal_stiffness(static_cast<Eigen::Index>(t)) * stiffness[t].rightCols(count);
  }
  for (std::size_t t = 0; t < mass.size(); ++t) {
    columns -= full->shift * full->nominal_mass(static_cast<Eigen::Index>(t)) * mass[t].rightCols(count);
  }
  return columns;
}

Eigen::Index ReducedModel::Parts::orthonormalise_last(Eigen::Index added) {
  const Eigen::Index before = basis.cols() - added;
  const Eigen::MatrixXd gram = nominal_columns(added);
  const Eigen::MatrixXd inside = gram.topRows(before);
  const Eigen::MatrixXd rest = gram.bottomRows(added) - transposed_product(inside, inside);
  const Eigen::MatrixXd combinations = orthonormal_combinations(rest, gram.bottomRows(added).diagonal());
  const Eigen::Index kept = combinations.cols(), size = before + kept;
  Eigen::MatrixXd rotation(before + added, kept);
  rotation << -product(inside, combinations), combinations;
  const Eigen::MatrixXd rotated = product(pending, rotation);
  pending.conservativeResize(Eigen::NoChange, size);
  pending.rightCols(kept) = rotated;
  if (kept < added) apply_pending();
  const auto apply = [&](Eigen::MatrixXd& projected, Eigen::MatrixXd& sketched) {
    const Eigen::MatrixXd columns = product(projected, rotation);
    const Eigen::MatrixXd corner = transposed_product(rotation, columns);
    projected.conservativeResize(size, size);
    projected.topRightCorner(before, kept) = columns.topRows(before);
    projected.bottomLeftCorner(kept, before) = columns.topRows(before).transpose();
    projected.bottomRightCorner(kept, kept) = 0.5 * (corner + corner.transpose());
    const Eigen::MatrixXd last = product(sketched, rotation);
    sketched.conservativeResize(Eigen::NoChange, size);
    sketched.rightCols(kept) = last;
  };
  for (std::size_t t = 0; t < stiffness.size(); ++t) apply(stiffness[t], stiffness_sketch[t]);
  for (std::size_t t = 0; t < mass.size(); ++t) apply(mass[t], mass_sketch[t]);
  return kept;
}

void ReducedModel::Parts::apply_pending() {
  if (pending.size() == 0) return;
  constexpr Eigen::Index k_rows = 4096;  // at a time: a large basis is not held twice
  for (Eigen::Index first = 0; first < basis.rows(); first += k_rows) {
    const Eigen::Index count = std::min(k_rows, basis.rows() - first);
    basis.block(first, 0, count, pending.cols()) = product(basis.middleRows(first, count), pending);
  }
  basis.conservativeResize(Eigen::NoChange, pending.cols());
  pending.resize(0, 0);
}

void ReducedModel::Parts::rotate(const Eigen::MatrixXd& q) {
  forget_derived();
  pending = pending.size() > 0 ? product(pending, q) : q;
  apply_pending();
  reference_modes = transposed_product(q, reference_modes);
  stiffness = projections(stiffness, q);
  mass = projections(mass, q);
  stiffness_sketch = products(stiffness_sketch, q);
  mass_sketch = products(mass_sketch, q);
}

Eigen::MatrixXd ReducedModel::Parts::rotation_to_nominal_modes(const Eigen::MatrixXd& directions) const {
  const Eigen::MatrixXd nominal = weighted_sum(mass, full->nominal_mass);
  const Eigen::MatrixXd rotation = nominal_rotation(transposed_product(directions, product(nominal, directions)));
  return rotation.size() > 0 ? product(directions, rotation) : directions;
}

void ReducedModel::Parts::make_leading(const Eigen::MatrixXd& directions, const Eigen::VectorXd& levels) {
  auto model = std::make_shared<Parts>();
  model->full = full;
  model->options = options;
  model->reference_pencils = with_levels(reference_pencils, levels);
  model->stiffness = projections(stiffness, directions);
  model->mass = projections(mass, directions);
  model->stiffness_sketch = products(stiffness_sketch, directions);
  model->mass_sketch = products(mass_sketch, directions);
  leading_directions = directions;
  leading_levels = levels;
  leading = std::move(model);
}

}  // namespace mottle::linalg
