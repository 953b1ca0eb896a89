// Validity of UTF-8 text from other programs, and its printable form.
#pragma once

#include <string>
#include <string_view>

namespace mottle {

/// Length of the UTF-8 character that `bytes` starts with; 0 where there is none, or a control character other than tab
/// and the ends of lines. Source: [Unicode 15, table 3-7].
std::size_t utf8_length(std::string_view bytes);

/// Foreign text as one line that can be shown and written on: "\x1b" for each byte that is no UTF-8 character, for
/// control characters and the ends of lines.
std::string printable(std::string_view foreign);

/// The first and last characters of a long UTF-8 text, for messages: about `max_bytes` bytes.
std::string shortened(const std::string& text, std::size_t max_bytes);

}  // namespace mottle
