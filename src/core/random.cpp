#include "mottle/core/random.hpp"

#include <Random123/philox.h>

namespace mottle {

RandomStream::RandomStream(const StreamKey& key, std::uint32_t sample)
    : key_{static_cast<std::uint32_t>(key.seed), static_cast<std::uint32_t>(key.seed >> 32U)},
      counter_{0, sample, key.iteration, static_cast<std::uint32_t>(key.purpose)} {}

std::uint64_t RandomStream::bits() {
  if (next_ == 2) {
    const r123::Philox4x32::ctr_type counter{{counter_[0], counter_[1], counter_[2], counter_[3]}};
    const r123::Philox4x32::key_type key{{key_[0], key_[1]}};
    const r123::Philox4x32::ctr_type words = r123::Philox4x32{}(counter, key);
    buffer_ = {(std::uint64_t{words[1]} << 32U) | words[0], (std::uint64_t{words[3]} << 32U) | words[2]};
    ++counter_[0];
    next_ = 0;
  }
  return buffer_[static_cast<std::size_t>(next_++)];
}

double RandomStream::uniform() {
  constexpr double k_spacing = 1.0 / 9007199254740992.0;  // 2^-53
  // The half step keeps both ends out; (2^53 - 1 + 0.5) 2^-53 would round to 1, so 52 bits carry the half.
  const std::uint64_t word = bits() >> 12U;
  return (static_cast<double>(word) + 0.5) * (2.0 * k_spacing);
}

}  // namespace mottle
