// A .vtu file read back: its XML, its base64 arrays and VTK's numbering of nodes.
#include "mottle/formats/vtu.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstring>
#include <stack>
#include <string>

namespace mottle::formats {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Checks nesting and quoting of a text without comments; the first fault, or "".
std::string xml_fault(const std::string& text) {
  std::stack<std::string> open;
  std::size_t at = text.starts_with("<?xml") ? text.find("?>") + 2 : 0;
  while ((at = text.find('<', at)) != std::string::npos) {
    bool is_quoted = false;
    std::size_t end = at + 1;
    for (; end < text.size() && (is_quoted || text[end] != '>'); ++end) {
      if (text[end] == '"') is_quoted = !is_quoted;
      if (is_quoted && text[end] == '<') return "'<' in an attribute";
      if (is_quoted && text[end] == '&' && text.find(';', end) > text.find('"', end)) return "'&' in an attribute";
    }
    if (end == text.size()) return "an open tag";
    const std::string tag = text.substr(at + 1, end - at - 1);
    const std::string name = tag.substr(0, tag.find(' '));
    if (tag.front() == '/') {
      if (open.empty() || open.top() != tag.substr(1)) return "unexpected " + tag;
      open.pop();
    } else if (tag.back() != '/') {
      open.push(name);
    }
    at = end;
  }
  return open.empty() ? "" : "never closed: " + open.top();
}

std::string decoded(const std::string& text) {
  static const std::string k_letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned buffer = 0;
  int bits = 0;
  for (const char letter : text) {
    if (letter == '=') break;
    buffer = (buffer << 6) | static_cast<unsigned>(k_letters.find(letter));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<char>((buffer >> bits) & 0xff));
  }
  return bytes;
}

/// The numbers of an array by its name, its length checked.
template <typename Number>
std::vector<Number> array(const std::string& text, const std::string& name) {
  const std::size_t tag = text.find("Name=\"" + name + "\"");
  if (tag == std::string::npos) return {};
  const std::size_t begin = text.find('>', tag) + 1;
  const std::string bytes = decoded(text.substr(begin, text.find('<', begin) - begin));
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data(), sizeof length);
  EXPECT_EQ(length + sizeof length, bytes.size()) << name;
  std::vector<Number> numbers(length / sizeof(Number));
  std::memcpy(numbers.data(), bytes.data() + sizeof length, length);
  return numbers;
}

/// A wedge, a quadratic tetrahedron, a triangle, a rod, springs to a grid point, to ground and to a scalar point.
FiniteElementModel model() {
  FiniteElementModel model;
  for (int k = 0; k < 10; ++k) model.nodes.push_back({.id = 10 * (k + 1), .position = {0.1 * k, 1.0 / 3.0, -k - 0.5}});
  const double wedge[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  for (std::size_t k = 0; k < 6; ++k) model.nodes[k].position = {wedge[k][0], wedge[k][1], wedge[k][2]};
  model.nodes.push_back({.id = 200, .is_scalar = true});
  model.elements<SolidElement>().push_back({.id = 1, .shape = SolidShape::wedge6, .nodes = {0, 1, 2, 3, 4, 5}});
  model.elements<SolidElement>().push_back(
      {.id = 2, .shape = SolidShape::tetrahedron10, .nodes = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}});
  model.elements<ShellElement>().push_back({.id = 3, .node_count = 3, .nodes = {1, 2, 4, 0}});
  model.elements<RodElement>().push_back({.id = 4, .nodes = {8, 9}});
  model.elements<ScalarElement>().push_back({.id = 5, .nodes = {7, 8}});
  model.elements<ScalarElement>().push_back({.id = 6, .nodes = {7, -1}});
  model.elements<ScalarElement>().push_back({.id = 7, .nodes = {7, 10}});
  return model;
}

TEST(Vtu, IsWellFormedWhateverAFieldIsCalled) {
  const Eigen::MatrixX3d zero = Eigen::MatrixX3d::Zero(11, 3);
  const std::string text = format_vtu(model(), {{"mode 1, 5 Hz", zero}, {"a < b & \"c\" > d", zero}});
  EXPECT_EQ(xml_fault(text), "");
  EXPECT_THAT(text, HasSubstr("Name=\"a &lt; b &amp; &quot;c&quot; > d\""));
  EXPECT_THAT(text, HasSubstr("NumberOfPoints=\"11\" NumberOfCells=\"5\""));
}

TEST(Vtu, HoldsTheNodesToTheLastBit) {
  const FiniteElementModel given = model();
  const std::vector<double> positions = array<double>(format_vtu(given, {}), "position");
  ASSERT_EQ(positions.size(), 33U);
  for (std::size_t k = 0; k < 11; ++k) {
    EXPECT_EQ(Eigen::Vector3d(positions[3 * k], positions[3 * k + 1], positions[3 * k + 2]), given.nodes[k].position);
  }
  EXPECT_THAT(array<std::int32_t>(format_vtu(given, {}), "grid"),
              ElementsAre(10, 20, 30, 40, 50, 60, 70, 80, 90, 100, 200));
}

TEST(Vtu, HoldsTheFieldsByNode) {
  Eigen::MatrixX3d vectors(11, 3);
  for (Eigen::Index k = 0; k < 33; ++k) vectors(k / 3, k % 3) = std::sin(1.0 + static_cast<double>(k));
  const std::vector<double> read = array<double>(format_vtu(model(), {{"mode", vectors}}), "mode");
  ASSERT_EQ(read.size(), 33U);
  for (Eigen::Index k = 0; k < 33; ++k) EXPECT_EQ(read[static_cast<std::size_t>(k)], vectors(k / 3, k % 3));
}

TEST(Vtu, HoldsTheCells) {
  const std::string text = format_vtu(model(), {});
  EXPECT_THAT(array<std::int32_t>(text, "element"), ElementsAre(1, 2, 3, 4, 5));
  EXPECT_THAT(array<std::uint8_t>(text, "types"), ElementsAre(13, 24, 5, 3, 3));
  EXPECT_THAT(array<std::int32_t>(text, "offsets"), ElementsAre(6, 16, 19, 21, 23));
  const std::vector<std::int32_t> nodes = array<std::int32_t>(text, "connectivity");
  ASSERT_EQ(nodes.size(), 23U);
  EXPECT_THAT(std::vector<int>(nodes.begin() + 6, nodes.end()),
              ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 2, 4, 8, 9, 7, 8));
}

// VTK's manual of vtkWedge: the normal of the base (0, 1, 2) by the right hand rule points away from (3, 4, 5), and
// 0-3, 1-4, 2-5 are the edges between the bases. Nastran's points towards them.
TEST(Vtu, TurnsWedgesTheWayVtkHasThem) {
  const FiniteElementModel given = model();
  const std::vector<std::int32_t> nodes = array<std::int32_t>(format_vtu(given, {}), "connectivity");
  ASSERT_GE(nodes.size(), 6U);
  const auto at = [&](std::size_t k) { return given.nodes[static_cast<std::size_t>(nodes[k])].position; };
  EXPECT_LT((at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)), 0.0);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(at(k + 3) - at(k), Eigen::Vector3d(0, 0, 1));
}

TEST(Vtu, IsWellFormedForAnEmptyModel) {
  EXPECT_EQ(xml_fault(format_vtu({}, {})), "");
}

}  // namespace
}  // namespace mottle::formats
