#include "mottle/core/base64.hpp"

#include <cstddef>

namespace mottle {

std::string base64(std::span<const std::byte> bytes) {
  static constexpr char k_letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const auto byte = [&](std::size_t k) { return k < left ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0U; };
    const std::uint32_t group = (byte(0) << 16) | (byte(1) << 8) | byte(2);
    text += k_letters[group >> 18];
    text += k_letters[(group >> 12) & 63];
    text += left > 1 ? k_letters[(group >> 6) & 63] : '=';
    text += left > 2 ? k_letters[group & 63] : '=';
  }
  return text;
}

}  // namespace mottle
