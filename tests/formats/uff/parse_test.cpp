// Universal files as real programs write them, record by record of the published layout.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "formats/uff/datasets.hpp"
#include "mottle/formats/uff/uff.hpp"

namespace mottle::formats {
namespace {

using test::dataset;
using test::function_head;
using test::k_uff_mode;
using test::k_uff_titles;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

UffFile parse(const std::string& bytes) {
  return parse_uff(bytes, "test.uff");
}

TEST(ParseUff, ReadsANormalMode) {
  const UffFile file = parse(dataset("55", k_uff_mode));
  ASSERT_THAT(file.shapes, SizeIs(1));
  const UffShape& shape = file.shapes[0];
  EXPECT_EQ(shape.frequency, 12.5);
  EXPECT_EQ(shape.modal_mass, 2.0);
  EXPECT_EQ(shape.viscous_damping, 0.01);
  EXPECT_EQ(shape.mode, 3);
  EXPECT_FALSE(shape.is_complex);
  EXPECT_THAT(shape.nodes, ElementsAre(1, 2));
  const Eigen::MatrixXd expected = (Eigen::MatrixXd(2, 3) << 1.0, -0.5, 0.0, 0.0, 0.25, -1.0).finished();
  EXPECT_EQ(shape.values.real(), expected);
  EXPECT_TRUE(shape.values.imag().isZero(0.0));
}

// The layout of Simcenter Testlab: model type 999999, fields that touch, a long mantissa.
TEST(ParseUff, ReadsAComplexModeWithFieldsThatTouch) {
  const UffFile file =
      parse(dataset("55", k_uff_titles + "    999999         3         8        13         5         3\n"
                                         "         2         6         0         1\n"
                                         "-1.500000E-01 4.100000E+01 4.000000E+03-3.000000E+03-1.100000E+05"
                                         "-2.000000E+05\n"
                                         "    111111\n"
                                         " 0.000000E+00 0.000000E+00 1.000000E-01 9.000000E-02 7.000000E-03"
                                         "-4.000000E-03\n"));
  ASSERT_THAT(file.shapes, SizeIs(1));
  EXPECT_EQ(file.shapes[0].eigenvalue, std::complex(-0.15, 41.0));
  EXPECT_EQ(file.shapes[0].modal_a, std::complex(4000.0, -3000.0));
  EXPECT_EQ(file.shapes[0].values(0, 2), std::complex(0.007, -0.004));
}

TEST(ParseUff, ReadsSixComponentsOfAComplexModeOnTwoLines) {
  const UffFile file = parse(dataset("55", k_uff_titles + "1 7 3 8 5 6\n2 6 0 1\n-1. 60. 0. 0. 0. 0.\n1\n"
                                                          "1. 2. 3. 4. 5. 6.\n7. 8. 9. 10. 11. 12.\n"));
  ASSERT_THAT(file.shapes, SizeIs(1));
  EXPECT_EQ(file.shapes[0].values(0, 0), std::complex(1.0, 2.0));
  EXPECT_EQ(file.shapes[0].values(0, 5), std::complex(11.0, 12.0));
}

TEST(ParseUff, ReadsAnalysisDataOfDoublePrecision) {
  const UffFile file =
      parse(dataset("2414", "         1\nMODE\n         1\n" + k_uff_titles +
                                "         1         2         2         8         4         3\n"
                                "         0         0         0         0         1         5         0         0\n"
                                "         0         0\n"
                                "  0.00000E+00  3.30000E+01  0.00000E+00  1.50000E+00  2.00000E-02  0.00000E+00\n"
                                "  0.00000E+00  0.00000E+00  0.00000E+00  0.00000E+00  0.00000E+00  0.00000E+00\n"
                                "         7\n"
                                "   1.2345678901234567E-01   0.0000000000000000E+00  -1.0000000000000000E+00\n"));
  ASSERT_THAT(file.shapes, SizeIs(1));
  EXPECT_EQ(file.shapes[0].frequency, 33.0);
  EXPECT_EQ(file.shapes[0].mode, 5);
  EXPECT_EQ(file.shapes[0].modal_mass, 1.5);
  EXPECT_EQ(file.shapes[0].values(0, 0), 0.12345678901234567);
}

TEST(ParseUff, LeavesOutWhatIsNoModeAndSaysSo) {
  std::string response = k_uff_mode;
  response[k_uff_titles.size() + 19] = '5';
  const UffFile file =
      parse(dataset("55", response) + dataset("1858", "anything\n    here\n") + dataset("55", k_uff_mode));
  EXPECT_THAT(file.shapes, SizeIs(1));
  ASSERT_THAT(file.notes, SizeIs(2));
  EXPECT_THAT(file.notes[0], HasSubstr("test.uff:2: dataset 55 is left out: analysis type 5 is no mode"));
  EXPECT_THAT(file.notes[1], HasSubstr("dataset 1858 is not read"));
}

TEST(ParseUff, ReadsWhatRealFilesHave) {
  std::string bytes = dataset("55", k_uff_mode);
  std::replace(bytes.begin(), bytes.end(), 'E', 'D');
  for (std::size_t at = bytes.find("NONE"); at != std::string::npos; at = bytes.find("NONE")) {
    bytes.replace(at, 4,
                  "Pr\xFC"
                  "fung");  // Latin-1
  }
  std::string windows = "\xEF\xBB\xBF";
  for (const char letter : bytes) windows += letter == '\n' ? std::string("\r\n") : std::string(1, letter);
  const UffFile file = parse(windows + "\r\n" + windows.substr(3) + "\x1a");
  ASSERT_THAT(file.shapes, SizeIs(2));
  EXPECT_EQ(file.shapes[1].frequency, 12.5);
  const UffFile lower = parse(dataset("164", "1si\n1.0d0 1.0d0 1.0d0\n2.7315d2\n"));
  EXPECT_EQ(lower.units->temperature_offset, 273.15);
}

// As HBM catman writes: lines filled up to 80 columns, exponents of three digits, UTF-8 in titles and units.
TEST(ParseUff, ReadsLinesThatAreFilledUpWithBlanks) {
  const std::string narrow =
      dataset("58",
              "1x : m/s\xC2\xB2\nNONE\n30-Apr-20\nNONE\nNONE\n"
              "    1         0    0         0 NONE               0   0 NONE               0   0\n"
              "         2         7         1 0.00000E+000 5.00000E-005 0.00000E+000\n"
              "        17    0    0    0 Time                 s\n"
              "         1    0    0    0 1x                   m/s\xC2\xB2\n"
              "         0    0    0    0 NONE                 NONE\n"
              "         0    0    0    0 NONE                 NONE\n"
              " -3.81956E+00 -3.56616E+00 -2.98987E+00 -2.62207E+00 -3.22879E+00 -3.63712E+00\n"
              " -5.84096E+00\n");
  std::string bytes;
  std::size_t start = 0;
  for (const char letter : narrow) {
    if (letter == '\n' && bytes.size() - start < 80) bytes.append(80 - (bytes.size() - start), ' ');
    bytes += letter;
    if (letter == '\n') start = bytes.size();
  }
  const UffFile file = parse(bytes);
  ASSERT_THAT(file.functions, SizeIs(1));
  EXPECT_EQ(file.functions[0].step, 5e-5);
  EXPECT_EQ(file.functions[0].values(6).real(), -5.84096);
  EXPECT_EQ(file.functions[0].ordinate_axis.unit, "m/s\xC2\xB2");
}

TEST(ParseUff, ReadsNodesOfBothKinds) {
  const UffFile file =
      parse(dataset("15", "       101         0         4         8  1.00000E+00 -2.00000E+00  0.00000E+00\n") +
            dataset("2411",
                    "         7         1         2        11\n"
                    "   1.0000000000000000D+00-2.5000000000000000D-01   0.0000000000000000D+00\n"));
  ASSERT_THAT(file.nodes, SizeIs(2));
  EXPECT_EQ(file.nodes[0].id, 101);
  EXPECT_EQ(file.nodes[0].displacement_system, 4);
  EXPECT_EQ(file.nodes[0].position, Eigen::Vector3d(1.0, -2.0, 0.0));
  EXPECT_TRUE(file.nodes[0].is_local);
  EXPECT_EQ(file.nodes[1].definition_system, 1);
  EXPECT_EQ(file.nodes[1].position, Eigen::Vector3d(1.0, -0.25, 0.0));
}

// The x axis points to -x, the xz plane's point to -z: y stays y.
TEST(ParseUff, ReadsCoordinateSystemsByThreePoints) {
  const UffFile file = parse(dataset("18",
                                     "         1         0         0         8         1\nSYS1\n"
                                     " -2.40000e+00 -9.50000e-01  0.00000e+00 -3.40000e+00 -9.50000e-01  0.00000e+00\n"
                                     " -3.40000e+00 -9.50000e-01 -1.00000e+00\n"));
  ASSERT_THAT(file.systems, SizeIs(1));
  EXPECT_TRUE(file.systems[0].system.axes.isApprox(Eigen::Matrix3d(Eigen::Vector3d(-1, 1, -1).asDiagonal()), 1e-12));
  EXPECT_EQ(file.systems[0].system.origin, Eigen::Vector3d(-2.4, -0.95, 0.0));
}

TEST(ParseUff, ReadsCoordinateSystemsByTheirMatrix) {
  const UffFile file = parse(dataset("2420",
                                     "         1\npart\n"
                                     "         5         1         8\nCS5\n"
                                     "0. 1. 0.\n-1. 0. 0.\n0. 0. 1.\n4. 5. 6.\n"));
  ASSERT_THAT(file.systems, SizeIs(1));
  EXPECT_EQ(file.systems[0].system.kind, CoordinateSystem::Kind::cylindrical);
  EXPECT_EQ(file.systems[0].system.axes.col(0), Eigen::Vector3d(0, 1, 0));  // rows of the file are the axes
  EXPECT_EQ(file.systems[0].system.origin, Eigen::Vector3d(4, 5, 6));
}

TEST(ParseUff, ReadsTraceLinesFilledUpWithZeros) {
  const UffFile file =
      parse(dataset("82",
                    "         1         9         8\nwing\n"
                    "         5         6         3         0         1         2         3         2\n"
                    "         1         0         0         0         0         0         0         0\n"));
  ASSERT_THAT(file.trace_lines, SizeIs(1));
  EXPECT_EQ(file.trace_lines[0].name, "wing");
  EXPECT_THAT(file.trace_lines[0].nodes, ElementsAre(5, 6, 3, 0, 1, 2, 3, 2, 1));
}

TEST(ParseUff, ReadsElementsOfLinesAndShells) {
  const UffFile file = parse(dataset("2412",
                                     "         1        21         2         3         7         2\n"
                                     "         0         1         1\n         4         5\n"
                                     "         2        94         2         1         7         4\n"
                                     "         1         2         3         4\n"));
  ASSERT_THAT(file.elements, SizeIs(2));
  EXPECT_THAT(file.elements[0].nodes, ElementsAre(4, 5));
  EXPECT_THAT(file.elements[0].beam, ElementsAre(0, 1, 1));
  EXPECT_THAT(file.elements[1].nodes, ElementsAre(1, 2, 3, 4));
}

TEST(ParseUff, ReadsFunctionsOfEveryForm) {
  struct Form {
    std::string record, data;
    std::vector<double> abscissa;
    std::vector<std::complex<double>> values;
  };
  using Complex = std::complex<double>;
  const std::vector<Form> forms = {
      {"         2         3         1  1.00000E+00  5.00000E-01  0.00000E+00\n",
       "  1.00000E+00 -2.00000E+00  3.00000E+00\n",
       {1, 1.5, 2},
       {1, -2, 3}},
      {"         2         2         0  0.00000E+00  0.00000E+00  0.00000E+00\n",
       "  1.00000E+00-2.00000E+00  4.00000E+00  3.00000E+00\n",
       {1, 4},
       {-2, 3}},
      {"         5         2         1  0.00000E+00  1.00000E+00  0.00000E+00\n",
       "  1.00000E+00  2.00000E+00  3.00000E+00  4.00000E+00\n",
       {0, 1},
       {Complex(1, 2), Complex(3, 4)}},
      {"         5         2         0\n",
       "  1.00000E+00  2.00000E+00  3.00000E+00  4.00000E+00  5.00000E+00  6.00000E+00\n",
       {1, 4},
       {Complex(2, 3), Complex(5, 6)}},
      {"         4         2         1  0.00000E+00  1.00000E+00  0.00000E+00\n",
       "  1.12345678901E+00 -2.12345678901E+00\n",
       {0, 1},
       {1.12345678901, -2.12345678901}},
      {"         4         2         0  0.00000E+00  0.00000E+00  0.00000E+00\n",
       "  1.00000E+00   1.12345678901E+00  2.00000E+00  -2.12345678901E+00\n",
       {1, 2},
       {1.12345678901, -2.12345678901}},
      {"         6         2         1  0.00000E+00  1.00000E+00  0.00000E+00\n",
       "   1.00000000000E+00   2.00000000000E+00   3.00000000000E+00   4.00000000000E+00\n",
       {0, 1},
       {Complex(1, 2), Complex(3, 4)}},
      {"         6         2         0  0.00000E+00  0.00000E+00  0.00000E+00\n",
       "  1.00000E+00   2.00000000000E+00   3.00000000000E+00\n  4.00000E+00   5.00000000000E+00   6.00000000000E+00\n",
       {1, 4},
       {Complex(2, 3), Complex(5, 6)}},
  };
  for (const Form& form : forms) {
    const UffFile file = parse(dataset("58", function_head(form.record) + form.data));
    ASSERT_THAT(file.functions, SizeIs(1));
    const UffFunction& function = file.functions[0];
    EXPECT_EQ(std::vector<double>(function.abscissa.begin(), function.abscissa.end()), form.abscissa) << form.record;
    EXPECT_EQ(std::vector<Complex>(function.values.begin(), function.values.end()), form.values) << form.record;
    EXPECT_EQ(function.response_node, 101);
    EXPECT_EQ(function.reference_direction, -1);
    EXPECT_EQ(function.ordinate_axis.unit, "m/s^2");
  }
}

/// `values` as bytes, with the mark -1 hidden among them.
std::string bytes_of(const std::vector<double>& values, bool is_big_endian) {
  std::string bytes;
  for (const double value : values) {
    std::array<char, 8> buffer = {};
    std::copy_n(reinterpret_cast<const char*>(&value), 8, buffer.data());
    if (is_big_endian) std::reverse(buffer.begin(), buffer.end());
    bytes.append(buffer.data(), buffer.size());
  }
  return bytes;
}

TEST(ParseUff, ReadsBinaryFunctionsOfBothByteOrders) {
  // The bytes of the second number are "\n    -1\n": no end of the dataset.
  double mark = 0.0;
  std::copy_n("\n    -1\n", 8, reinterpret_cast<char*>(&mark));
  for (const bool is_big_endian : {false, true}) {
    std::string payload = bytes_of({1.5, 0.0, -2.5}, is_big_endian);
    payload.replace(8, 8, "\n    -1\n");
    const std::string head = is_big_endian ? "     2     2          11          24     0     0           0           0"
                                           : "     1     2          11          24     0     0           0           0";
    const std::string bytes = "    -1\n    58b" + head + "\n" +
                              function_head("         4         3         1  0.00000E+00  1.00000E+00  0.00000E+00\n") +
                              payload + "\n    -1\n" + dataset("55", k_uff_mode);
    const UffFile file = parse(bytes);
    ASSERT_THAT(file.functions, SizeIs(1));
    EXPECT_EQ(file.functions[0].values(0).real(), 1.5);
    EXPECT_EQ(file.functions[0].values(2).real(), -2.5);
    EXPECT_TRUE(file.functions[0].is_binary);
    EXPECT_THAT(file.shapes, SizeIs(1));
  }
}

// Single by the format; some programs write double there and announce another number of bytes.
TEST(ParseUff, ReadsAnUnevenAbscissaOfDoublePrecision) {
  const std::string bytes =
      "    -1\n    58b     1     2          11          16     0     0           0           0\n" +
      function_head("         4         2         0  0.00000E+00  0.00000E+00  0.00000E+00\n") +
      bytes_of({0.1, 1.0, 0.3, 2.0}, false) + "    -1\n";
  const UffFile file = parse(bytes);
  ASSERT_THAT(file.functions, SizeIs(1));
  EXPECT_EQ(file.functions[0].abscissa, Eigen::Vector2d(0.1, 0.3));
  EXPECT_EQ(file.functions[0].values.real(), Eigen::Vector2d(1.0, 2.0));
}

// tests/formats/uff/gmsh.geo says how: written by Gmsh 4.8.4.
TEST(ParseUff, ReadsAMeshThatGmshWrote) {
  std::ifstream stream(MOTTLE_SOURCE_DIR "/tests/formats/uff/gmsh.unv", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  const UffFile file = parse(bytes);
  ASSERT_THAT(file.nodes, SizeIs(6));
  EXPECT_EQ(file.nodes[1].position, Eigen::Vector3d(2.0, 0.0, 0.0));
  const auto shells = std::count_if(file.elements.begin(), file.elements.end(),
                                    [](const UffElement& element) { return element.descriptor == 94; });
  EXPECT_EQ(shells, 2);
}

}  // namespace
}  // namespace mottle::formats
