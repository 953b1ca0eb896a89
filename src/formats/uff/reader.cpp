// The structure of a universal file: marks and dataset numbers, and the reader of each dataset.
#include <cctype>
#include <charconv>
#include <map>

#include "formats/uff/datasets.hpp"
#include "mottle/core/error.hpp"

namespace mottle::formats {
namespace {

using Reader = void (*)(UffCursor&, UffFile&);

const std::map<int, Reader>& readers() {
  static const std::map<int, Reader> k_readers = {
      {15, read_uff_nodes_15},       {18, read_uff_systems_18}, {55, read_uff_shape_55},
      {82, read_uff_trace_line},     {151, read_uff_header},    {164, read_uff_units},
      {2411, read_uff_nodes_2411},   {2412, read_uff_elements}, {2414, read_uff_shape_2414},
      {2420, read_uff_systems_2420},
  };
  return k_readers;
}

/// "    58b     1     2 ..." -> 58, and what follows the b.
int dataset_number(UffCursor& cursor, std::optional<std::string>& binary) {
  const std::string_view line = cursor.line("the dataset's number");
  const std::size_t start = std::min(line.find_first_not_of(" \t"), line.size());
  int number = 0;
  const auto [end, error] = std::from_chars(line.data() + start, line.data() + line.size(), number);
  const std::string_view rest = line.substr(static_cast<std::size_t>(end - line.data()));
  const bool is_binary = rest.starts_with('b') || rest.starts_with('B');
  const bool is_number = error == std::errc() && number > 0 &&
                         (rest.empty() || is_binary || std::isspace(static_cast<unsigned char>(rest.front())) != 0);
  if (!is_number) cursor.fail("a dataset's number is needed behind the mark -1");
  if (is_binary) binary = std::string(rest.substr(1));
  return number;
}

void read_dataset(UffCursor& cursor, UffFile& out) {
  std::optional<std::string> binary;
  const int number = dataset_number(cursor, binary);
  const int line = cursor.line_number();
  const std::size_t notes = out.notes.size();
  const auto reader = readers().find(number);
  if (number == 58) {
    read_uff_function(cursor, out, binary);
  } else if (reader != readers().end() && !binary) {
    reader->second(cursor, out);
  } else {
    out.notes.push_back(fmt::format("{}:{}: dataset {} is not read.", out.file, line, number));
  }
  const bool is_left_out = out.notes.size() > notes;
  while (cursor.left() > 0 && !cursor.at_mark()) {
    const bool is_blank = cursor.any_line().find_first_not_of(" \t\r") == std::string_view::npos;
    if (!is_left_out && !is_blank) {
      cursor.fail(fmt::format("dataset {} of line {} is complete, yet there is more; it should end with '    -1'",
                              number, line));
    }
  }
  if (cursor.left() == 0) cursor.fail(fmt::format("the file ends within dataset {} of line {}", number, line));
  cursor.any_line();
}

}  // namespace

UffTitles read_uff_titles(UffCursor& cursor) {
  UffTitles titles;
  for (std::string& title : titles) title = cursor.text("a title");
  return titles;
}

UffFile parse_uff(std::string_view bytes, const std::string& file) {
  constexpr std::string_view k_byte_order_mark = "\xEF\xBB\xBF";
  if (bytes.starts_with(k_byte_order_mark)) bytes.remove_prefix(k_byte_order_mark.size());
  UffFile out;
  out.file = file;
  UffCursor cursor(bytes, out.file);
  int datasets = 0;
  for (; !cursor.at_end(); ++datasets) {
    const bool opens = cursor.at_mark();
    cursor.any_line();
    if (!opens) {
      cursor.fail(datasets == 0 ? "this is no universal file: its first line should be '    -1'"
                                : "text outside a dataset: is a mark '    -1' missing before or behind?");
    }
    read_dataset(cursor, out);
  }
  if (datasets == 0) throw FormatError(file, 0, "is empty: a universal file holds datasets between lines '    -1'");
  return out;
}

}  // namespace mottle::formats
