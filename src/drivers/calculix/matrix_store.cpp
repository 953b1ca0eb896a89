#include "drivers/calculix/matrix_store.hpp"

#include <cstring>

#include "mottle/core/cache_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"

namespace mottle::drivers {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view k_mark = "mottle matrices 2\n";

CacheFolder matrices_in(const fs::path& folder) {
  return {folder, ".matrices", std::uintmax_t{2} << 30};
}

CacheFolder eigenvalues_in(const fs::path& folder) {
  return {folder, ".eigenvalues", std::uintmax_t{1} << 24};
}

template <typename Number>
void put(std::string& bytes, const Number* numbers, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(numbers), count * sizeof(Number));
}

/// Takes numbers off the front; throws InvalidInput where there are not so many.
template <typename Number>
void take(std::string_view& bytes, Number* numbers, std::size_t count) {
  require(bytes.size() / sizeof(Number) >= count, "too short");
  std::memcpy(numbers, bytes.data(), count * sizeof(Number));
  bytes.remove_prefix(count * sizeof(Number));
}

void put_matrix(std::string& bytes, const SparseMatrix& lower) {
  const std::uint64_t sizes[] = {static_cast<std::uint64_t>(lower.rows()),
                                 static_cast<std::uint64_t>(lower.nonZeros())};
  put(bytes, sizes, 2);
  put(bytes, lower.outerIndexPtr(), static_cast<std::size_t>(lower.rows()) + 1);
  put(bytes, lower.innerIndexPtr(), static_cast<std::size_t>(lower.nonZeros()));
  put(bytes, lower.valuePtr(), static_cast<std::size_t>(lower.nonZeros()));
}

SparseMatrix take_matrix(std::string_view& bytes) {
  std::uint64_t sizes[2];
  take(bytes, sizes, 2);
  require(sizes[0] < bytes.size() && sizes[1] < bytes.size(), "too short");
  SparseMatrix lower(static_cast<Eigen::Index>(sizes[0]), static_cast<Eigen::Index>(sizes[0]));
  lower.resizeNonZeros(static_cast<Eigen::Index>(sizes[1]));
  take(bytes, lower.outerIndexPtr(), sizes[0] + 1);
  take(bytes, lower.innerIndexPtr(), sizes[1]);
  take(bytes, lower.valuePtr(), sizes[1]);
  return lower;
}

/// What was kept under the digest, without its head and its checksum. Throws Error: it is damaged.
std::string read_entry(const fs::path& path, const Digest& digest) {
  const std::string contents = read_file(path);
  std::string_view bytes = contents;
  require(bytes.starts_with(k_mark) && bytes.size() > k_mark.size() + sizeof(Digest), "too short");
  Digest written;
  std::memcpy(written.data(), bytes.data() + bytes.size() - sizeof written, sizeof written);
  bytes.remove_suffix(sizeof written);
  Checksum checksum;
  checksum.add(bytes);
  require(checksum.digest() == written, "damaged");
  bytes.remove_prefix(k_mark.size());
  Digest key;
  take(bytes, key.data(), key.size());
  require(key == digest, "made of something else");
  CacheFolder::touch(path);
  return std::string(bytes);
}

void keep_entry(const CacheFolder& cache, const Digest& digest, const std::string& entry) {
  std::string bytes(k_mark);
  put(bytes, digest.data(), digest.size());
  bytes += entry;
  Checksum checksum;
  checksum.add(bytes);
  const Digest written = checksum.digest();
  put(bytes, written.data(), written.size());
  try {
    cache.prepare(2 * bytes.size());
    write_file_atomically(cache.file(digest), bytes);
    cache.trim(cache.file(digest));
  } catch (const Error&) {
    return;
  }
}

}  // namespace

std::optional<MatrixRun> find_run(const fs::path& folder, const Digest& digest) {
  const fs::path path = matrices_in(folder).file(digest);
  std::error_code error;
  if (folder.empty() || !fs::exists(path, error)) return std::nullopt;
  try {
    const std::string entry = read_entry(path, digest);
    std::string_view bytes = entry;
    MatrixRun run;
    run.stiffness.lower = take_matrix(bytes);
    run.mass.lower = take_matrix(bytes);
    for (std::size_t end = bytes.find('\n'); end != std::string_view::npos; end = bytes.find('\n')) {
      run.stiffness.names.emplace_back(bytes.substr(0, end));
      bytes.remove_prefix(end + 1);
    }
    run.mass.names = run.stiffness.names;
    return run;
  } catch (const Error&) {
    return std::nullopt;
  }
}

void keep_run(const fs::path& folder, const Digest& digest, const MatrixRun& run) {
  if (folder.empty()) return;
  std::string bytes;
  put_matrix(bytes, run.stiffness.lower);
  put_matrix(bytes, run.mass.lower);
  for (const std::string& name : run.stiffness.names) bytes += name + '\n';
  keep_entry(matrices_in(folder), digest, bytes);
}

std::optional<Eigen::VectorXd> find_eigenvalues(const fs::path& folder, const Digest& digest) {
  const fs::path path = eigenvalues_in(folder).file(digest);
  std::error_code error;
  if (folder.empty() || !fs::exists(path, error)) return std::nullopt;
  try {
    const std::string entry = read_entry(path, digest);
    std::string_view bytes = entry;
    Eigen::VectorXd values(static_cast<Eigen::Index>(bytes.size() / sizeof(double)));
    take(bytes, values.data(), static_cast<std::size_t>(values.size()));
    return values;
  } catch (const Error&) {
    return std::nullopt;
  }
}

void keep_eigenvalues(const fs::path& folder, const Digest& digest, const Eigen::VectorXd& values) {
  if (folder.empty()) return;
  std::string bytes;
  put(bytes, values.data(), static_cast<std::size_t>(values.size()));
  keep_entry(eigenvalues_in(folder), digest, bytes);
}

}  // namespace mottle::drivers
