#include "formats/matrices/hdf5_file.hpp"

#include <algorithm>
#include <cstddef>

#include "mottle/core/error.hpp"

namespace mottle::formats {
namespace {

/// The bytes lent to the library's driver of files in memory, which would copy them twice by itself.
struct LentBytes {
  void* bytes;

  static void* give(std::size_t, H5FD_file_image_op_t, void* lent) { return static_cast<LentBytes*>(lent)->bytes; }
  static void* copy(void* to, const void*, std::size_t, H5FD_file_image_op_t, void*) { return to; }
  static void* refuse_to_grow(void*, std::size_t, H5FD_file_image_op_t, void*) { return nullptr; }
  static herr_t keep(void*, H5FD_file_image_op_t, void*) { return 0; }
  static void* same(void* lent) { return lent; }
  static herr_t forget(void*) { return 0; }
};

Hdf5Handle open_in_memory(std::string_view bytes) {
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  constexpr std::size_t k_increment = 65536;
  H5Pset_fapl_core(access, k_increment, false);
  LentBytes lent{const_cast<char*>(bytes.data())};  // NOLINT(cppcoreguidelines-pro-type-const-cast): opened to read
  H5FD_file_image_callbacks_t callbacks = {LentBytes::give,
                                           LentBytes::copy,
                                           LentBytes::refuse_to_grow,
                                           LentBytes::keep,
                                           LentBytes::same,
                                           LentBytes::forget,
                                           &lent};
  H5Pset_file_image_callbacks(access, &callbacks);
  H5Pset_file_image(access, lent.bytes, bytes.size());
  // A name that no file can have, and no other one had: the library takes two files of one name for one.
  static std::uint64_t opened = 0;
  return {H5Fopen(fmt::format("/dev/null/in-memory-{}", ++opened).c_str(), H5F_ACC_RDONLY, access), H5Fclose};
}

ProcessMutex& library_mutex() {
  static constinit ProcessMutex mutex;
  return mutex;
}

herr_t note_other_file(const char*, const char*, const char* file, const char*, unsigned*, hid_t, void* noted) {
  static_cast<std::string*>(noted)->assign(file);
  return -1;
}

Hdf5Handle access_within(hid_t kind, std::string* noted) {
  Hdf5Handle access(H5Pcreate(kind), H5Pclose);
  H5Pset_elink_cb(access, note_other_file, noted);
  return access;
}

/// Bytes that a dataset's storage can become: deflate packs 1032 bytes into one at best, and chunks that were never
/// written count as if they had been packed so.
std::uint64_t max_bytes(hid_t set, hid_t creation, std::uint64_t file_size) {
  constexpr std::uint64_t k_largest_ratio = 1032;
  const std::uint64_t stored = std::min<std::uint64_t>(H5Dget_storage_size(set), file_size);
  return H5Pget_layout(creation) == H5D_CHUNKED ? k_largest_ratio * stored : stored;
}

/// Product, or no more than a bit beyond `limit`.
std::uint64_t bounded_product(const std::vector<hsize_t>& extents, std::uint64_t limit) {
  std::uint64_t product = 1;
  for (const hsize_t extent : extents) {
    if (extent == 0) return 0;
    product = extent > limit / product ? limit + 1 : product * extent;
    if (product > limit) return product;
  }
  return product;
}

}  // namespace

Hdf5File::Hdf5File(std::string_view bytes, std::string name)
    : lock_(library_mutex()),
      name_(std::move(name)),
      size_(bytes.size()),
      link_access_(access_within(H5P_LINK_ACCESS, &other_file_)),
      dataset_access_(access_within(H5P_DATASET_ACCESS, &other_file_)),
      file_(((void)H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr), open_in_memory(bytes))) {
  if (file_ < 0) fail("is not an HDF5 file that can be opened");
}

void Hdf5File::fail(const std::string& message) const {
  throw FormatError(name_, 0, message);
}

void Hdf5File::refuse_other_files() const {
  if (other_file_.empty()) return;
  fail(
      fmt::format("a link leads to the file '{}'; only what a file holds itself is read: copy it in (h5copy, or "
                  "h5repack --merge)",
                  std::exchange(other_file_, {})));
}

std::vector<std::string> Hdf5File::root_names() const {
  std::vector<std::string> names;
  const auto note = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  H5Literate(file_, H5_INDEX_NAME, H5_ITER_INC, nullptr, note, &names);
  return names;
}

bool Hdf5File::has(const std::string& path) const {
  // Each part of the path must be asked for.
  for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
    const bool is_there = H5Lexists(file_, path.substr(0, end).c_str(), link_access_) > 0;
    refuse_other_files();
    if (!is_there) return false;
    if (end == std::string::npos) return true;
  }
}

bool Hdf5File::has_dataset(const std::string& path) const {
  const Hdf5Handle object(H5Oopen(file_, path.c_str(), link_access_), H5Oclose);
  refuse_other_files();
  return object >= 0 && H5Iget_type(object) == H5I_DATASET;
}

Hdf5Dataset Hdf5File::open(const std::string& path) const {
  const hid_t id = H5Dopen2(file_, path.c_str(), dataset_access_);
  refuse_other_files();
  return checked(id, path);
}

Hdf5Dataset Hdf5File::open(hobj_ref_t reference, const std::string& path) const {
  Hdf5Handle object(H5Rdereference2(file_, H5P_DEFAULT, H5R_OBJECT, &reference), H5Oclose);
  if (object < 0 || H5Iget_type(object) != H5I_DATASET) fail(fmt::format("'{}' refers to what is no dataset", path));
  H5Iinc_ref(object);
  return checked(object, path);
}

Hdf5Dataset Hdf5File::checked(hid_t id, const std::string& path) const {
  Hdf5Handle opened(id, H5Dclose);
  if (opened < 0) fail(fmt::format("'{}' is not a dataset", path));
  Hdf5Handle space(H5Dget_space(opened), H5Sclose);
  const Hdf5Handle kind(H5Dget_type(opened), H5Tclose);
  const Hdf5Handle creation(H5Dget_create_plist(opened), H5Pclose);
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0 || kind < 0 || creation < 0) fail(fmt::format("'{}' cannot be read", path));
  const bool is_elsewhere = H5Pget_layout(creation) == H5D_VIRTUAL || H5Pget_external_count(creation) != 0;
  if (is_elsewhere) {
    fail(
        fmt::format("the numbers of '{}' lie in other files; only what a file holds itself is read: copy them in "
                    "(h5repack)",
                    path));
  }
  Hdf5Dataset set{.path = path, .id = std::move(opened), .space = std::move(space), .shape = {}};
  set.shape.assign(static_cast<std::size_t>(rank), 0);
  H5Sget_simple_extent_dims(set.space, set.shape.data(), nullptr);
  set.type = H5Tget_class(kind);
  const std::uint64_t limit = max_bytes(set.id, creation, size_) / std::max<std::size_t>(H5Tget_size(kind), 1);
  set.count = H5Sget_simple_extent_type(set.space) == H5S_NULL ? 0 : bounded_product(set.shape, limit);
  std::vector<hsize_t> chunk(H5Pget_layout(creation) == H5D_CHUNKED ? set.shape.size() : 0);
  if (!chunk.empty()) H5Pget_chunk(creation, rank, chunk.data());
  if (set.count > limit || (set.count > 0 && bounded_product(chunk, limit) > limit)) {
    fail(fmt::format("'{}' claims more numbers than the {} bytes stored for it can hold", path,
                     H5Dget_storage_size(set.id)));
  }
  return set;
}

void Hdf5File::read_into(const Hdf5Dataset& set, hid_t memory_type, hid_t memory, hid_t selection, void* values) const {
  if (H5Dread(set.id, memory_type, memory, selection, H5P_DEFAULT, values) < 0) {
    fail(fmt::format("'{}' cannot be read", set.path));
  }
}

void Hdf5File::read_rows(const Hdf5Dataset& set, std::uint64_t first, std::uint64_t count,
                         std::vector<double>& values) const {
  const hsize_t start[2] = {first, 0};
  const hsize_t extent[2] = {count, set.shape[1]};
  values.resize(count * set.shape[1]);
  const Hdf5Handle memory(H5Screate_simple(2, extent, nullptr), H5Sclose);
  H5Sselect_hyperslab(set.space, H5S_SELECT_SET, start, nullptr, extent, nullptr);
  read_into(set, H5T_NATIVE_DOUBLE, memory, set.space, values.data());
}

}  // namespace mottle::formats
