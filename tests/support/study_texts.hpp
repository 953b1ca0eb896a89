// The study of three masses and the measurements that tests start from, and edits of such texts.
#pragma once

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace mottle::test {

/// A file of tests/support/studies, which the tests in Python start from too.
inline std::string text_of(const std::string& name) {
  std::ifstream stream(MOTTLE_SOURCE_DIR "/tests/support/studies/" + name);
  std::ostringstream text;
  if (!(text << stream.rdbuf())) throw std::logic_error("no text '" + name + "' in tests/support/studies");
  return text.str();
}

inline const std::string k_three_masses_study = text_of("three_masses.toml");
inline const std::string k_three_masses_tests = text_of("three_masses.csv");
/// A Nastran deck of three masses in a row: 1.9006, 5.7822 and 8.9855 Hz.
inline const std::string k_chain_deck = text_of("chain.bdf");

/// One part of a text that is replaced.
struct TextChange {
  std::string found, put;
};

inline std::size_t occurrences(std::string_view text, std::string_view part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string_view::npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

/// The text with each change; what is replaced must stand there once, so that a test cannot miss its target.
inline std::string edited(std::string text, const std::vector<TextChange>& changes) {
  for (const auto& [found, put] : changes) {
    const std::size_t count = occurrences(text, found);
    if (count != 1)
      throw std::logic_error("'" + found + "' stands " + std::to_string(count) + " times in the text to edit");
    text.replace(text.find(found), found.size(), put);
  }
  return text;
}

/// The study of three masses with changes.
inline std::string three_masses(const std::vector<TextChange>& changes = {}) {
  return edited(k_three_masses_study, changes);
}

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Number, from 1, of the first line that holds `part`.
inline int line_of(const std::string& text, const std::string& part) {
  const std::vector<std::string> lines = lines_of(text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].find(part) != std::string::npos) return static_cast<int>(i) + 1;
  }
  throw std::logic_error("'" + part + "' stands on no line");
}

inline std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

/// Words with one blank between them: sentences that were wrapped are on one line again.
inline std::string on_one_line(const std::string& text) {
  std::string result;
  std::istringstream stream(text);
  for (std::string word; stream >> word;) result += (result.empty() ? "" : " ") + word;
  return result;
}

}  // namespace mottle::test
