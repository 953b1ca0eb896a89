// Datasets 55 and 2414: mode shapes at nodes.
#include <fmt/format.h>

#include <set>

#include "formats/uff/datasets.hpp"

namespace mottle::formats {
namespace {

/// What is common to both: kind of result, layout of the numbers at a node.
struct Kind {
  int analysis = 0, values = 0;
  bool is_complex = false;
  std::string reason;  ///< why it is no mode shape; empty: it is one
};

Kind read_kind(UffCursor& cursor, UffShape& shape) {
  const std::vector<int> record = cursor.integers("model, analysis, characteristic, quantity, type, values", {10}, 6);
  shape.model_type = record[0];
  shape.analysis_type = record[1];
  shape.quantity = record[3];
  const int type = record[4];
  Kind kind{.analysis = record[1], .values = record[5], .is_complex = type == 5 || type == 6, .reason = {}};
  shape.is_complex = kind.is_complex;
  const bool is_mode = kind.analysis == 2 || kind.analysis == 3 || kind.analysis == 7;
  if (!is_mode) {
    kind.reason = fmt::format("analysis type {} is no mode (2, 3 and 7 are)", kind.analysis);
  } else if (kind.values != 3 && kind.values != 6) {
    kind.reason = fmt::format("{} values a node are no displacements (3 and 6 are)", kind.values);
  } else if (type != 2 && type != 4 && !kind.is_complex) {
    cursor.fail(fmt::format("data type {}: 2 and 4 (real), 5 and 6 (complex) are known", type));
  }
  return kind;
}

void require_not_negative(const UffCursor& cursor, const char* what, double value) {
  if (value < 0.0) cursor.fail(fmt::format("{} {} is negative", what, value));
}

void take_real_mode(const UffCursor& cursor, double frequency, double mass, double viscous, double hysteretic,
                    UffShape& shape) {
  shape.frequency = frequency;
  shape.modal_mass = mass;
  shape.viscous_damping = viscous;
  shape.hysteretic_damping = hysteretic;
  require_not_negative(cursor, "the frequency", frequency);
  require_not_negative(cursor, "the modal mass", mass);
}

/// Eigenvalue and modal A, B, real and imaginary parts in turn.
void take_complex_mode(const std::vector<double>& numbers, UffShape& shape) {
  shape.eigenvalue = {numbers[0], numbers[1]};
  shape.modal_a = {numbers[2], numbers[3]};
  shape.modal_b = {numbers[4], numbers[5]};
}

void read_at_nodes(UffCursor& cursor, const Kind& kind, UffShape& shape) {
  const auto values = static_cast<std::size_t>(kind.values);
  const std::size_t count = values * (kind.is_complex ? 2 : 1);
  std::vector<std::complex<double>> numbers;
  std::set<int> seen;
  while (!cursor.at_mark()) {
    const std::vector<int> node = cursor.integers("a node", {10}, 1);
    if (node.size() > 1) cursor.fail(fmt::format("{} numbers stand where a node alone should be", node.size()));
    if (!seen.insert(node[0]).second) cursor.fail(fmt::format("node {} is given twice in one shape", node[0]));
    shape.nodes.push_back(node[0]);
    const std::vector<double> at_node =
        cursor.values(fmt::format("{} values of node {}", count, node[0]), {13, 13, 13, 13, 13, 13}, count);
    for (std::size_t k = 0; k < values; ++k) {
      numbers.push_back(kind.is_complex ? std::complex(at_node[2 * k], at_node[2 * k + 1]) : at_node[k]);
    }
  }
  if (shape.nodes.empty()) cursor.fail("a shape without nodes");
  using Table = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  shape.values = Eigen::Map<const Table>(numbers.data(), static_cast<Eigen::Index>(shape.nodes.size()), kind.values);
}

void leave_out(const UffShape& shape, const char* dataset, const std::string& reason, UffFile& out) {
  out.notes.push_back(fmt::format("{}:{}: dataset {} is left out: {}.", out.file, shape.line, dataset, reason));
}

}  // namespace

void read_uff_shape_55(UffCursor& cursor, UffFile& out) {
  UffShape shape;
  shape.line = cursor.line_number();
  shape.titles = read_uff_titles(cursor);
  const Kind kind = read_kind(cursor, shape);
  if (!kind.reason.empty()) {
    leave_out(shape, "55", kind.reason, out);
    return;
  }
  std::vector<int> whole = cursor.integers("counts, load case and mode", {10}, 4);
  constexpr int k_max = 1000;
  if (whole[0] < 0 || whole[0] > k_max || whole[1] < 0 || whole[1] > k_max) {
    cursor.fail(fmt::format("{} whole and {} real numbers of the analysis", whole[0], whole[1]));
  }
  const auto count = static_cast<std::size_t>(whole[0]) + 2;
  for (std::size_t read = 8; read < count; read += 8) cursor.integers("numbers of the analysis", {10}, 1);
  shape.load_case = whole[2];
  shape.mode = whole[3];
  const std::vector<double> real = cursor.numbers("numbers of the mode", {13}, 6);
  for (int read = 6; read < whole[1]; read += 6) cursor.numbers("numbers of the mode", {13}, 1);
  if (kind.analysis == 2) {
    take_real_mode(cursor, real[0], real[1], real[2], real[3], shape);
  } else {
    take_complex_mode(real, shape);
  }
  read_at_nodes(cursor, kind, shape);
  out.shapes.push_back(std::move(shape));
}

void read_uff_shape_2414(UffCursor& cursor, UffFile& out) {
  UffShape shape;
  shape.line = cursor.line_number();
  cursor.integers("the dataset's label", {10}, 1);
  cursor.text("the dataset's name");
  const int location = cursor.integers("where the data are", {10}, 1)[0];
  if (location != 1) {
    leave_out(shape, "2414", fmt::format("its data are not at nodes (location {})", location), out);
    return;
  }
  shape.titles = read_uff_titles(cursor);
  const Kind kind = read_kind(cursor, shape);
  if (!kind.reason.empty()) {
    leave_out(shape, "2414", kind.reason, out);
    return;
  }
  const std::vector<int> whole = cursor.integers("numbers of the analysis", {10}, 8);
  shape.load_case = whole[4];
  shape.mode = whole[5];
  cursor.integers("creation option and number retained", {10}, 2);
  const std::vector<double> real = cursor.numbers("time, frequency, eigenvalue, mass, damping", {13}, 6);
  take_real_mode(cursor, real[1], real[3], real[4], real[5], shape);
  take_complex_mode(cursor.numbers("complex eigenvalue and modal A, B", {13}, 6), shape);
  read_at_nodes(cursor, kind, shape);
  out.shapes.push_back(std::move(shape));
}

}  // namespace mottle::formats
