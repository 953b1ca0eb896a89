// MATLAB files (.mat, versions 4, 5 and 7.3): variables that are real numbers or lists of texts.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace mottle {

/// One variable.
struct MatVariable {
  std::vector<std::size_t> sizes = {};  ///< of each dimension, at least two
  std::vector<double> numbers = {};     ///< the first dimension runs fastest
  std::vector<std::string> texts = {};  ///< of a cell array or a character array; then there are no numbers
};

/// Variables by name. Structures, objects (tables, strings), sparse and complex arrays are left out.
///
/// @throws InvalidInput  no such file
/// @throws FormatError   not a MATLAB file, a variable that cannot be read
std::map<std::string, MatVariable> read_mat(const std::string& file);

}  // namespace mottle
