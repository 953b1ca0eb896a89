#include "mottle/formats/text_lines.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <span>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"

namespace mottle::formats {

bool LineWalker::next() {
  std::size_t end = rest_.find('\n');
  while (end == std::string_view::npos) {
    const std::size_t searched = rest_.size();
    if (!read_more()) break;
    end = rest_.find('\n', searched);
  }
  if (rest_.empty()) return false;
  line_ = rest_.substr(0, end);
  if (!buffer_.empty()) check_length(line_.size());
  if (line_.ends_with('\r')) line_.remove_suffix(1);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  ++number_;
  return true;
}

/// Puts the next bytes of the file behind the rest of those before; false at its end.
bool LineWalker::read_more() {
  constexpr std::size_t k_block = 64 << 10;
  if (!file_) return false;
  const std::size_t kept = rest_.size();
  check_length(kept);
  if (kept > 0) std::memmove(buffer_.data(), rest_.data(), kept);
  if (buffer_.size() - kept < k_block) buffer_.resize(2 * kept + k_block);
  const std::size_t count = file_->read(std::span(buffer_).subspan(kept));
  rest_ = {buffer_.data(), kept + count};
  if (count == 0) file_.reset();
  return count > 0;
}

void LineWalker::check_length(std::size_t size) const {
  if (size <= k_longest_line) return;
  throw FormatError(name_, number_ + 1, fmt::format("the line has more than {} bytes", k_longest_line));
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (;;) {
    const std::size_t begin = line.find_first_not_of(" \t\f");
    if (begin == std::string_view::npos) return words;
    line.remove_prefix(begin);
    const std::size_t size = std::min(line.find_first_of(" \t\f"), line.size());
    words.push_back(line.substr(0, size));
    line.remove_prefix(size);
  }
}

bool parse_printed_number(std::string_view text, double& value) {
  if (text.find_first_of("dD") == std::string_view::npos) return parse_number(text, value) && std::isfinite(value);
  std::string plain(text);
  const auto exponent = std::find_if(plain.begin(), plain.end(), [](char c) { return c == 'd' || c == 'D'; });
  *exponent = 'E';
  return parse_number(plain, value) && std::isfinite(value);
}

bool parse_whole_number(std::string_view text, int& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace mottle::formats
