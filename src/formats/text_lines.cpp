#include "mottle/formats/text_lines.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

#include "mottle/core/text.hpp"

namespace mottle {

bool LineWalker::next() {
  if (rest_.empty()) return false;
  const std::size_t end = rest_.find('\n');
  line_ = rest_.substr(0, end);
  if (line_.ends_with('\r')) line_.remove_suffix(1);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  ++number_;
  return true;
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

}  // namespace mottle
