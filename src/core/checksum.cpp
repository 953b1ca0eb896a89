#include "mottle/core/checksum.hpp"

#include <fmt/format.h>

#include <new>

#define XXH_INLINE_ALL  // nothing to link, and nothing that could clash with another copy of the library
#include <xxhash.h>

namespace mottle {

std::string hexadecimal(const Digest& digest) {
  return fmt::format("{:016x}{:016x}", digest[0], digest[1]);
}

Digest digest_of(std::string_view bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return {hash.high64, hash.low64};
}

struct Checksum::State {
  State() {
    if (xxh == nullptr) throw std::bad_alloc();
    XXH3_128bits_reset(xxh);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { XXH3_freeState(xxh); }

  XXH3_state_t* xxh = XXH3_createState();
};

Checksum::Checksum() : state_(std::make_unique<State>()) {}
Checksum::Checksum(Checksum&&) noexcept = default;
Checksum& Checksum::operator=(Checksum&&) noexcept = default;
Checksum::~Checksum() = default;

void Checksum::add(const void* bytes, std::size_t size) {
  if (size > 0) XXH3_128bits_update(state_->xxh, bytes, size);
}

Digest Checksum::digest() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_->xxh);
  return {hash.high64, hash.low64};
}

}  // namespace mottle
