// 128-bit checksums, to find out whether bytes have changed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace mottle {

/// 128 bits; two different inputs share them by accident once in 3e38. No protection against malice.
using Digest = std::array<std::uint64_t, 2>;

/// 32 hexadecimal digits.
std::string hexadecimal(const Digest& digest);

/// XXH3's 128-bit hash of bytes that are all there.
Digest digest_of(std::string_view bytes);

/// XXH3's 128-bit hash of bytes that come piece by piece; where the pieces end makes no difference.
class Checksum {
 public:
  Checksum();
  Checksum(Checksum&&) noexcept;
  Checksum& operator=(Checksum&&) noexcept;
  ~Checksum();

  void add(const void* bytes, std::size_t size);
  void add(std::string_view text) { add(text.data(), text.size()); }

  /// Of all bytes so far.
  Digest digest() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mottle
