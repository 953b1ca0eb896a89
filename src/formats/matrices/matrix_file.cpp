#include "mottle/formats/matrices/matrix_file.hpp"

#include "formats/matrices/matrix_readers.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"

namespace mottle::formats {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view k_hdf5 = "\x89HDF\r\n\x1a\n";

/// Whether the line is the third one of a Harwell-Boeing file: a type, and four or five whole numbers.
bool is_harwell_boeing(std::string_view bytes) {
  MatrixLines text(bytes, "");
  for (int i = 0; i < 3; ++i) {
    if (!text.next()) return false;
  }
  Words words;
  const std::size_t count = split_words(text.line(), words);
  if ((count != 4 && count != 5) || words[0].size() != 3) return false;
  const std::string type = capitals(words[0]);
  long long value = 0;
  return std::string_view("RCPI").find(type[0]) != std::string_view::npos &&
         std::string_view("SUHZR").find(type[1]) != std::string_view::npos &&
         std::string_view("AE").find(type[2]) != std::string_view::npos && parse_whole(words[1], value);
}

/// Fortran's record of six words, or of the four numbers and the name, in either byte order; or text with a format.
bool is_output4(std::string_view bytes) {
  constexpr std::string_view k_little{"\x18\0\0\0", 4};
  constexpr std::string_view k_big{"\0\0\0\x18", 4};
  if (bytes.starts_with(k_little) || bytes.starts_with(k_big)) return true;
  const std::string_view line = bytes.substr(0, bytes.find('\n'));
  constexpr std::size_t k_field = 8;
  if (line.size() < 5 * k_field || capitals(line).find("1P") == std::string::npos) return false;
  long long value = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (!parse_whole(line.substr(k * k_field, k_field), value)) return false;
  }
  return true;
}

/// First line that holds anything but a comment of Nastran's.
std::string_view first_line(std::string_view bytes) {
  MatrixLines text(bytes, "");
  while (text.next()) {
    const std::string_view line = trim_blanks(text.line());
    if (!line.empty() && !line.starts_with('$')) return line;
  }
  return {};
}

}  // namespace

std::size_t choose_matrix(const std::string& file, const std::string& name, const std::vector<std::string>& known) {
  require(!known.empty(), "{}: holds no matrix", file);
  if (name.empty()) {
    require(known.size() == 1, "{}: holds the matrices {}; name one behind a '#', like {}#{}", file, join(known), file,
            known.front());
    return 0;
  }
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (known[i] == capitals(name)) return i;
  }
  throw InvalidInput(fmt::format("{}: {}", file, unknown_name_message("matrix", name, known)));
}

fs::path file_of_matrix(const std::string& location) {
  return location.substr(0, location.find('#'));
}

std::vector<std::string> parse_row_names(std::string_view bytes, const std::string& file) {
  MatrixLines text(bytes, file);
  std::vector<std::string> names;
  Words words;
  while (text.next()) {
    const std::size_t count = split_words(text.line(), words);
    if (count == 0) continue;
    long long node = 0;
    long long equation = 0;
    if (count == 3 && parse_whole(words[0], equation) && parse_whole(words[1], node)) {  // ANSYS
      const std::string axis = capitals(words[2]);
      const std::size_t component = std::string_view("UX  UY  UZ  ROTXROTYROTZ").find(axis);
      if (equation != static_cast<long long>(names.size()) + 1) text.fail("equations are not numbered one by one");
      const bool is_direction = component != std::string_view::npos && component % 4 == 0 && axis.size() >= 2;
      names.push_back(is_direction ? row_name(node, static_cast<int>(component / 4) + 1)
                                   : fmt::format("{}:{}", node, axis));
      continue;
    }
    if (count > 2 && names.empty() && !parse_whole(words[0], equation)) continue;  // ANSYS's heading
    if (count != 1) text.fail("expected a degree of freedom like 101:+Z or 101.3");
    const std::size_t point = words[0].find('.');
    long long component = 0;
    if (point == std::string_view::npos) {
      names.emplace_back(words[0]);
    } else if (parse_whole(words[0].substr(0, point), node) && parse_whole(words[0].substr(point + 1), component) &&
               component >= 0 && component <= 6) {
      names.push_back(row_name(node, static_cast<int>(component)));
    } else {
      text.fail(fmt::format("'{}' is not NODE.DIRECTION with a direction of 1 to 6", words[0]));
    }
  }
  return names;
}

std::vector<std::string> read_row_names(const fs::path& file) {
  return parse_row_names(read_file(file), file.string());
}

SymmetricMatrix parse_symmetric_matrix(std::string_view bytes, const std::string& file, const std::string& name) {
  if (bytes.starts_with(k_hdf5)) return parse_hdf5_matrix(bytes, file, name);
  const std::string_view first = first_line(bytes);
  if (is_output4(bytes)) return parse_output4(bytes, file, name);
  if (capitals(first).starts_with("DMIG")) return parse_dmig(bytes, file, name);
  require(name.empty(), "{}: a file of this format holds one matrix without a name; leave '#{}' out", file, name);
  if (first.starts_with("%%")) return parse_matrix_market(bytes, file);
  if (is_harwell_boeing(bytes)) return parse_harwell_boeing(bytes, file);
  const bool is_abaqus = first.starts_with('*') || first.find(',') != std::string_view::npos;
  return is_abaqus ? parse_abaqus_matrix(bytes, file) : parse_triples(bytes, file);
}

SymmetricMatrix read_symmetric_matrix(const std::string& location) {
  const fs::path file = file_of_matrix(location);
  const std::string name = location.size() > file.string().size() ? location.substr(file.string().size() + 1) : "";
  const std::string bytes = read_file(file);
  SymmetricMatrix matrix = parse_symmetric_matrix(bytes, file.string(), name);
  for (const char* extension : k_names_beside_matrices) {
    fs::path beside = file;
    beside.replace_extension(extension);
    if (matrix.names.empty() && beside != file && fs::exists(beside)) matrix.names = read_row_names(beside);
  }
  const auto rows = static_cast<std::size_t>(matrix.lower.rows());
  require(matrix.names.empty() || matrix.names.size() >= rows, "{}: {} rows, but {} names stand in the file beside it",
          file.string(), rows, matrix.names.size());
  // What a triple file does not mention, trailing rows without mass, is there all the same.
  if (matrix.names.size() > rows) {
    const auto size = static_cast<Eigen::Index>(matrix.names.size());
    matrix.lower.conservativeResize(size, size);
  }
  return matrix;
}

}  // namespace mottle::formats
