// The study of three masses and the measurements that tests start from, and edits of such texts.
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace mottle::test {

inline const std::string k_three_masses_study = R"(title = "A study for tests"
units = "SI"
seed = 7

[model]
kind = "mass-spring"
masses = { m1 = 1.0, m2 = 1.0, m3 = 1.0 }
springs = [
  { name = "k1", between = ["ground", "m1"], stiffness = 1.0 },
  { name = "k2", between = ["ground", "m2"], stiffness = 1.0 },
  { name = "k3", between = ["ground", "m3"], stiffness = 1.0 },
  { name = "k4", between = ["m1", "m2"], stiffness = 1.0 },
  { name = "k5", between = ["m2", "m3"], stiffness = 1.0 },
  { name = "k6", between = ["m1", "m3"], stiffness = 3.0 },
]

[[parameter]]
name = "k1"
target = "spring:k1"
distribution = { kind = "normal", mean = 2.0, std = 0.3 }
bounds = [0.5, 3.0]

[[parameter]]
name = "k2"
target = "spring:k2"
distribution = { kind = "normal", mean = 2.0, std = 0.3 }

[outputs]
frequencies = [1, 2, 3]

[test]
file = "tests.csv"

[update]
method = "mares"
samples = 200
iterations = 30

[update.mares]
weighting = "mahalanobis"
)";

inline const std::string k_three_masses_tests =
    "f1,f2,f3\n"
    "0.1763570506816554,0.3131497726771104,0.45042916001957517\n"
    "0.15687913901247214,0.3080098662667982,0.4453461832320965\n"
    "0.1654460037166279,0.3306499755013718,0.44854953970272743\n"
    "0.1544553212110254,0.29637131878810136,0.45121694877005003\n"
    "0.16784897711121846,0.35176559403439267,0.46023064077164544\n"
    "0.16347936267572327,0.3370983290769924,0.4572734203791198\n";

/// A Nastran deck of three masses in a row: 1.9006, 5.7822 and 8.9855 Hz.
inline const std::string k_chain_deck = R"(SOL 103
CEND
METHOD = 10
SPC = 1
BEGIN BULK
EIGRL,10,,,3
GRID,1,,0.,0.,0.
GRID,2,,1.,0.,0.
GRID,3,,2.,0.,0.
SPC1,1,23456,1,THRU,3
CELAS2,1,1000.,1,1
CELAS2,2,1500.,1,1,2,1
CELAS2,3,1200.,2,1,3,1
CONM2,5,1,,1.
CONM2,6,2,,2.
CONM2,7,3,,1.5
ENDDATA
)";

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
