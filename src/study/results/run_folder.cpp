#include "mottle/study/results/run_folder.hpp"

#include <unistd.h>

#include <algorithm>

#include "mottle/core/clock.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/own_file.hpp"
#include "mottle/core/text.hpp"
#include "mottle/study/results/own_results.hpp"

namespace mottle::study {
namespace {

constexpr const char* k_mark = "README.txt";
constexpr const char* k_mark_text =
    "Results of an earlier run. A later run in the folder above has not finished; when one does, these files are "
    "deleted.\n";

/// Whether a file is the mark or what was to become it.
bool is_mark(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return name == k_mark || (name.starts_with(k_mark) && name.ends_with(".partial"));
}

bool has_mark(const std::filesystem::path& folder) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(folder / k_mark, ignored) && read_file(folder / k_mark) == k_mark_text;
}

/// Whether nothing is there, or a folder that this program made: one with its mark, or one in which it was killed
/// before the mark was whole.
bool may_hold_previous(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(std::filesystem::symlink_status(folder))) return true;
  if (std::filesystem::is_symlink(folder) || !std::filesystem::is_directory(folder)) return false;
  if (std::filesystem::exists(folder / k_mark)) return has_mark(folder);
  const std::filesystem::directory_iterator files(folder);
  return std::all_of(begin(files), end(files), [](const auto& file) { return is_mark(file.path()); });
}

/// Whether the results of that names are there to their end.
bool are_complete(const std::filesystem::path& folder, const std::vector<std::string>& names) {
  std::error_code ignored;
  return !names.empty() && std::filesystem::is_regular_file(folder / names.back(), ignored);
}

}  // namespace

const std::vector<std::string>& result_names() {
  static const std::vector<std::string> names = {"report.html", "history.csv",   "cloud-initial.csv", "cloud-final.csv",
                                                 "clouds.csv",  "cloud.csv",     "pairing.csv",       "prediction.csv",
                                                 "modes.json",  "posterior.csv", "posterior.json",    "result.json"};
  return names;
}

const std::vector<std::string>& specimen_names() {
  static const std::vector<std::string> names = {"specimens.csv", "specimens-truth.csv"};
  return names;
}

const std::vector<std::string>& modes_names() {
  static const std::vector<std::string> names = {"modes.csv", "modes.vtu", "modes.uff", "modes.json", "modes.html"};
  return names;
}

RunFolder::RunFolder(std::filesystem::path folder) : folder_(std::move(folder)) {
  make_writable_folder(folder_);
}

void RunFolder::write(const std::string& name, const std::string& bytes) const {
  require_own_result(file(name));
  note_own_result(file(name), bytes);
  write_file_atomically(file(name), bytes);
}

std::vector<std::string> RunFolder::set_aside(const std::vector<std::string>& names) const {
  std::vector<std::string> there;
  if (!are_complete(folder_, names)) return there;
  for (const std::string& name : names) {
    if (!std::filesystem::is_regular_file(file(name))) continue;
    require_own_result(file(name));
    there.push_back(name);
  }
  const std::filesystem::path previous = file(k_previous);
  const std::filesystem::path mark = previous / k_mark;
  require(
      may_hold_previous(previous),
      "{}: earlier results go there, but something else has that name; rename it, or choose another folder with --out",
      previous.string());
  std::filesystem::create_directories(previous);
  write_file_atomically(mark, k_mark_text);
  // Where the last is not among those of before, a run was killed while it moved these: the others are theirs.
  if (are_complete(previous, names)) {
    for (const std::string& name : names) {
      const bool is_there = std::filesystem::exists(std::filesystem::symlink_status(previous / name));
      require(!is_there || is_own_result_of(folder_, previous / name),
              "{}: earlier results go there, and this file is not as an earlier run wrote it; move it",
              (previous / name).string());
    }
    for (const std::string& name : names) std::filesystem::remove(previous / name);
  }
  for (const std::string& name : there) std::filesystem::rename(file(name), previous / name);
  return there;
}

void RunFolder::restore(const std::vector<std::string>& names) const {
  std::error_code ignored;  // what cannot be moved back is still in the other folder
  // The last first: a run that is killed here leaves what the next one knows as results.
  std::for_each(names.rbegin(), names.rend(), [&](const std::string& name) {
    std::filesystem::rename(file(k_previous) / name, file(name), ignored);
  });
  forget_previous({});
}

void RunFolder::forget_previous(const std::vector<std::string>& names) const {
  std::error_code ignored;  // what stays behind says what it is
  const std::filesystem::path previous = file(k_previous);
  if (std::filesystem::is_symlink(previous, ignored) || !has_mark(previous)) return;
  if (are_complete(previous, names)) {  // else they are those of another job
    for (const std::string& name : names) {
      if (is_own_result_of(folder_, previous / name)) std::filesystem::remove(previous / name, ignored);
    }
  }
  std::vector<std::filesystem::path> marks;
  for (const auto& file : std::filesystem::directory_iterator(previous, ignored)) {
    if (!is_mark(file.path())) return;
    marks.push_back(file.path());
  }
  for (const std::filesystem::path& mark : marks) std::filesystem::remove(mark, ignored);
  std::filesystem::remove(previous, ignored);
}

void RunFolder::finish() const {
  remove(k_journal);
  forget_previous(result_names());
}

void RunFolder::remove(const std::string& name) const {
  std::error_code ignored;
  std::filesystem::remove(file(name), ignored);
}

LogObserver::LogObserver(const std::filesystem::path& file, ProgressObserver* next, bool append)
    : next_(next), start_(steady_seconds()) {
  const int descriptor = open_own_file(file, append ? ExistingFile::keep : ExistingFile::replace);
  stream_ = ::fdopen(descriptor, "a");
  if (stream_ != nullptr) return;
  ::close(descriptor);
  throw SystemFailure(fmt::format("{}: cannot be written", file.string()));
}

LogObserver::~LogObserver() {
  end_phase();
  double whole = 0.0;
  for (const Share& share : shares_) whole += share.seconds;
  std::vector<std::string> parts;
  for (const Share& share : shares_) {
    const std::string count = share.phases > 1 ? fmt::format(", {} of them", share.phases) : "";
    parts.push_back(
        fmt::format("{} {:.2f} s ({:.0f} %{})", share.name, share.seconds, 100.0 * share.seconds / whole, count));
  }
  if (whole > 0.0) line("", "time: " + join(parts));
  std::fclose(stream_);
}

void LogObserver::end_phase() {
  if (phase_.name.empty()) return;
  auto share = std::find_if(shares_.begin(), shares_.end(), [&](const Share& s) { return s.name == phase_.name; });
  if (share == shares_.end()) share = shares_.insert(shares_.end(), {.name = phase_.name});
  share->seconds += steady_seconds() - phase_start_;
  ++share->phases;
}

bool LogObserver::is_due() const {
  constexpr double k_interval_s = 10.0;
  return steady_seconds() - std::max(last_count_, start_) >= k_interval_s;
}

void LogObserver::phase(const Phase& next) {
  end_phase();
  const bool is_of_many = next.name == phase_.name && !next.may_end_early;
  phase_ = next;
  phase_start_ = steady_seconds();
  if (!is_of_many || is_due()) {
    line("", phase_.text());
    last_count_ = phase_start_;
  }
  if (next_ != nullptr) next_->phase(next);
}

void LogObserver::line(const char* kind, const std::string& text) {
  std::fputs(fmt::format("{:9.3f} s  {}{}\n", steady_seconds() - start_, kind, text).c_str(), stream_);
  std::fflush(stream_);
}

void LogObserver::progress(const std::string& work, std::int64_t done, std::int64_t total) {
  if (is_due()) {
    line("", total > 0 ? fmt::format("{}: {} of {}", work, done, total) : fmt::format("{}: {}", work, done));
    last_count_ = steady_seconds();
  }
  if (next_ != nullptr) next_->progress(work, done, total);
}

void LogObserver::detail(const std::string& text) {
  if (next_ != nullptr) next_->detail(text);
}

void LogObserver::warning(const std::string& text) {
  line("warning: ", text);
  if (next_ != nullptr) next_->warning(text);
}

void LogObserver::note(const std::string& text) {
  line("", text);
  if (next_ != nullptr) next_->note(text);
}

void LogObserver::finding(const std::string& text) {
  line("", text);
  if (next_ != nullptr) next_->finding(text);
}

}  // namespace mottle::study
