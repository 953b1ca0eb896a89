// Values as bytes of this machine, for records in files and messages between ranks.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace mottle {

inline void append_bytes(std::string& bytes, const void* data, std::size_t size) {
  bytes.append(static_cast<const char*>(data), size);
}

template <typename Value>
void append_value(std::string& bytes, const Value& value) {
  append_bytes(bytes, &value, sizeof(value));
}

/// With its length in front.
inline void append_text(std::string& bytes, std::string_view text) {
  append_value(bytes, static_cast<std::int64_t>(text.size()));
  bytes += text;
}

/// Reads values from bytes, front to back; says whether they were all there.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <typename Value>
  bool read(Value& value) {
    return copy(&value, sizeof(value));
  }
  bool copy(void* destination, std::size_t size) {
    if (bytes_.size() < size) return false;
    if (size > 0) std::memcpy(destination, bytes_.data(), size);
    bytes_.remove_prefix(size);
    return true;
  }
  /// As append_text() wrote it.
  bool read_text(std::string& text) {
    std::int64_t size = 0;
    if (!read(size) || size < 0 || static_cast<std::size_t>(size) > left()) return false;
    text.assign(bytes_.data(), static_cast<std::size_t>(size));
    bytes_.remove_prefix(text.size());
    return true;
  }
  std::size_t left() const { return bytes_.size(); }

 private:
  std::string_view bytes_;
};

}  // namespace mottle
