#include "mottle/formats/mat.hpp"

#include <matio.h>

#include <memory>

#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"

namespace mottle {
namespace {

struct Close {
  void operator()(mat_t* file) const { Mat_Close(file); }
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};

template <typename Number>
void append(const matvar_t& variable, std::vector<double>& numbers) {
  const auto* data = static_cast<const Number*>(variable.data);
  const std::size_t count = variable.nbytes / sizeof(Number);
  for (std::size_t k = 0; k < count; ++k) numbers.push_back(static_cast<double>(data[k]));
}

/// Whether the variable is an array of real numbers.
bool read_numbers(const matvar_t& variable, std::vector<double>& numbers) {
  if (variable.isComplex != 0 || variable.data == nullptr) return false;
  switch (variable.data_type) {
    case MAT_T_DOUBLE:
      append<double>(variable, numbers);
      return true;
    case MAT_T_SINGLE:
      append<float>(variable, numbers);
      return true;
    case MAT_T_INT32:
      append<mat_int32_t>(variable, numbers);
      return true;
    case MAT_T_UINT8:
      append<mat_uint8_t>(variable, numbers);
      return true;
    case MAT_T_INT16:
      append<mat_int16_t>(variable, numbers);
      return true;
    case MAT_T_UINT16:
      append<mat_uint16_t>(variable, numbers);
      return true;
    default:
      return false;
  }
}

/// Rows of a character array, without the blanks behind.
std::vector<std::string> rows_of(const matvar_t& variable) {
  std::vector<std::string> rows;
  const std::size_t width = variable.data_size > 0 ? static_cast<std::size_t>(variable.data_size) : 1;
  if (variable.rank != 2 || variable.data == nullptr) return rows;
  const auto* bytes = static_cast<const unsigned char*>(variable.data);
  const std::size_t height = variable.dims[0];
  if (height * variable.dims[1] * width > variable.nbytes) return rows;
  for (std::size_t row = 0; row < height; ++row) {
    std::string text;
    for (std::size_t k = 0; k < variable.dims[1]; ++k) {
      text += static_cast<char>(bytes[(row + k * height) * width]);  // names are ASCII: the low byte comes first
    }
    rows.push_back(text.substr(0, text.find_last_not_of(std::string_view(" \0", 2)) + 1));
  }
  return rows;
}

std::vector<std::string> cells_of(const matvar_t& variable) {
  std::vector<std::string> texts;
  const std::size_t count = variable.data_size > 0 ? variable.nbytes / static_cast<std::size_t>(variable.data_size) : 0;
  for (std::size_t k = 0; k < count && variable.data != nullptr; ++k) {
    const matvar_t* cell = static_cast<matvar_t* const*>(variable.data)[k];
    if (cell == nullptr || cell->class_type != MAT_C_CHAR) return {};
    const std::vector<std::string> rows = rows_of(*cell);
    texts.push_back(rows.empty() ? "" : rows.front());
  }
  return texts;
}

}  // namespace

std::map<std::string, MatVariable> read_mat(const std::string& file) {
  read_file(file);                               // says why where it cannot be read
  Mat_LogInitFunc("mottle", [](int, char*) {});  // else it prints
  const std::unique_ptr<mat_t, Close> opened(Mat_Open(file.c_str(), MAT_ACC_RDONLY));
  if (!opened) throw FormatError(file, 0, "is no MATLAB file (versions 4, 5 to 7 and 7.3 are read)");
  std::map<std::string, MatVariable> variables;
  while (std::unique_ptr<matvar_t, Close> next{Mat_VarReadNext(opened.get())}) {
    MatVariable variable;
    variable.sizes.assign(next->dims, next->dims + next->rank);
    const bool is_cell = next->class_type == MAT_C_CELL;
    if (is_cell || next->class_type == MAT_C_CHAR) {
      variable.texts = is_cell ? cells_of(*next) : rows_of(*next);
      if (variable.texts.empty()) continue;
    } else if (next->class_type == MAT_C_STRUCT || next->class_type == MAT_C_SPARSE ||
               !read_numbers(*next, variable.numbers)) {
      continue;
    }
    std::size_t count = 1;
    for (const std::size_t size : variable.sizes) count *= size;
    if (!variable.numbers.empty() && count != variable.numbers.size()) {
      throw FormatError(
          file, 0,
          fmt::format("variable '{}' holds {} numbers where {} should be", next->name, variable.numbers.size(), count));
    }
    if (next->name != nullptr) variables.emplace(next->name, std::move(variable));
  }
  if (variables.empty()) throw FormatError(file, 0, "holds no variable that is an array of numbers or texts");
  return variables;
}

}  // namespace mottle
