#include "mottle/core/utf8.hpp"

#include <fmt/format.h>

namespace mottle {

std::size_t utf8_length(std::string_view bytes) {
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

std::string printable(std::string_view foreign) {
  std::string text;
  while (!foreign.empty()) {
    const std::size_t length = utf8_length(foreign);
    const char first = foreign.front();
    const bool is_shown = length > 0 && first != '\n' && first != '\r' && first != '\x7f';
    if (is_shown) text += foreign.substr(0, length);
    if (!is_shown) text += fmt::format("\\x{:02x}", static_cast<unsigned char>(foreign.front()));
    foreign.remove_prefix(is_shown ? length : 1);
  }
  return text;
}

std::string shortened(const std::string& text, std::size_t max_bytes) {
  constexpr std::string_view k_left_out = " [...] ";
  if (text.size() <= max_bytes) return text;
  const auto whole_from = [&](std::size_t position) {  // not within a letter of several bytes
    while (position < text.size() && (static_cast<unsigned char>(text[position]) & 0xC0U) == 0x80U) ++position;
    return position;
  };
  const std::size_t end = max_bytes / 3;
  const std::size_t begin = max_bytes - end;
  return fmt::format("{}{}{}", text.substr(0, whole_from(begin)), k_left_out,
                     text.substr(whole_from(text.size() - end)));
}

}  // namespace mottle
