// An HDF5 file in memory. Sizes that it states are checked against the bytes that it stores before memory is allocated,
// and nothing outside of it is read: no external links, external storage or virtual datasets.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mottle/core/process_mutex.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats {

/// An HDF5 identifier, closed where it goes out of use.
class Hdf5Handle {
 public:
  Hdf5Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(Hdf5Handle&&) = delete;
  ~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor): what every call of the library takes

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// An open dataset whose extents its file can hold.
struct Hdf5Dataset {
  std::string path;  ///< for messages
  Hdf5Handle id;
  Hdf5Handle space;
  std::vector<hsize_t> shape;  ///< one or two extents, or more
  std::uint64_t count = 0;     ///< product of the extents
  H5T_class_t type = H5T_NO_CLASS;

  bool holds_real_numbers() const { return type == H5T_INTEGER || type == H5T_FLOAT; }
};

/// One at a time in a process, since the library has a lock of its own, which a forked process would wait for: another
/// thread waits until this one's object has gone out of use, and this thread must not open a second.
class Hdf5File {
 public:
  /// @param bytes  the file; they outlive this object
  /// @param name   for messages
  /// @throws FormatError  no HDF5 file
  Hdf5File(std::string_view bytes, std::string name);

  [[noreturn]] void fail(const std::string& message) const;

  /// Names in the root, in alphabetical order.
  std::vector<std::string> root_names() const;
  bool has(const std::string& path) const;
  bool has_dataset(const std::string& path) const;

  /// @throws FormatError  no dataset; one of another file; extents larger than what is stored can hold
  Hdf5Dataset open(const std::string& path) const;
  /// The dataset that an object reference names.
  Hdf5Dataset open(hobj_ref_t reference, const std::string& path) const;

  /// All entries, the last extent running fastest.
  template <typename Number>
  std::vector<Number> read(const Hdf5Dataset& set, hid_t memory_type) const {
    std::vector<Number> values(set.count);
    if (set.count > 0) read_into(set, memory_type, H5S_ALL, H5S_ALL, values.data());
    return values;
  }
  /// Rows of a matrix of real numbers, `set.shape[1]` numbers each.
  void read_rows(const Hdf5Dataset& set, std::uint64_t first, std::uint64_t count, std::vector<double>& values) const;

 private:
  Hdf5Dataset checked(hid_t id, const std::string& path) const;
  void read_into(const Hdf5Dataset& set, hid_t memory_type, hid_t memory, hid_t selection, void* values) const;
  void refuse_other_files() const;

  std::unique_lock<ProcessMutex> lock_;
  std::string name_;
  std::uint64_t size_;
  mutable std::string other_file_ = {};  ///< that an external link names; noted by the library's call
  Hdf5Handle link_access_;
  Hdf5Handle dataset_access_;
  Hdf5Handle file_;
};

}  // namespace mottle::formats
