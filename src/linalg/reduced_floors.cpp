// What keeps modes away that no residual can show.
#include <algorithm>
#include <functional>
#include <limits>

#include "blas.hpp"
#include "reduced_model_parts.hpp"

namespace mottle {
namespace {

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

}  // namespace

Eigen::VectorXd FullPencils::largest_mass_ratios(const TermCoefficients& samples,
                                                 const Eigen::VectorXd& reference) const {
  Eigen::VectorXd result(samples.samples());
  for (Eigen::Index s = 0; s < result.size(); ++s) {
    result(s) = extreme_ratio(mass, reference, samples.mass.col(s), 0.0, std::greater<>());
  }
  return result;
}

Eigen::VectorXd ReducedModel::Parts::unseen_above(const TermCoefficients& samples) const {
  constexpr double k_infinite = std::numeric_limits<double>::infinity();
  Eigen::VectorXd softest = full->smallest_ratios(samples);
  Eigen::VectorXd result = Eigen::VectorXd::Constant(samples.samples(), -k_infinite);
  for (std::size_t f = 0; f < floors.size(); ++f) {
    const Floor& floor = floors[f];
    const Eigen::VectorXd heaviest = full->largest_mass_ratios(samples, floor.mass);
    for (Eigen::Index s = 0; s < result.size(); ++s) {
      if (f > 0) {
        softest(s) =
            extreme_ratio(full->stiffness, floor.stiffness, samples.stiffness.col(s), k_infinite, std::less<>());
      }
      const double factor = heaviest(s) > 0.0 ? std::max(softest(s), 0.0) / heaviest(s) : 0.0;
      result(s) = std::max(result(s), factor * floor.level);
    }
  }
  return result;
}

void ReducedModel::Parts::add_floor(Floor floor, const Eigen::MatrixXd& modes, int threads) {
  const VectorRows block = to_rows(modes);
  const Eigen::MatrixXd weighed = to_columns(product_rows(full->shifted, block), modes.cols());
  append(block, modes.cols(), threads);
  settle();
  const Eigen::Index known = floor_modes.cols();
  floor_modes.conservativeResize(basis.cols(), known + modes.cols());
  floor_modes.rightCols(modes.cols()) = transposed_product(basis, weighed);
  floor_modes.rightCols(modes.cols()).colwise().normalize();
  floors.push_back(std::move(floor));
}

void ReducedModel::Parts::raise_floor(const TermCoefficients& samples, int threads) {
  constexpr double k_margin = 1.1;       // other samples go farther than these
  constexpr double k_left_out = 0.0025;  // of the samples: they are solved exactly
  const auto is_semidefinite = [](double largest) { return largest == 0.0; };
  if (!std::all_of(full->indefinite.begin(), full->indefinite.end(), is_semidefinite)) return;
  const Eigen::VectorXd softest = with_constant(samples.stiffness.rowwise().minCoeff());
  const Eigen::VectorXd heaviest = with_constant(samples.mass.rowwise().maxCoeff());
  if (softest.minCoeff() < 0.0) return;
  const Eigen::Index most_modes = Eigen::Index{4} * options.modes + 16;
  for (Eigen::Index modes = options.modes + 8; modes <= most_modes; modes *= 2) {
    const Solution solution = solve(samples, Purpose::training, threads);
    const Eigen::ArrayXd needed = k_margin * solution.values.row(solution.bounds.rows() - 1).transpose().array();
    const auto unsafe = static_cast<double>((needed >= unseen_above(samples).array()).count());
    if (unsafe <= k_left_out * static_cast<double>(samples.samples())) return;
    if (basis.cols() + modes > options.most_vectors) return;
    SparseModeSolver solver;
    const SparseModes found = solver.solve(full->stiffness_at(softest), full->mass_at(heaviest),
                                           {.modes = static_cast<int>(modes), .tolerance = 1e-4, .measures = false});
    if (!found.failure.empty() || found.values.size() == 0) return;
    add_floor({softest, heaviest, found.values(found.values.size() - 1)}, found.vectors, threads);
  }
}

}  // namespace mottle
