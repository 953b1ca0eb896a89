// MATLAB files (.mat, versions 4, 5 and 7.3): variables that are real numbers or lists of texts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::formats {

/// One variable.
struct MatVariable {
  std::vector<std::size_t> sizes = {};  ///< of each dimension, at least two
  std::vector<double> numbers = {};     ///< the first dimension runs fastest
  std::vector<std::string> texts = {};  ///< of a cell array or a character array; then there are no numbers
};

/// Most bytes that a file, what it unpacks to and the numbers in it may take each: 1 GiB.
inline constexpr std::uint64_t k_max_mat_bytes = std::uint64_t{1} << 30;

/// Variables by name. Structures, objects (tables, strings), sparse and complex arrays are left out, and so are cell
/// arrays that hold anything but texts.
///
/// @throws FormatError   not a MATLAB file, a variable that cannot be read or claims more than the file holds
std::map<std::string, MatVariable> parse_mat(std::string_view bytes, const std::string& file);

/// The same of a file.
/// @throws InvalidInput  no such file, larger than the limit
std::map<std::string, MatVariable> read_mat(const std::string& file);

}  // namespace mottle::formats
