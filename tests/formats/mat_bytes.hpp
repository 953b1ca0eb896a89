// Makes MATLAB files of version 5 byte by byte, sound ones and others.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <string>
#include <vector>

namespace mottle::test {

template <typename Number>
std::string bytes_of(const std::vector<Number>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)};
}

inline std::string mat_tag(std::uint32_t type, std::size_t size) {
  return bytes_of(std::vector<std::uint32_t>{type, static_cast<std::uint32_t>(size)});
}

inline std::string mat_element(std::uint32_t type, const std::string& data) {
  const std::size_t padding = type == 15 ? 0 : (8 - data.size() % 8) % 8;
  return mat_tag(type, data.size()) + data + std::string(padding, '\0');
}

inline std::string mat_array(std::uint32_t array_class, const std::vector<std::uint32_t>& sizes,
                             const std::string& name, const std::string& content) {
  const std::string flags = bytes_of(std::vector<std::uint32_t>{array_class, 0});
  return mat_element(14, mat_element(6, flags) + mat_element(5, bytes_of(sizes)) + mat_element(1, name) + content);
}

inline std::string mat_file(const std::string& elements, char version = 1) {
  return std::string(124, ' ') + '\0' + version + "IM" + elements;
}

/// An element packed by zlib whose tag says `size` bytes, whatever it has.
inline std::string mat_packed(std::string element, std::uint32_t size) {
  element.replace(4, 4, bytes_of(std::vector<std::uint32_t>{size}));
  std::string packed(compressBound(element.size()), '\0');
  uLongf packed_size = packed.size();
  compress(reinterpret_cast<Bytef*>(packed.data()), &packed_size, reinterpret_cast<const Bytef*>(element.data()),
           element.size());
  packed.resize(packed_size);
  return mat_element(15, packed);
}

}  // namespace mottle::test
