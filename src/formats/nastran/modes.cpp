#include "mottle/formats/nastran/modes.hpp"

#include <algorithm>

#include "mottle/core/error.hpp"
#include "mottle/formats/text_lines.hpp"

namespace mottle::formats {
namespace {

constexpr std::string_view k_eigenvalue_title = "R E A L   E I G E N V A L U E S";
constexpr std::string_view k_eigenvector_title = "R E A L   E I G E N V E C T O R   N O .";
constexpr const char* k_components[] = {"+X", "+Y", "+Z", "+RX", "+RY", "+RZ"};

/// Eigenvalues that come one by one with their mode numbers.
class EigenvalueList {
 public:
  explicit EigenvalueList(const std::string& file) : file_(file) {}

  /// A mode that comes again must be the same; mode 1 after others starts anew.
  void add(int mode, std::string_view text, int line) {
    double value = 0.0;
    if (!parse_printed_number(text, value)) {
      throw FormatError(file_, line, fmt::format("the eigenvalue of mode {}, '{}', is not a number", mode, text));
    }
    const int last = static_cast<int>(values_.size());
    if (mode < 1) throw FormatError(file_, line, fmt::format("modes are numbered from 1 on, found {}", mode));
    if (mode == last && values_.back() == value) return;
    if (mode != 1 && mode != last + 1) {
      throw FormatError(file_, line, fmt::format("mode {} follows mode {}", mode, last));
    }
    if (mode == 1) values_.clear();
    values_.push_back(value);
  }

  Eigen::VectorXd values(const char* what) const {
    if (values_.empty()) throw FormatError(file_, 0, fmt::format("has no {}", what));
    return Eigen::Map<const Eigen::VectorXd>(values_.data(), static_cast<Eigen::Index>(values_.size()));
  }

 private:
  const std::string& file_;
  std::vector<double> values_;
};

double component(std::string_view text, const std::string& file, int line) {
  double value = 0.0;
  if (!parse_printed_number(text, value)) {
    throw FormatError(file, line, fmt::format("'{}' is not a number", text));
  }
  return value;
}

int mode_number(std::string_view text, const std::string& file, int line) {
  const std::vector<std::string_view> words = words_of(text);
  int mode = 0;
  if (words.empty() || !parse_whole_number(words[0], mode) || mode < 1) {
    throw FormatError(file, line, "a mode without its number");
  }
  return mode;
}

/// A row of an eigenvector's table; false where the line is none. Of scalar points a row holds up to six in succession.
bool add_f06_row(const std::vector<std::string_view>& words, const std::string& file, int line,
                 ShapeCollector& collector) {
  int point = 0;
  if (words.size() < 3 || !parse_whole_number(words[0], point) || (words[1] != "G" && words[1] != "S")) return false;
  const bool is_grid = words[1] == "G";
  if (words.size() > 8 || (is_grid && words.size() != 8)) {
    throw FormatError(file, line, fmt::format("point {} has {} components, 6 are needed", point, words.size() - 2));
  }
  for (std::size_t c = 0; c + 2 < words.size(); ++c) {
    collector.add(
        is_grid ? fmt::format("{}:{}", point, k_components[c]) : fmt::format("{}", point + static_cast<int>(c)),
        component(words[c + 2], file, line));
  }
  return true;
}

/// Reads $EIGENVALUE =  8.2327765E+06  MODE =     1.
bool read_eigenvalue_line(std::string_view line, std::string_view& value, std::string_view& mode) {
  if (!line.starts_with("$EIGENVALUE")) return false;
  const std::size_t equals = line.find('=');
  const std::size_t word = line.find("MODE");
  if (equals == std::string_view::npos || word == std::string_view::npos || word < equals) return false;
  const std::vector<std::string_view> values = words_of(line.substr(equals + 1, word - equals - 1));
  const std::size_t second = line.find('=', word);
  if (values.size() != 1 || second == std::string_view::npos) return false;
  value = values[0];
  mode = line.substr(second + 1);
  return true;
}

/// Fields of a punch line: 18 columns each, a sequence number from column 73.
std::string_view punch_field(std::string_view line, std::size_t field) {
  const std::size_t begin = std::min<std::size_t>(18 * field, line.size());
  std::string_view text =
      line.substr(0, std::min<std::size_t>(72, line.size())).substr(std::min<std::size_t>(begin, 72), 18);
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

}  // namespace

void ShapeCollector::begin_mode(int mode, int line) {
  const int last = static_cast<int>(modes_.size());
  if (mode == last) return;
  if (mode == 1) {
    modes_.clear();
    lines_.clear();
  } else if (mode != last + 1) {
    throw FormatError(file_, line, fmt::format("mode {} follows mode {}", mode, last));
  }
  modes_.emplace_back();
  lines_.push_back(line);
}

NamedShapes ShapeCollector::shapes() const {
  if (modes_.empty() || modes_.front().empty()) throw FormatError(file_, 0, "has no mode shapes");
  NamedShapes shapes;
  const std::vector<Entry>& first = modes_.front();
  for (const Entry& entry : first) shapes.names.push_back(entry.name);
  std::vector<std::string> sorted = shapes.names;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end())
    throw FormatError(file_, lines_.front(), fmt::format("'{}' is given twice in mode 1", *twice));
  shapes.values.resize(static_cast<Eigen::Index>(first.size()), static_cast<Eigen::Index>(modes_.size()));
  for (std::size_t mode = 0; mode < modes_.size(); ++mode) {
    const std::vector<Entry>& entries = modes_[mode];
    for (std::size_t row = 0; row < std::max(first.size(), entries.size()); ++row) {
      if (row >= first.size() || row >= entries.size() || entries[row].name != first[row].name) {
        throw FormatError(
            file_, lines_[mode],
            fmt::format("mode {} lists other degrees of freedom than mode 1, from number {} on", mode + 1, row + 1));
      }
      shapes.values(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(mode)) = entries[row].value;
    }
  }
  return shapes;
}

Eigen::VectorXd read_f06_eigenvalues(LineWalker lines, const std::string& file) {
  EigenvalueList list(file);
  bool is_inside = false;
  bool has_rows = false;
  while (lines.next()) {
    if (lines.line().find(k_eigenvalue_title) != std::string_view::npos) {
      is_inside = true;
      has_rows = false;
    }
    const std::vector<std::string_view> words = words_of(lines.line());
    int mode = 0;
    if (!is_inside || words.empty() || !parse_whole_number(words[0], mode)) {
      if (has_rows) is_inside = false;
      continue;
    }
    if (words.size() != 7 && lines.line().starts_with('1')) {  // carriage control: the title of a new page
      is_inside = false;
      continue;
    }
    has_rows = true;
    if (words.size() != 7) {
      throw FormatError(file, lines.number(),
                        fmt::format("a row of the eigenvalue table has {} columns, not 7", words.size()));
    }
    list.add(mode, words[2], lines.number());
  }
  return list.values("table of real eigenvalues");
}

NamedShapes read_f06_shapes(LineWalker lines, const std::string& file) {
  ShapeCollector collector(file);
  bool is_inside = false;
  bool has_rows = false;
  while (lines.next()) {
    const std::string_view line = lines.line();
    const std::size_t title = line.find(k_eigenvector_title);
    if (title != std::string_view::npos) {
      const std::string_view number = line.substr(title + k_eigenvector_title.size());
      collector.begin_mode(mode_number(number, file, lines.number()), lines.number());
      is_inside = true;
      has_rows = false;
    } else if (is_inside && add_f06_row(words_of(line), file, lines.number(), collector)) {
      has_rows = true;
    } else if (has_rows) {
      is_inside = false;
    }
  }
  return collector.shapes();
}

Eigen::VectorXd read_punch_eigenvalues(LineWalker lines, const std::string& file) {
  EigenvalueList list(file);
  while (lines.next()) {
    std::string_view value;
    std::string_view mode;
    if (!read_eigenvalue_line(lines.line(), value, mode)) continue;
    list.add(mode_number(mode, file, lines.number()), value, lines.number());
  }
  return list.values("$EIGENVALUE line");
}

NamedShapes read_punch_shapes(LineWalker lines, const std::string& file) {
  ShapeCollector collector(file);
  bool is_vector = false;  // within a block of displacements
  bool has_mode = false;
  bool is_grid = false;
  int point = 0;  // that its -CONT- line is still missing of
  while (lines.next()) {
    const std::string_view line = lines.line();
    if (line.starts_with('$')) {
      std::string_view value;
      std::string_view mode;
      point = 0;
      if (line.starts_with("$TITLE")) is_vector = has_mode = false;
      if (line.starts_with("$EIGENVECTOR") || line.starts_with("$DISPLACEMENT")) is_vector = true;
      if (!is_vector || !read_eigenvalue_line(line, value, mode)) continue;
      collector.begin_mode(mode_number(mode, file, lines.number()), lines.number());
      has_mode = true;
      continue;
    }
    const bool is_continued = line.starts_with("-CONT-");
    if (!is_vector || !has_mode || (is_continued && point == 0 && !is_grid)) continue;
    const std::vector<std::string_view> head = words_of(punch_field(line, 0));
    if (is_continued != (point > 0) || (!is_continued && (head.size() != 2 || !parse_whole_number(head[0], point)))) {
      throw FormatError(file, lines.number(), "not a point with its -CONT- line, as eigenvectors have them");
    }
    if (!is_continued) is_grid = head[1] == "G";
    for (std::size_t field = 1; field <= (is_grid ? 3U : 1U); ++field) {
      const std::size_t c = field - 1 + (is_continued ? 3 : 0);
      collector.add(is_grid ? fmt::format("{}:{}", point, k_components[c]) : fmt::format("{}", point),
                    component(punch_field(line, field), file, lines.number()));
    }
    if (is_continued || !is_grid) point = 0;
  }
  return collector.shapes();
}

}  // namespace mottle::formats
