// Sampling designs in the unit cube. Every design is a pure function of its stream key.
#pragma once

#include <Eigen/Core>

#include "mottle/core/random.hpp"
#include "mottle/layers.hpp"

namespace mottle::stats {

/// How samples are spread over the unit cube.
enum class SamplingDesign {
  monte_carlo,      ///< independent; the first n rows of a larger design are the design of n rows
  latin_hypercube,  ///< each column has exactly one value in each of `samples` equal strata
  sobol,            ///< low-discrepancy points, shifted at random modulo 1; best with a power of two
};

/// Uniforms of a design.
///
/// Monte Carlo: row s is the start of RandomStream(key, s). Latin hypercube: column j is (permutation + jitter) /
/// samples, the jitter from RandomStream(key, s), the permutation from the stream of purpose design_permutation. Sobol:
/// the sequence from its first point (the origin) on, so that 2^m rows form a net, plus one shift a column from the
/// stream of purpose design_shift.
///
/// @param samples    1 to 2^32 - 1
/// @param dimension  1 to 65,535; for Sobol at most 1,111 (direction numbers of OpenTURNS)
/// @param key        names the draw; designs of different purpose or iteration are independent (Sobol:
///                   shifts of one sequence)
/// @return           [sample x dimension], in the open interval (0, 1)
/// @throws InvalidInput  samples or dimension outside its range (says the limit)
/// Source: [McKay1979] Latin hypercube; [Sobol1967], [Joe2008] sequence; [Cranley1976] shift; [Owen2022] first point.
Eigen::MatrixXd uniform_design(SamplingDesign design, Eigen::Index samples, Eigen::Index dimension,
                               const StreamKey& key);

}  // namespace mottle::stats
