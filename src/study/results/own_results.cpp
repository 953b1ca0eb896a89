#include "study/results/own_results.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>

#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/model/journal.hpp"
#include "mottle/study/results/run_folder.hpp"
#include "study/results/diagnosis_names.hpp"

namespace mottle::study {
namespace {

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
  return end != std::string_view::npos && end > number && bytes.substr(end).starts_with(" s  ");
}

bool is_json_result(std::string_view bytes) {
  return bytes.starts_with('{') && bytes.find("\"mottle\":") != std::string_view::npos;
}

/// Of `modes`, or beside an update.
bool is_modes_result(std::string_view bytes) {
  return bytes.starts_with("{\"modes\":") || is_json_result(bytes);
}

bool is_journal(std::string_view bytes) {
  return bytes.starts_with(k_journal_magic) || k_journal_magic.starts_with(bytes);
}

struct Trace {
  const char* name;
  bool (*is_known)(std::string_view bytes);
};

constexpr std::array k_traces{Trace{"result.json", is_json_result},  Trace{"modes.json", is_modes_result},
                              Trace{k_diagnosis, is_json_result},    Trace{k_log, is_log},
                              Trace{k_diagnosis_log, is_log},        Trace{k_journal, is_journal},
                              Trace{k_diagnosis_journal, is_journal}};

/// Whether `simulate` has left specimens: of those without noise the last columns are those with it.
bool holds_specimens(const std::filesystem::path& folder) {
  const auto head = [&](const std::string& name) {
    const std::string bytes = first_bytes(folder / name);
    return bytes.substr(0, bytes.find('\n'));
  };
  const std::string drawn = head(specimen_names().front());
  return !drawn.empty() && head(specimen_names().back()).ends_with("," + drawn);
}

/// Whether the file is empty or known by what it holds.
bool is_left(const std::filesystem::path& file, const Trace& trace) {
  std::error_code ignored;
  const std::string bytes = first_bytes(file);
  return bytes.empty() ? std::filesystem::is_empty(file, ignored) : trace.is_known(bytes);
}

bool holds_results(const std::filesystem::path& folder) {
  const auto is_there = [&](const Trace& trace) {
    std::error_code ignored;
    return std::filesystem::exists(folder / trace.name, ignored) && is_left(folder / trace.name, trace);
  };
  return std::ranges::any_of(k_traces, is_there) || holds_previous(folder) || holds_specimens(folder);
}

}  // namespace

bool may_be_own_result(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::exists(std::filesystem::symlink_status(file, ignored))) return true;
  const auto trace = std::ranges::find(k_traces, file.filename(), &Trace::name);
  return trace == k_traces.end() ? holds_results(file.parent_path()) : is_left(file, *trace);
}

}  // namespace mottle::study
