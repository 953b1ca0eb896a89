// Version 7.3: datasets of an HDF5 file, with MATLAB's class of each in an attribute.
#include <array>

#include "formats/matrices/hdf5_file.hpp"
#include "formats/matrices/mat_readers.hpp"

namespace mottle::formats {
namespace {

/// MATLAB's class of a dataset; "" where none is said.
std::string class_of(const Hdf5Dataset& set) {
  constexpr std::size_t k_longest = 64;
  if (H5Aexists(set.id, "MATLAB_class") <= 0) return {};
  const Hdf5Handle attribute(H5Aopen(set.id, "MATLAB_class", H5P_DEFAULT), H5Aclose);
  const Hdf5Handle type(H5Aget_type(attribute), H5Tclose);
  const Hdf5Handle space(H5Aget_space(attribute), H5Sclose);
  const bool is_text = H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0 &&
                       H5Tget_size(type) <= k_longest && H5Sget_simple_extent_npoints(space) == 1;
  std::array<char, k_longest + 1> text = {};
  if (!is_text || H5Aread(attribute, type, text.data()) < 0) return {};
  return text.data();
}

bool is_numeric(std::string_view name) {
  for (const std::string_view known :
       {"", "double", "single", "logical", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64"}) {
    if (name == known) return true;
  }
  return false;
}

class Hdf5Variables {
 public:
  Hdf5Variables(const Hdf5File& file, MatBudget& budget) : file_(file), budget_(budget) {}

  MatVariable read(const Hdf5Dataset& set) const {
    MatVariable variable{.sizes = sizes_of(set)};
    const std::string array_class = class_of(set);
    if (set.count == 0 || H5Aexists(set.id, "MATLAB_empty") > 0) return variable;
    if (array_class == "char") {
      variable.texts = rows_of(set);
    } else if (array_class == "cell" && set.type == H5T_REFERENCE) {
      variable.texts = cells_of(set);
    } else if (is_numeric(array_class) && set.holds_real_numbers()) {
      variable.numbers = numbers_of(set);
    }
    return variable;
  }

 private:
  /// MATLAB's first dimension is HDF5's last.
  static std::vector<std::size_t> sizes_of(const Hdf5Dataset& set) {
    std::vector<std::size_t> sizes(set.shape.rbegin(), set.shape.rend());
    while (sizes.size() < 2) sizes.push_back(1);
    return sizes;
  }

  std::vector<double> numbers_of(const Hdf5Dataset& set) const {
    budget_.take(set.count * sizeof(double));
    return file_.read<double>(set, H5T_NATIVE_DOUBLE);
  }

  std::vector<std::string> rows_of(const Hdf5Dataset& set) const {
    if (!set.holds_real_numbers()) return {};
    const std::vector<std::size_t> sizes = sizes_of(set);
    budget_.take(sizes[0] * sizeof(std::string));
    return character_rows(sizes, numbers_of(set));
  }

  /// The first row of each cell; none at all where a cell is no text.
  std::vector<std::string> cells_of(const Hdf5Dataset& set) const {
    budget_.take(set.count * (sizeof(hobj_ref_t) + sizeof(std::string)));
    std::vector<std::string> texts;
    for (const hobj_ref_t reference : file_.read<hobj_ref_t>(set, H5T_STD_REF_OBJ)) {
      const Hdf5Dataset cell = file_.open(reference, set.path);
      if (class_of(cell) != "char") return {};
      const bool is_empty = cell.count == 0 || H5Aexists(cell.id, "MATLAB_empty") > 0;
      const std::vector<std::string> rows = is_empty ? std::vector<std::string>() : rows_of(cell);
      texts.push_back(rows.empty() ? "" : rows.front());
    }
    return texts;
  }

  const Hdf5File& file_;
  MatBudget& budget_;
};

}  // namespace

MatVariables parse_mat_hdf5(std::string_view bytes, MatBudget& budget) {
  const Hdf5File file(bytes, budget.file());
  const Hdf5Variables reader(file, budget);
  MatVariables variables;
  for (const std::string& name : file.root_names()) {
    if (!file.has_dataset(name)) continue;  // structures, sparse arrays, and where cells lie
    keep(variables, name, reader.read(file.open(name)));
  }
  return variables;
}

}  // namespace mottle::formats
