// What a wrong universal file is told: file, line and what is wrong. One row a mistake.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/message_of.hpp"
#include "formats/uff/datasets.hpp"
#include "mottle/core/error.hpp"
#include "mottle/formats/uff/frames.hpp"
#include "mottle/formats/uff/uff.hpp"

namespace mottle::formats {
namespace {

using test::dataset;
using test::function_head;
using test::k_uff_mode;
using test::k_uff_titles;
using ::testing::StartsWith;

struct Mistake {
  std::string bytes;
  std::string message;  ///< behind "bad.uff:"
};

class MistakenUff : public ::testing::TestWithParam<Mistake> {};

TEST_P(MistakenUff, IsRefusedWithFileAndLine) {
  const std::string message =
      test::message_of<FormatError>([&] { const UffFrames frames(parse_uff(GetParam().bytes, "bad.uff")); });
  EXPECT_THAT(message, StartsWith("bad.uff:" + GetParam().message));
}

/// The mode of datasets.hpp with one of its lines (1 is the first title) replaced.
std::string mode_with(int line, const std::string& text) {
  std::string records;
  std::size_t at = 0;
  for (int k = 1; at < k_uff_mode.size(); ++k) {
    const std::size_t end = k_uff_mode.find('\n', at) + 1;
    records += k == line ? text : k_uff_mode.substr(at, end - at);
    at = end;
  }
  return dataset("55", records);
}

std::string binary(const std::string& head, const std::string& payload) {
  return "    -1\n    58b" + head + "\n" +
         function_head("         4         2         1  0.00000E+00  1.00000E+00  0.00000E+00\n") + payload +
         "    -1\n";
}

const std::string k_even = "         2         3         1  0.00000E+00  1.00000E+00  0.00000E+00\n";
const std::string k_little = "     1     2          11          16     0     0           0           0";

INSTANTIATE_TEST_SUITE_P(
    Frame, MistakenUff,
    ::testing::Values(Mistake{"", " is empty"}, Mistake{"\n \r\n", " is empty"},
                      Mistake{"f1,f2\n1,2\n", "1: this is no universal file: its first line should be '    -1'"},
                      Mistake{"    -1\n", "1: the file ends where the dataset's number should be"},
                      Mistake{"    -1\n    -1\n", "2: the dataset ends where the dataset's number should be"},
                      Mistake{"    -1\n  text\n", "2: a dataset's number is needed behind the mark -1"},
                      Mistake{"    -1\n    55x\n", "2: a dataset's number is needed behind the mark -1"},
                      Mistake{dataset("151", "") + "text\n", "4: text outside a dataset"},
                      Mistake{"    -1\n   999\nanything\n", "3: the file ends within dataset 999 of line 2"}));

INSTANTIATE_TEST_SUITE_P(
    Geometry, MistakenUff,
    ::testing::Values(
        Mistake{dataset("164", "         1SI\n  1.0D+00\n"), "4: factors of length 1 and force 0"},
        Mistake{dataset("164", "         1SI\n  0.0D+00  1.0D+00  1.0D+00\n 0.\n"),
                "4: factors of length 0 and force 1"},
        Mistake{dataset("164", "1SI\n1. 1. 1.\n0.\n") + dataset("164", "5mm\n1000. 1. 1.\n0.\n"),
                "11: a second dataset 164 with other factors"},
        Mistake{dataset("2411", "         1         0         0        11\n 1.0 2.0\n"),
                "4: 2 numbers stand where 3 are"},
        Mistake{dataset("2411", "         1         0         0        11\n"),
                "4: the dataset ends where a node's position"},
        Mistake{dataset("2411", "1 0 0 11\n0. 0. 0.\n1 0 0 11\n9. 0. 0.\n"),
                "6: node 1 is given already in line 4, with other content"},
        Mistake{dataset("2411", "-5 0 0 11\n0. 0. 0.\n"), "4: node -5: labels start from 1"},
        Mistake{dataset("15", "       1.5         0         0         8  1.0  2.0  3.0\n"),
                "3: 1.5 stands where a whole number should be"},
        Mistake{dataset("15", "         1         0         0         8          1.0          abc          3.0\n"),
                "3: 'abc' stands where"},
        Mistake{dataset("15", "1 0 7 8 1. 2. 3.\n"), "3: coordinate system 7 is not in the file"},
        Mistake{dataset("18", "1 0 0 8 1\nA\n0. 0. 0. 1. 0. 0.\n2. 0. 0.\n"),
                "6: the coordinate system's three points"},
        Mistake{dataset("18", "1 9 0 8 1\nA\n0. 0. 0. 1. 0. 0.\n0. 0. 1.\n"), "3: coordinate system type 9"},
        Mistake{dataset("18", "4 0 4 8 1\nA\n0. 0. 0. 1. 0. 0.\n0. 0. 1.\n") + dataset("15", "1 0 4 8 0. 0. 0.\n"),
                "3: coordinate system 4 rests on itself"},
        Mistake{dataset("2420", "1\np\n1 0 8\nA\n1. 0. 0.\n0. 2. 0.\n0. 0. 1.\n0. 0. 0.\n"),
                "9: coordinate system 1: its matrix is no rotation"},
        Mistake{dataset("82", "         1         9         8\nwing\n         1         2\n"),
                "6: the dataset ends where nodes of a trace line should be"},
        Mistake{dataset("2412", "1 94 1 1 7 2000000000\n1 2 3 4\n"), "5: the dataset ends where nodes of an element"},
        Mistake{dataset("2412", "1 94 1 1 7 3\n1 2 3 4\n"), "4: element 1 has more than 3 nodes"}));

INSTANTIATE_TEST_SUITE_P(
    Shapes, MistakenUff,
    ::testing::Values(
        Mistake{dataset("55", "only\n"), "4: the dataset ends where a title should be"},
        Mistake{mode_with(6, "         1         2         2         8         7         3\n"), "8: data type 7"},
        Mistake{mode_with(7, "         2        -4         1         3\n"), "9: 2 whole and -4 real numbers"},
        Mistake{mode_with(7, "two four\n"), "9: 'two' stands where a number should be"},
        Mistake{mode_with(8, "************  2.00000E+00  1.00000E-02  0.00000E+00\n"),
                "10: '************' stands where"},
        Mistake{mode_with(8, " -1.25000E+01  2.00000E+00  1.00000E-02  0.00000E+00\n"),
                "10: the frequency -12.5 is negative"},
        Mistake{mode_with(10, "  1.00000E+00 -5.00000E-01\n"), "12: 2 numbers stand where 3 are needed"},
        Mistake{mode_with(10, "  1.00000E+00          nan  0.00000E+00\n"),
                "12: 'nan' stands where a number should be"},
        Mistake{mode_with(10, "1. 2. 3. 4.\n"), "12: 4 numbers stand where 3 are left"},
        Mistake{mode_with(11, "         1\n"), "13: node 1 is given twice in one shape"},
        Mistake{mode_with(12, ""), "14: the dataset ends where 3 values of node 2 should be"},
        Mistake{dataset("55", k_uff_mode.substr(0, k_uff_mode.find("         1\n"))), "10: a shape without nodes"}));

INSTANTIATE_TEST_SUITE_P(
    Functions, MistakenUff,
    ::testing::Values(
        Mistake{dataset("58", function_head("         3         3         1  0.00000E+00  1.00000E+00  0.00000E+00\n")),
                "9: data type 3"},
        Mistake{dataset("58", function_head("         2         0         1  0.00000E+00  1.00000E+00  0.00000E+00\n")),
                "9: 0 points"},
        Mistake{dataset("58", function_head(k_even) + "  1.00000E+00  2.00000E+00\n"), "14: 2 numbers stand where 3"},
        Mistake{dataset("58", function_head(k_even) + "1. 2. 3.\n4.\n"), "15: dataset 58 of line 2 is complete, yet"},
        Mistake{dataset("58", function_head("         2 900000000         1\n") + "1. 2. 3. 4. 5. 6.\n"),
                "15: the dataset ends where the function's values should be"},
        Mistake{binary("     3     2          11          16", ""), "2: byte order 3"},
        Mistake{binary("     1     1          11          16", ""), "2: floating-point format 1"},
        Mistake{binary("     1     2           7          16", ""), "2: 7 lines of text"},
        Mistake{binary(k_little, "short\n"), "13: at byte 535: 2 points take 16 bytes"},
        Mistake{binary(k_little, std::string(8, '\0') + "\0\0\0\0\0\0\xf8\x7f" + "\n"), "13: at byte"}));

}  // namespace
}  // namespace mottle::formats
