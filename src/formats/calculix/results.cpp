#include "mottle/formats/calculix/results.hpp"

#include "formats/matrices/matrix_text.hpp"

namespace mottle::formats {
namespace {

std::string_view columns(const MatrixLines& text, std::size_t first, std::size_t width) {
  const std::string_view line = text.line();
  if (line.size() < first + width) text.fail(fmt::format("the line ends before column {}", first + width));
  return line.substr(first, width);
}

double real(const MatrixLines& text, std::string_view field) {
  double value = 0.0;
  if (!parse_fortran(field, value)) text.fail(fmt::format("'{}' is not a finite number", field));
  return value;
}

/// " -1", the node in 10 columns, three components in 12 each; " -3" ends the block.
void read_displacements(MatrixLines& text, CalculixShape& shape) {
  for (text.need("displacements"); text.line().substr(0, 3) != " -3"; text.need("the end of the block, -3")) {
    const std::string_view mark = text.line().substr(0, 3);
    if (mark == " -5") continue;  // what the components are
    long long node = 0;
    if (mark != " -1" || !parse_whole(columns(text, 3, 10), node)) text.fail("expected ' -1' and a node");
    Eigen::Vector3d& displacement = shape.displacements[static_cast<int>(node)];
    for (std::size_t c = 0; c < 3; ++c) {
      displacement(static_cast<Eigen::Index>(c)) = real(text, columns(text, 13 + 12 * c, 12));
    }
  }
}

}  // namespace

Eigen::VectorXd parse_calculix_eigenvalues(std::string_view bytes, const std::string& file) {
  MatrixLines text(bytes, file);
  bool is_table = false;
  std::vector<double> values;
  Words words;
  while (text.next()) {
    const std::size_t count = split_words(text.line(), words);
    if (text.line().find("E I G E N V A L U E   O U T P U T") != std::string_view::npos) is_table = values.empty();
    if (is_table && values.empty() && count > 1 && words[0] == "MODE" &&
        text.line().find("EIGENVALUE") == std::string_view::npos) {
      if (text.line().find("COMPONENT") != std::string_view::npos) break;  // participation factors of no mode
      text.fail(
          "its modes are those of a stiffness that is not symmetric, of which CalculiX writes complex frequencies and "
          "no eigenvalues; they are not read: take the friction (*FRICTION) out of the contact");
    }
    long long mode = 0;
    if (!is_table || count < 2) {
      if (count > 0 && !values.empty()) break;
      continue;
    }
    if (!parse_whole(words[0], mode)) {
      if (!values.empty()) break;
      continue;  // headings
    }
    if (mode != static_cast<long long>(values.size()) + 1) {
      text.fail(values.empty() ? fmt::format("the first mode is {}, not 1: take the limits of frequency, or of nodal "
                                             "diameters, out of the step",
                                             mode)
                               : fmt::format("mode {} follows mode {}", mode, values.size()));
    }
    values.push_back(real(text, words[1]));
  }
  if (values.empty()) {
    throw FormatError(file, 0,
                      is_table ? "holds a table of eigenvalues without any: no mode lies where the *FREQUENCY step "
                                 "looks for them"
                               : "holds no table of eigenvalues");
  }
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

std::vector<CalculixShape> parse_calculix_shapes(std::string_view bytes, const std::string& file) {
  MatrixLines text(bytes, file);
  std::vector<CalculixShape> shapes;
  double frequency = 0.0;
  bool is_static = false;  // a preload before the modes
  while (text.next()) {
    if (text.line().starts_with("  100C")) {
      frequency = real(text, columns(text, 12, 12));
      is_static = text.line().size() >= 58 && text.line().substr(56, 2) == " 0";
    }
    if (is_static || !text.line().starts_with(" -4  DISP")) continue;
    shapes.push_back({frequency, {}});
    read_displacements(text, shapes.back());
  }
  if (shapes.empty()) throw FormatError(file, 0, "holds no displacements; ask for them by *NODE FILE and U, as text");
  return shapes;
}

}  // namespace mottle::formats
