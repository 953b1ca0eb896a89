// Matrices in HDF5: a square dataset, or a group in one of SciPy's layouts.
#include <hdf5.h>

#include <utility>

#include "matrix_readers.hpp"
#include "mottle/core/text.hpp"

namespace mottle {
namespace {

/// An HDF5 identifier, closed where it goes out of use.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  Handle& operator=(Handle&&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor): what every call of the library takes

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

class File {
 public:
  explicit File(const std::string& name)
      : name_(name), file_(H5Fopen(name.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose) {
    if (file_ < 0) fail("is not an HDF5 file that can be opened");
  }

  [[noreturn]] void fail(const std::string& message) const { throw FormatError(name_, 0, message); }
  hid_t id() const { return file_; }

  bool has(const std::string& path) const {
    // Each part of the path must be asked for.
    for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
      if (H5Lexists(file_, path.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
      if (end == std::string::npos) return true;
    }
  }

  /// A dataset of numbers; its extents into `shape`.
  template <typename Number>
  std::vector<Number> read(const std::string& path, hid_t type, std::vector<hsize_t>& shape) const {
    const Handle set(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
    if (set < 0) fail(fmt::format("'{}' is not a dataset", path));
    const Handle space(H5Dget_space(set), H5Sclose);
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank < 1 || rank > 2) fail(fmt::format("'{}' has {} dimensions, not 1 or 2", path, rank));
    const Handle kind(H5Dget_type(set), H5Tclose);
    const H5T_class_t found = H5Tget_class(kind);
    if (found != H5T_INTEGER && found != H5T_FLOAT) fail(fmt::format("'{}' does not hold real numbers", path));
    shape.assign(static_cast<std::size_t>(rank), 0);
    H5Sget_simple_extent_dims(space, shape.data(), nullptr);
    hsize_t count = 1;
    constexpr hsize_t k_most = hsize_t{1} << 31;
    for (const hsize_t extent : shape) count = extent > k_most ? k_most + 1 : count * extent;
    if (count > k_most) fail(fmt::format("'{}' holds more than {} numbers", path, k_most));
    // A file may claim an extent that it never wrote.
    if (H5Dget_storage_size(set) == 0 && count > 0) fail(fmt::format("'{}' holds no data", path));
    std::vector<Number> values(count);
    if (H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
      fail(fmt::format("'{}' cannot be read", path));
    }
    return values;
  }

  std::vector<double> numbers(const std::string& path) const {
    std::vector<hsize_t> shape;
    return read<double>(path, H5T_NATIVE_DOUBLE, shape);
  }
  std::vector<long long> whole_numbers(const std::string& path) const {
    std::vector<hsize_t> shape;
    return read<long long>(path, H5T_NATIVE_LLONG, shape);
  }

 private:
  std::string name_;
  Handle file_;
};

SymmetricMatrix read_dense(const File& file, const std::string& name, const std::string& path) {
  std::vector<hsize_t> shape;
  const std::vector<double> values = file.read<double>(path, H5T_NATIVE_DOUBLE, shape);
  if (shape.size() != 2) file.fail(fmt::format("'{}' is not a matrix: it has one dimension", path));
  SymmetricBuilder builder(name);
  const auto rows = static_cast<long long>(shape[0]);
  builder.set_size(0, rows, static_cast<long long>(shape[1]));
  for (long long i = 0; i < rows; ++i) {
    for (long long j = 0; j < rows; ++j) {
      const double value = values[static_cast<std::size_t>(i * rows + j)];
      if (value != 0.0) builder.add(0, i + 1, j + 1, value);
    }
  }
  return {.lower = builder.finish()};
}

SymmetricMatrix read_sparse(const File& file, const std::string& name, const std::string& group) {
  const std::vector<double> values = file.numbers(group + "/data");
  const bool is_compressed = file.has(group + "/indptr");
  const std::vector<long long> columns = file.whole_numbers(group + (is_compressed ? "/indices" : "/col"));
  const std::vector<long long> rows = file.whole_numbers(group + (is_compressed ? "/indptr" : "/row"));
  const bool fits = columns.size() == values.size() && (is_compressed ? !rows.empty() : rows.size() == values.size());
  if (!fits) file.fail(fmt::format("'{}': data, columns and rows do not have as many numbers as they should", group));
  SymmetricBuilder builder(name);
  if (!is_compressed) {
    builder.grow();
    for (std::size_t k = 0; k < values.size(); ++k) builder.add(0, rows[k] + 1, columns[k] + 1, values[k]);
    return {.lower = builder.finish()};
  }
  const auto size = static_cast<long long>(rows.size()) - 1;
  builder.set_size(0, size, size);
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    const bool is_sound =
        rows[i] >= 0 && rows[i] <= rows[i + 1] && rows[i + 1] <= static_cast<long long>(values.size());
    if (!is_sound) file.fail(fmt::format("'{}/indptr' is not ascending from 0 to the number of entries", group));
    for (auto k = static_cast<std::size_t>(rows[i]); k < static_cast<std::size_t>(rows[i + 1]); ++k) {
      builder.add(0, static_cast<long long>(i) + 1, columns[k] + 1, values[k]);
    }
  }
  return {.lower = builder.finish()};
}

/// Names of what stands in the root.
std::vector<std::string> root_names(const File& file) {
  std::vector<std::string> names;
  const auto note = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  H5Literate(file.id(), H5_INDEX_NAME, H5_ITER_INC, nullptr, note, &names);
  return names;
}

}  // namespace

SymmetricMatrix read_hdf5_matrix(const std::string& file, const std::string& name) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // faults are told by exceptions, not on stderr
  const File opened(file);
  const std::vector<std::string> known = root_names(opened);
  std::string path = name;
  if (name.empty()) path = known[choose_matrix(file, "", known)];
  require(opened.has("/" + path), "{}: {}", file, unknown_name_message("matrix", path, known));
  if (opened.has(fmt::format("/{}/data", path))) return read_sparse(opened, file, "/" + path);
  return read_dense(opened, file, "/" + path);
}

}  // namespace mottle
