#include "linalg/reduced/batched_davidson.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>

#include "linalg/batched/simd_kernels.hpp"
#include "mottle/core/parallel.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/linalg/dense/products.hpp"

namespace mottle::linalg {
namespace {

constexpr Eigen::Index k_tile = simd_kernels::k_tile;

Eigen::Index rounded_up(Eigen::Index count, Eigen::Index multiple) {
  return (count + multiple - 1) / multiple * multiple;
}

constexpr Eigen::Index k_tile_entries = k_tile * k_tile;

/// A tile by rows.
void write_tile(const Eigen::MatrixXd& matrix, Eigen::Index row, Eigen::Index column, double* to) {
  Eigen::Map<Eigen::Matrix<double, k_tile, k_tile, Eigen::RowMajor>>{to} = matrix.block<k_tile, k_tile>(row, column);
}

/// Whether the ratios of a sample's coefficients to the nominal ones lie within a factor of each other.
bool are_near(const Eigen::Ref<const Eigen::VectorXd>& coefficients, const Eigen::VectorXd& nominal) {
  constexpr double k_farthest = 3.0;  // farther, the iteration hardly converges
  if (coefficients.size() == 0) return true;
  const Eigen::ArrayXd ratios = coefficients.array() / nominal.tail(coefficients.size()).array();
  return ratios.allFinite() && ratios.minCoeff() > 0.0 && ratios.maxCoeff() <= k_farthest * ratios.minCoeff();
}

}  // namespace

Eigen::MatrixXd weighted_sum(const std::vector<Eigen::MatrixXd>& terms, const Eigen::VectorXd& coefficients) {
  Eigen::MatrixXd sum = coefficients(0) * terms[0];
  for (std::size_t t = 1; t < terms.size(); ++t) sum += coefficients(static_cast<Eigen::Index>(t)) * terms[t];
  return sum;
}

Eigen::MatrixXd nominal_rotation(const Eigen::MatrixXd& nominal) {
  const Eigen::VectorXd masses = nominal.diagonal();
  const bool descends = std::is_sorted(masses.data(), masses.data() + masses.size(), std::greater<>());
  if (descends && is_nearly_diagonal(nominal)) return {};
  const SymmetricEigen solver(nominal);
  return solver.eigenvectors().rowwise().reverse();
}

BatchedDavidson::BatchedDavidson(const DavidsonPencils& family, const DavidsonOptions& options)
    : options_(options),
      shift_(family.shift),
      smallest_(family.smallest),
      nominal_stiffness_(family.nominal_stiffness),
      nominal_mass_(family.nominal_mass),
      sketch_rows_(family.mass_sketch[0].rows()),
      rows_(family.mass[0].rows()) {
  constexpr double k_above = 1.8;         // the block's nominal modes reach this multiple of the highest wanted lambda
  constexpr Eigen::Index k_beside = 3;    // at least this many vectors more than wanted modes
  constexpr Eigen::Index k_smallest = 2;  // order over block size below which a dense solution is cheaper
  constexpr Eigen::Index k_columns = simd_kernels::k_block_columns;
  kept_ = rounded_up(options.modes, k_columns);
  corrected_ = rounded_up(options.converged, k_columns);
  Eigen::Index block = rounded_up(options.modes + k_beside, k_columns);
  if (k_smallest * block > rows_) return;
  const Eigen::MatrixXd nominal = weighted_sum(family.mass, nominal_mass_);
  rotation_ = nominal_rotation(nominal);
  order_ = rounded_up(rows_, k_tile);
  masses_ = Eigen::VectorXd::Zero(order_);
  const Eigen::MatrixXd rotated =
      rotation_.size() == 0 ? nominal : transposed_product(rotation_, product(nominal, rotation_));
  masses_.head(rows_) = rotated.diagonal().cwiseMax(0.0);
  while (block < rows_ && masses_(block) * k_above > masses_(options.modes - 1)) block += k_columns;
  if (k_smallest * block > rows_) return;
  block_ = block;
  pack(family.stiffness, 1.0, stiffness_);
  if (family.mass.size() > 1) pack(family.mass, 0.0, mass_);
  pack_sketch(family.stiffness_sketch, stiffness_sketch_);
  pack_sketch(family.mass_sketch, mass_sketch_);
}

void BatchedDavidson::pack(const std::vector<Eigen::MatrixXd>& terms, double filling,
                           std::vector<double>& packed) const {
  const Eigen::Index tiles = order_ / k_tile, stride = static_cast<Eigen::Index>(terms.size()) * k_tile_entries;
  packed.resize(static_cast<std::size_t>(stride * tiles * (tiles + 1) / 2));
  Eigen::MatrixXd filled = Eigen::MatrixXd::Zero(order_, order_);
  for (std::size_t t = 0; t < terms.size(); ++t) {
    filled.topLeftCorner(rows_, rows_) =
        rotation_.size() == 0 ? terms[t] : transposed_product(rotation_, product(terms[t], rotation_));
    filled.diagonal().tail(order_ - rows_).setConstant(t == 0 ? filling : 0.0);
    double* to = packed.data() + t * k_tile_entries;
    for (Eigen::Index j = 0; j < order_; j += k_tile) {
      for (Eigen::Index i = j; i < order_; i += k_tile, to += stride) write_tile(filled, i, j, to);
    }
  }
}

void BatchedDavidson::pack_sketch(const std::vector<Eigen::MatrixXd>& terms, std::vector<double>& packed) const {
  const Eigen::Index stride = static_cast<Eigen::Index>(terms.size()) * k_tile_entries;
  packed.resize(terms.size() * static_cast<std::size_t>(sketch_rows_ * order_));
  Eigen::MatrixXd filled = Eigen::MatrixXd::Zero(sketch_rows_, order_);
  for (std::size_t t = 0; t < terms.size(); ++t) {
    filled.leftCols(rows_) = rotation_.size() == 0 ? terms[t] : product(terms[t], rotation_);
    double* to = packed.data() + t * k_tile_entries;
    for (Eigen::Index i = 0; i < sketch_rows_; i += k_tile) {
      for (Eigen::Index j = 0; j < order_; j += k_tile, to += stride) write_tile(filled, i, j, to);
    }
  }
}

std::vector<Eigen::Index> BatchedDavidson::near_samples(const TermCoefficients& samples) const {
  std::vector<Eigen::Index> near;
  for (Eigen::Index s = 0; s < samples.samples(); ++s) {
    if (are_near(samples.stiffness.col(s), nominal_stiffness_) && are_near(samples.mass.col(s), nominal_mass_)) {
      near.push_back(s);
    }
  }
  return near;
}

SketchedModes BatchedDavidson::solve_near(const TermCoefficients& samples, const DavidsonBounds& bounds, double limit,
                                          int threads) const {
  constexpr std::int64_t k_grain = 32;
  const Eigen::Index modes = options_.modes, count = samples.samples();
  SketchedModes result{{Eigen::MatrixXd(modes, count), Eigen::MatrixXd(rows_ * modes, count), {}},
                       Eigen::MatrixXd(sketch_rows_, modes * count)};
  std::vector<unsigned char> valid(static_cast<std::size_t>(count), 0);
  const simd_kernels::DavidsonProblem problem{.order = static_cast<int>(order_),
                                              .rows = static_cast<int>(rows_),
                                              .block = static_cast<int>(block_),
                                              .kept = static_cast<int>(kept_),
                                              .corrected = static_cast<int>(corrected_),
                                              .modes = static_cast<int>(modes),
                                              .converged = static_cast<int>(options_.converged),
                                              .stiffness_terms = static_cast<int>(samples.stiffness.rows()),
                                              .mass_terms = mass_.empty() ? 0 : static_cast<int>(samples.mass.rows()),
                                              .stiffness = stiffness_.data(),
                                              .mass = mass_.data(),
                                              .nominal_mass = masses_.data(),
                                              .stiffness_coefficients = samples.stiffness.data(),
                                              .mass_coefficients = samples.mass.data(),
                                              .stiffness_stride = static_cast<long>(samples.stiffness.rows()),
                                              .mass_stride = static_cast<long>(samples.mass.rows()),
                                              .ratios = bounds.ratios.data(),
                                              .mass_ratios = bounds.mass_ratios.data(),
                                              .shift = shift_,
                                              .smallest = smallest_,
                                              .limit = limit,
                                              .sketch_rows = static_cast<int>(sketch_rows_),
                                              .stiffness_sketch = stiffness_sketch_.data(),
                                              .mass_sketch = mass_sketch_.data(),
                                              .sketched_residuals = result.residuals.data()};
  const simd_kernels::Output output{result.modes.values.data(), result.modes.vectors.data(), valid.data()};
  const simd_kernels::Kernels& kernels = simd_kernels::kernels_for(options_.simd);
  parallel_for(count, k_grain, threads, [&](std::int64_t begin, std::int64_t end) {
    kernels.solve_davidson(problem, output, begin, end,
                           simd_kernels::thread_workspace(kernels.davidson_doubles(problem)));
  });
  for (const unsigned char is_valid : valid) result.modes.failed.push_back(is_valid != 0 ? 0 : 1);
  return result;
}

SketchedModes BatchedDavidson::solve(const TermCoefficients& samples, const DavidsonBounds& bounds, double limit,
                                     int threads) const {
  const Eigen::Index modes = options_.modes, count = samples.samples();
  const std::vector<Eigen::Index> near = is_useful() ? near_samples(samples) : std::vector<Eigen::Index>{};
  const bool takes_all = static_cast<Eigen::Index>(near.size()) == count;
  SketchedModes found = takes_all ? solve_near(samples, bounds, limit, threads)
                                  : solve_near({samples.stiffness(Eigen::all, near), samples.mass(Eigen::all, near)},
                                               {bounds.ratios(near), bounds.mass_ratios(near)}, limit, threads);
  if (rotation_.size() > 0) {
    for (Eigen::Index i = 0; i < found.modes.values.cols(); ++i) {
      found.modes.vectors.col(i) = product(rotation_, found.modes.sample_vectors(i)).reshaped();
    }
  }
  if (takes_all) return found;
  SketchedModes result{{Eigen::MatrixXd(modes, count), Eigen::MatrixXd(rows_ * modes, count),
                        std::vector<std::uint8_t>(static_cast<std::size_t>(count), 1)},
                       Eigen::MatrixXd(sketch_rows_, modes * count)};
  for (std::size_t i = 0; i < near.size(); ++i) {
    const auto from = static_cast<Eigen::Index>(i);
    result.modes.failed[static_cast<std::size_t>(near[i])] = found.modes.failed[i];
    result.modes.values.col(near[i]) = found.modes.values.col(from);
    result.modes.vectors.col(near[i]) = found.modes.vectors.col(from);
    result.residuals.middleCols(near[i] * modes, modes) = found.residuals.middleCols(from * modes, modes);
  }
  return result;
}

}  // namespace mottle::linalg
