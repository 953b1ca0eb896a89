// One function a version of MATLAB's files; mat.cpp chooses among them.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/formats/matrices/mat.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats {

using MatVariables = std::map<std::string, MatVariable>;

/// What the variables of one file may take in memory: small files can claim, or unpack to, any size.
class MatBudget {
 public:
  explicit MatBudget(std::string file) : file_(std::move(file)) {}
  const std::string& file() const { return file_; }
  [[noreturn]] void fail(const std::string& message) const;
  /// @throws FormatError  more bytes than a file's variables may take
  void take(std::uint64_t bytes);

 private:
  std::string file_;
  std::uint64_t left_ = k_max_mat_bytes;
};

/// How numbers lie in a file.
enum class MatNumber { int8, uint8, int16, uint16, int32, uint32, int64, uint64, single_precision, double_precision };
std::size_t size_of(MatNumber type);
/// The numbers that fill `bytes`.
std::vector<double> mat_numbers(std::string_view bytes, MatNumber type, bool is_swapped, MatBudget& budget);

/// Product of the sizes, or more than `limit` where it is larger.
std::uint64_t element_count(const std::vector<std::size_t>& sizes, std::uint64_t limit);
/// Rows of a character array of two dimensions, without the blanks behind; `codes` run down the columns.
std::vector<std::string> character_rows(const std::vector<std::size_t>& sizes, const std::vector<double>& codes);
/// Keeps the first variable of a name; those without name or content are left out.
void keep(MatVariables& variables, const std::string& name, MatVariable variable);

MatVariables parse_mat_level4(std::string_view bytes, MatBudget& budget);
/// Versions 5 to 7: elements with a tag each, packed by zlib or not.
MatVariables parse_mat_level5(std::string_view bytes, MatBudget& budget);
/// Version 7.3: an HDF5 file behind 512 bytes.
MatVariables parse_mat_hdf5(std::string_view bytes, MatBudget& budget);

}  // namespace mottle::formats
