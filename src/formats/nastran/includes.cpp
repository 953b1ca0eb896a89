#include "formats/nastran/includes.hpp"

#include <algorithm>
#include <system_error>

#include "formats/nastran/rows.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"

namespace mottle::formats::nastran {
namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

/// The only file of the folder whose name differs from `path`'s in letter case alone.
std::optional<fs::path> find_in_any_case(const fs::path& path) {
  std::optional<fs::path> found;
  const std::string wanted = capitals(path.filename().string());
  std::error_code error;
  const fs::path folder = path.parent_path().empty() ? fs::path(".") : path.parent_path();
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (capitals(entry->path().filename().string()) != wanted || !is_file(entry->path())) continue;
    if (found) return std::nullopt;
    found = path.parent_path() / entry->path().filename();
  }
  return found;
}

std::string with_slashes(std::string written) {
  std::replace(written.begin(), written.end(), '\\', '/');
  return written;
}

std::optional<fs::path> find_file(const std::string& written, const fs::path& folder) {
  const std::string slashed = with_slashes(written);
  for (const std::string& name : {written, slashed}) {
    if (is_file(folder / name)) return folder / name;
  }
  return find_in_any_case(folder / slashed);
}

}  // namespace

std::string read_limited_file(const std::filesystem::path& path, std::uintmax_t limit) {
  std::error_code error;
  const std::uintmax_t size = fs::is_regular_file(path, error) ? fs::file_size(path, error) : 0;
  if (!error && size > limit) {
    throw FormatError(path.string(), 0, fmt::format("the deck is larger than {} bytes with this file", limit));
  }
  return read_file(path);
}

std::string places_of_include(const std::string& written, const std::string& from, const std::string& main_file) {
  const auto place = [&](const std::string& file) {
    return (fs::path(file).parent_path() / with_slashes(written)).lexically_normal().string();
  };
  const std::string beside = place(from);
  const std::string beside_main = place(main_file);
  return beside == beside_main ? beside : fmt::format("{} and {}", beside, beside_main);
}

IncludeResolver resolver_of_files(const std::filesystem::path& main_file) {
  return [main_file](const std::string& written, const std::string& from) -> std::optional<IncludedFile> {
    for (const fs::path& folder : {fs::path(from).parent_path(), main_file.parent_path()}) {
      if (const auto path = find_file(written, folder)) {
        const std::string name = path->lexically_normal().string();
        return IncludedFile{name, read_limited_file(*path, k_max_bytes)};
      }
    }
    return std::nullopt;
  };
}

}  // namespace mottle::formats::nastran
