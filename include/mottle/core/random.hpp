// Counter-based random numbers: a stream is a pure function of (seed, purpose, iteration, sample), so results do
// not depend on threads, on order of evaluation or on where a run was interrupted.
#pragma once

#include <array>
#include <cstdint>

namespace mottle {

/// What a stream is used for; streams of different purposes are independent.
enum class StreamPurpose : std::uint32_t {
  parameter_cloud = 1,
  design_permutation = 2,
  design_shift = 3,
  redraw = 4,
  truth = 5,
  test_noise = 6,
  bootstrap = 7,
  residual_sketch = 8,
  basis_training = 9,
  surrogate_runs = 10,
  prediction = 20,
  prediction_noise = 21,
  posterior_start = 30,
  posterior_resampling = 31,
  posterior_proposal = 32,
  posterior_move = 33,
  corrected_auxiliaries = 34,
  corrected_decision = 35,
  corrected_resampling = 36,
  corrected_start = 37,
  mixture_start = 60,
  mixture_test = 61,
  mixture_power = 62,
  mixture_intervals = 63,
  abc_directions = 70,
  abc_noise = 71,
  abc_proposal = 72,
  abc_simulation = 73,
  abc_calibration = 74,
  abc_model_error = 75,
};

/// The part of a stream's name that all samples of one draw share.
struct StreamKey {
  std::uint64_t seed = 1;
  StreamPurpose purpose = StreamPurpose::parameter_cloud;
  std::uint32_t iteration = 0;
};

/// Stream of 64-bit words and uniforms from Philox-4x32-10, key = seed, counter = (block, sample, iteration, purpose).
/// Source: [Salmon2011].
class RandomStream {
 public:
  RandomStream(const StreamKey& key, std::uint32_t sample);

  /// Next 64 random bits.
  std::uint64_t bits();

  /// Next uniform deviate in the open interval (0, 1), 52 bits: never 0 and never 1, so a quantile is always finite.
  double uniform();

 private:
  std::array<std::uint32_t, 2> key_;
  std::array<std::uint32_t, 4> counter_;
  std::array<std::uint64_t, 2> buffer_{};
  int next_ = 2;
};

}  // namespace mottle
