#include "mottle/study/text_file.hpp"

#include <algorithm>
#include <string_view>

#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"

namespace mottle {
namespace {

/// Length of the UTF-8 character that `bytes` starts with; 0 where there is none. [Unicode 15, table 3-7]
std::size_t character_length(std::string_view bytes) {
  const auto at = [bytes](std::size_t i) { return i < bytes.size() ? static_cast<unsigned char>(bytes[i]) : 0U; };
  const auto continues = [&at](std::size_t i) { return (at(i) & 0xC0U) == 0x80U; };
  const unsigned first = at(0);
  if (first < 0x80) return first >= 0x20 || first == '\t' || first == '\n' || first == '\r' ? 1 : 0;
  if (first < 0xC2 || first > 0xF4 || !continues(1)) return 0;
  if (first < 0xE0) return 2;
  const bool is_overlong = (first == 0xE0 && at(1) < 0xA0) || (first == 0xF0 && at(1) < 0x90);
  const bool is_beyond = (first == 0xED && at(1) > 0x9F) || (first == 0xF4 && at(1) > 0x8F);
  if (is_overlong || is_beyond || !continues(2)) return 0;
  if (first < 0xF0) return 3;
  return continues(3) ? 4 : 0;
}

}  // namespace

std::string read_text_file(const std::filesystem::path& file) {
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  const bool can_end = !std::filesystem::is_character_file(status) && !std::filesystem::is_block_file(status);
  require(can_end, "{}: is a device, a regular file is needed", file.string());
  std::string bytes = read_file(file);
  for (std::size_t i = 0; i < bytes.size();) {
    const std::size_t length = character_length(std::string_view(bytes).substr(i));
    if (length == 0) {
      const auto line = 1 + std::count(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(i), '\n');
      throw FormatError(file.string(), static_cast<int>(line),
                        fmt::format("holds the byte 0x{:02X}, which is not UTF-8 text; save the file as plain text in "
                                    "UTF-8",
                                    static_cast<unsigned char>(bytes[i])));
    }
    i += length;
  }
  return bytes;
}

}  // namespace mottle
