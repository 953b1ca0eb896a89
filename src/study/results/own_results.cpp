#include "mottle/study/results/own_results.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "mottle/core/checksum.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/own_file.hpp"
#include "mottle/model/journal.hpp"
#include "mottle/study/results/run_folder.hpp"
#include "study/results/diagnosis_names.hpp"

namespace mottle::study {
namespace {

constexpr std::string_view k_head = "Checksums of the files that Mottle wrote here, so that it may write over them.\n";
constexpr std::uint64_t k_largest_register = 1 << 16;  // then it is put in order

/// The file's first bytes; none of what cannot be read or is no file.
std::string first_bytes(const std::filesystem::path& file) {
  constexpr std::size_t k_enough = 4096;
  std::string bytes(k_enough, '\0');
  try {
    bytes.resize(BlockReader(file).read(bytes));
  } catch (const Error&) {
    bytes.clear();
  }
  return bytes;
}

/// "    0.012 s  text".
bool is_log(std::string_view bytes) {
  const std::size_t number = bytes.find_first_not_of(' ');
  const std::size_t end = number == std::string_view::npos ? number : bytes.find_first_not_of("0123456789.", number);
  if (end == std::string_view::npos || end < 9 || bytes[end - 4] != '.') return false;
  return std::ranges::count(bytes.substr(0, end), '.') == 1 && bytes.substr(end).starts_with(" s  ");
}

/// Or what a lost machine has left of its beginning.
bool is_journal(std::string_view bytes) {
  return bytes.starts_with(k_journal_magic) || k_journal_magic.starts_with(bytes);
}

struct GrowingFile {
  const char* name;
  bool (*is_known)(std::string_view bytes);
};

constexpr std::array k_growing{GrowingFile{k_log, is_log}, GrowingFile{k_diagnosis_log, is_log},
                               GrowingFile{k_journal, is_journal}, GrowingFile{k_diagnosis_journal, is_journal}};

/// Lines of the register by name, in the order in which they were written; none where it is something else.
std::map<std::string, std::vector<std::string>> read_register(const std::filesystem::path& file) {
  std::map<std::string, std::vector<std::string>> digests;
  std::string text;
  try {
    text = read_file(file, 16 * k_largest_register);
  } catch (const Error&) {
    return digests;
  }
  if (!text.starts_with(k_head)) return digests;
  constexpr std::size_t k_digits = 32;
  for (std::size_t begin = k_head.size(); begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (end > begin + k_digits && text[begin + k_digits] == ' ') {
      digests[text.substr(begin + k_digits + 1, end - begin - k_digits - 1)].push_back(text.substr(begin, k_digits));
    }
    begin = end + 1;
  }
  return digests;
}

/// Leaves the last of each name: what is there or was set aside, and what was to take its place when jobs were killed.
void put_in_order(const std::filesystem::path& file) {
  std::string text(k_head);
  for (const auto& [name, digests] : read_register(file)) {
    constexpr std::size_t k_last = 8;
    const std::size_t first = digests.size() > k_last ? digests.size() - k_last : 0;
    for (std::size_t i = first; i < digests.size(); ++i) text += digests[i] + ' ' + name + '\n';
  }
  write_file_atomically(file, text);
}

}  // namespace

bool is_own_result_of(const std::filesystem::path& folder, const std::filesystem::path& file) {
  const auto known = read_register(folder / k_register);
  const auto digests = known.find(file.filename().string());
  if (digests == known.end()) return false;
  Checksum checksum;
  try {
    BlockReader reader(file);
    std::string block(1 << 20, '\0');
    for (std::size_t size = reader.read(block); size > 0; size = reader.read(block)) checksum.add(block.data(), size);
  } catch (const Error&) {
    return false;
  }
  return std::ranges::find(digests->second, hexadecimal(checksum.digest())) != digests->second.end();
}

bool may_be_own_result(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::exists(std::filesystem::symlink_status(file, ignored))) return true;
  if (!std::filesystem::is_regular_file(file, ignored)) return false;
  if (std::filesystem::is_empty(file, ignored)) return true;
  const auto growing = std::ranges::find(k_growing, file.filename(), &GrowingFile::name);
  if (growing != k_growing.end()) return growing->is_known(first_bytes(file));
  return is_own_result_of(file.parent_path(), file);
}

void require_own_result(const std::filesystem::path& file) {
  require(may_be_own_result(file),
          "{}: is not as an earlier run wrote it, and results would be written over it; move it, or choose another "
          "folder with --out",
          file.string());
}

void note_own_result(const std::filesystem::path& file, std::string_view bytes) {
  const std::filesystem::path place = file.parent_path() / k_register;
  std::error_code ignored;
  const bool is_new = !std::filesystem::exists(place, ignored) || std::filesystem::is_empty(place, ignored);
  require(
      is_new || first_bytes(place).starts_with(k_head),
      "{}: is not the list of files that Mottle keeps under this name; move it, or choose another folder with --out",
      place.string());
  if (!is_new && std::filesystem::file_size(place, ignored) > k_largest_register) put_in_order(place);
  // The line break in front ends a line that a full disk has cut.
  const std::string line =
      std::string(is_new ? k_head : "\n") + hexadecimal(digest_of(bytes)) + ' ' + file.filename().string() + '\n';
  const int descriptor = open_own_file(place, ExistingFile::keep);
  ::lseek(descriptor, 0, SEEK_END);
  const bool is_whole = ::write(descriptor, line.data(), line.size()) == static_cast<ssize_t>(line.size());
  ::close(descriptor);
  if (!is_whole) throw SystemFailure(place.string() + ": cannot be written: the disk may be full");
}

}  // namespace mottle::study
