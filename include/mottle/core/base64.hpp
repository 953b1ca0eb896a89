// Bytes as text, for arrays inside JSON and XML.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace mottle {

/// Base64 with padding [RFC 4648, section 4].
std::string base64(std::span<const std::byte> bytes);

/// The bytes of an array of plain numbers, in this machine's order.
template <typename Number>
std::string base64_of(std::span<const Number> numbers) {
  return base64(std::as_bytes(numbers));
}

}  // namespace mottle
