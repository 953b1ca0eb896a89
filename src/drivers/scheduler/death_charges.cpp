#include "drivers/scheduler/death_charges.hpp"

#include <fmt/format.h>

#include <sstream>

#include "mottle/core/files.hpp"
#include "mottle/drivers/scheduler/array_folder.hpp"

namespace mottle::drivers {

DeathCharges::DeathCharges(const std::filesystem::path& results, bool is_resumed)
    : file_(results / k_task_folder / "deaths") {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file_, ignored)) return;
  if (!is_resumed) {
    clear();
    return;
  }
  std::istringstream lines(read_file(file_));
  std::string digits;
  for (int deaths = 0; lines >> digits >> deaths;) deaths_[digits] = deaths;
}

int DeathCharges::of(const Digest& key) const {
  const auto found = deaths_.find(hexadecimal(key));
  return found == deaths_.end() ? 0 : found->second;
}

void DeathCharges::set(const Digest& key, int deaths) {
  if (deaths == of(key)) return;
  deaths_[hexadecimal(key)] = deaths;
  if (deaths == 0) deaths_.erase(hexadecimal(key));
  if (deaths_.empty()) return clear();
  write();
}

void DeathCharges::clear() {
  deaths_.clear();
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

void DeathCharges::write() const {
  std::string text;
  for (const auto& [digits, deaths] : deaths_) text += fmt::format("{} {}\n", digits, deaths);
  write_file_atomically(file_, text);
}

}  // namespace mottle::drivers
