#include "mottle/stats/sampling/sampling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/core/process_mutex.hpp"
#include "stats/openturns/openturns.hpp"

namespace mottle::stats {

namespace {

constexpr double k_smallest = 0x1p-53;
constexpr double k_largest = 1.0 - 0x1p-53;

/// Stream of one column. The draw's own purpose goes into the sample number, so that a truth and a cloud of the same
/// seed and iteration are not permuted or shifted alike.
RandomStream column_stream(const StreamKey& key, StreamPurpose purpose, Eigen::Index column) {
  const auto sample = (static_cast<std::uint32_t>(key.purpose) << 16U) | static_cast<std::uint32_t>(column);
  return {{.seed = key.seed, .purpose = purpose, .iteration = key.iteration}, sample};
}

Eigen::MatrixXd monte_carlo_design(Eigen::Index samples, Eigen::Index dimension, const StreamKey& key) {
  Eigen::MatrixXd uniforms(samples, dimension);
  for (Eigen::Index s = 0; s < samples; ++s) {
    RandomStream stream(key, static_cast<std::uint32_t>(s));
    for (Eigen::Index j = 0; j < dimension; ++j) uniforms(s, j) = stream.uniform();
  }
  return uniforms;
}

/// Whole number in [0, count), each equally likely: words from the incomplete last round are thrown away.
std::uint64_t random_below(std::uint64_t count, RandomStream& stream) {
  const std::uint64_t excess = (0 - count) % count;  // 2^64 mod count
  std::uint64_t word = stream.bits();
  while (word < excess) word = stream.bits();
  return word % count;
}

std::vector<Eigen::Index> random_permutation(Eigen::Index count, RandomStream stream) {
  std::vector<Eigen::Index> permutation(static_cast<std::size_t>(count));
  std::iota(permutation.begin(), permutation.end(), Eigen::Index{0});
  for (std::size_t last = permutation.size() - 1; last > 0; --last) {
    std::swap(permutation[last], permutation[random_below(last + 1, stream)]);
  }
  return permutation;
}

Eigen::MatrixXd latin_hypercube_design(Eigen::Index samples, Eigen::Index dimension, const StreamKey& key) {
  Eigen::MatrixXd uniforms = monte_carlo_design(samples, dimension, key);
  for (Eigen::Index j = 0; j < dimension; ++j) {
    const auto strata = random_permutation(samples, column_stream(key, StreamPurpose::design_permutation, j));
    for (Eigen::Index s = 0; s < samples; ++s) {
      const auto stratum = static_cast<double>(strata[static_cast<std::size_t>(s)]);
      uniforms(s, j) = std::min((stratum + uniforms(s, j)) / static_cast<double>(samples), k_largest);
    }
  }
  return uniforms;
}

Eigen::MatrixXd sobol_design(Eigen::Index samples, Eigen::Index dimension, const StreamKey& key) {
  const Eigen::Index limit = openturns().max_sobol_dimension();
  require(dimension <= limit, "Sobol design: {} dimensions, at most {}; use Latin hypercube or Monte Carlo", dimension,
          limit);
  Eigen::VectorXd shift(dimension);
  for (Eigen::Index j = 0; j < dimension; ++j) {
    shift[j] = column_stream(key, StreamPurpose::design_shift, j).uniform();
  }
  Eigen::MatrixXd uniforms(samples, dimension);
  uniforms.row(0) = shift.transpose();  // OpenTURNS leaves out the origin, without which 2^m points are no net
  const NoFork alone;                   // since OpenTURNS has locks of its own
  openturns().fill_with_sobol_points(uniforms.bottomRows(samples - 1));
  for (Eigen::Index s = 1; s < samples; ++s) {
    for (Eigen::Index j = 0; j < dimension; ++j) {
      const double moved = uniforms(s, j) + shift[j];
      uniforms(s, j) = std::clamp(moved - std::floor(moved), k_smallest, k_largest);
    }
  }
  return uniforms;
}

}  // namespace

Eigen::MatrixXd uniform_design(SamplingDesign design, Eigen::Index samples, Eigen::Index dimension,
                               const StreamKey& key) {
  constexpr Eigen::Index k_max_samples = std::numeric_limits<std::uint32_t>::max();
  constexpr Eigen::Index k_max_dimensions = 65535;
  require(1 <= samples && samples <= k_max_samples, "samples: {} is outside 1 to {}", samples, k_max_samples);
  require(1 <= dimension && dimension <= k_max_dimensions, "dimension: {} is outside 1 to {}", dimension,
          k_max_dimensions);
  switch (design) {
    case SamplingDesign::monte_carlo:
      return monte_carlo_design(samples, dimension, key);
    case SamplingDesign::latin_hypercube:
      return latin_hypercube_design(samples, dimension, key);
    case SamplingDesign::sobol:
      return sobol_design(samples, dimension, key);
  }
  throw InvalidInput("design: not a sampling design");
}

}  // namespace mottle::stats
