#include "mottle/study/run_folder.hpp"

#include <chrono>

#include "mottle/core/files.hpp"

namespace mottle {

RunFolder::RunFolder(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code ignored;
  for (std::filesystem::path path = std::filesystem::absolute(folder_).lexically_normal();
       !std::filesystem::exists(path, ignored) && path.has_relative_path(); path = path.parent_path()) {
    made_.push_back(path);
  }
  make_writable_folder(folder_);
}

void RunFolder::write(const std::string& name, const std::string& bytes) const {
  write_file_atomically(file(name), bytes);
}

void RunFolder::finish() const {
  std::error_code ignored;  // a journal that stays behind does no harm
  std::filesystem::remove(journal(), ignored);
}

void RunFolder::discard() const {
  std::error_code ignored;  // what cannot be taken away does no harm
  std::filesystem::remove(journal(), ignored);
  std::filesystem::remove(file("mottle.log"), ignored);
  for (const std::filesystem::path& path : made_) std::filesystem::remove(path, ignored);
}

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

LogObserver::LogObserver(const std::filesystem::path& file, ProgressObserver* next, bool append)
    : stream_(std::fopen(file.c_str(), append ? "a" : "w")), next_(next), start_(steady_seconds()) {
  require(stream_ != nullptr, "{}: cannot be written", file.string());
}

LogObserver::~LogObserver() {
  std::fclose(stream_);
}

void LogObserver::line(const char* kind, const std::string& text) {
  std::fputs(fmt::format("{:9.3f} s  {}{}\n", steady_seconds() - start_, kind, text).c_str(), stream_);
  std::fflush(stream_);
}

void LogObserver::progress(const std::string& stage, std::int64_t done, std::int64_t total) {
  line("", fmt::format("{}: {} of {}", stage, done, total));
  if (next_ != nullptr) next_->progress(stage, done, total);
}

void LogObserver::warning(const std::string& text) {
  line("warning: ", text);
  if (next_ != nullptr) next_->warning(text);
}

void LogObserver::note(const std::string& text) {
  line("", text);
  if (next_ != nullptr) next_->note(text);
}

}  // namespace mottle
