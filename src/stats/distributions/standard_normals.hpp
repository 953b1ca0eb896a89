// Standard normals of references that are simulated once and for all: fixed streams, so that results are reproducible.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "mottle/core/random.hpp"
#include "mottle/layers.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::stats {

/// Seeds of the references.
constexpr std::uint64_t k_outlier_stream = 1963;
constexpr std::uint64_t k_partial_outlier_stream = 1964;
constexpr std::uint64_t k_normality_stream = 1965;

inline Eigen::VectorXd standard_normals(Eigen::Index count, std::uint64_t seed, Eigen::Index replicate) {
  RandomStream stream({.seed = seed, .purpose = StreamPurpose::bootstrap}, static_cast<std::uint32_t>(replicate));
  Eigen::VectorXd normals(count);
  for (double& value : normals) value = standard_normal_quantile(stream.uniform());
  return normals;
}

}  // namespace mottle::stats
