// Matrices in HDF5: a square dataset, or a group in one of SciPy's layouts.
#include <algorithm>
#include <limits>

#include "formats/matrices/hdf5_file.hpp"
#include "formats/matrices/matrix_readers.hpp"
#include "mottle/core/text.hpp"

namespace mottle::formats {
namespace {

template <typename Number>
std::vector<Number> read_vector(const Hdf5File& file, const std::string& path, hid_t memory_type) {
  const Hdf5Dataset set = file.open(path);
  if (!set.holds_real_numbers()) file.fail(fmt::format("'{}' does not hold real numbers", path));
  if (set.shape.size() > 2) file.fail(fmt::format("'{}' has {} dimensions, not 1 or 2", path, set.shape.size()));
  if (set.count == 0) file.fail(fmt::format("'{}' holds no data", path));
  return file.read<Number>(set, memory_type);
}

std::vector<double> read_numbers(const Hdf5File& file, const std::string& path) {
  return read_vector<double>(file, path, H5T_NATIVE_DOUBLE);
}

std::vector<long long> read_whole_numbers(const Hdf5File& file, const std::string& path) {
  return read_vector<long long>(file, path, H5T_NATIVE_LLONG);
}

SymmetricMatrix read_dense(const Hdf5File& file, const std::string& name, const std::string& path) {
  const Hdf5Dataset set = file.open(path);
  if (!set.holds_real_numbers()) file.fail(fmt::format("'{}' does not hold real numbers", path));
  if (set.shape.size() != 2)
    file.fail(fmt::format("'{}' is not a matrix: its dimensions are {}", path, set.shape.size()));
  if (set.count == 0) file.fail(fmt::format("'{}' holds no data", path));
  SymmetricBuilder builder(name);
  const std::uint64_t rows = set.shape[0];
  builder.set_size(0, static_cast<long long>(rows), static_cast<long long>(set.shape[1]));
  constexpr std::uint64_t k_numbers_at_once = std::uint64_t{1} << 20;  // most of a large dense matrix are zeros
  const std::uint64_t rows_at_once = std::max<std::uint64_t>(1, k_numbers_at_once / rows);
  std::vector<double> values;
  for (std::uint64_t first = 0; first < rows; first += rows_at_once) {
    file.read_rows(set, first, std::min(rows_at_once, rows - first), values);
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (values[k] == 0.0) continue;
      builder.add(0, static_cast<long long>(first + k / rows) + 1, static_cast<long long>(k % rows) + 1, values[k]);
    }
  }
  return {.lower = builder.finish()};
}

/// Counted from 1, in place of 0. The largest number stays: no matrix has such a row.
long long number_of(long long index) {
  return index == std::numeric_limits<long long>::max() ? index : index + 1;
}

SymmetricMatrix read_sparse(const Hdf5File& file, const std::string& name, const std::string& group) {
  const std::vector<double> values = read_numbers(file, group + "/data");
  const bool is_compressed = file.has(group + "/indptr");
  const std::vector<long long> columns = read_whole_numbers(file, group + (is_compressed ? "/indices" : "/col"));
  const std::vector<long long> rows = read_whole_numbers(file, group + (is_compressed ? "/indptr" : "/row"));
  const bool fits = columns.size() == values.size() && (is_compressed ? !rows.empty() : rows.size() == values.size());
  if (!fits) file.fail(fmt::format("'{}': data, columns and rows do not have as many numbers as they should", group));
  SymmetricBuilder builder(name);
  if (!is_compressed) {
    builder.grow();
    for (std::size_t k = 0; k < values.size(); ++k) {
      builder.add(0, number_of(rows[k]), number_of(columns[k]), values[k]);
    }
    return {.lower = builder.finish()};
  }
  const auto size = static_cast<long long>(rows.size()) - 1;
  builder.set_size(0, size, size);
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    const bool is_sound =
        rows[i] >= 0 && rows[i] <= rows[i + 1] && rows[i + 1] <= static_cast<long long>(values.size());
    if (!is_sound) file.fail(fmt::format("'{}/indptr' is not ascending from 0 to the number of entries", group));
    for (auto k = static_cast<std::size_t>(rows[i]); k < static_cast<std::size_t>(rows[i + 1]); ++k) {
      builder.add(0, static_cast<long long>(i) + 1, number_of(columns[k]), values[k]);
    }
  }
  return {.lower = builder.finish()};
}

}  // namespace

SymmetricMatrix parse_hdf5_matrix(std::string_view bytes, const std::string& file, const std::string& name) {
  const Hdf5File opened(bytes, file);
  const std::vector<std::string> known = opened.root_names();
  std::string path = name;
  if (name.empty()) path = known[choose_matrix(file, "", known)];
  require(opened.has("/" + path), "{}: {}", file, unknown_name_message("matrix", path, known));
  if (opened.has(fmt::format("/{}/data", path))) return read_sparse(opened, file, "/" + path);
  return read_dense(opened, file, "/" + path);
}

}  // namespace mottle::formats
