// Modes in Nastran's printed and punched output. The tables are from a run of MSC.Nastran 2005 (pyNastran's example
// "beam_modes": ten bars and a mass at their end), shortened to three modes and two or three points.
#include "mottle/formats/nastran/modes.hpp"

#include <gmock/gmock.h>

#include <string>

#include "mottle/core/error.hpp"

namespace {

using mottle::FormatError;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

const std::string k_eigenvalues =
    "1    SIMPLE BEAM EXAMPLE                                                      APRIL  10, 2013  MSC.NASTRAN  "
    "6/17/05   PAGE    13\n"
    "      MODES                                                                                                       "
    " \n"
    "0                                                                                                                 "
    " \n"
    " \n"
    "                                              R E A L   E I G E N V A L U E S\n"
    "   MODE    EXTRACTION      EIGENVALUE            RADIANS             CYCLES            GENERALIZED         "
    "GENERALIZED\n"
    "    NO.       ORDER                                                                       MASS              "
    "STIFFNESS\n"
    "        1         1        8.232776E+06        2.869281E+03        4.566603E+02        8.719168E-03        "
    "7.178296E+04\n"
    "        2         2        8.232776E+06        2.869281E+03        4.566603E+02        8.719168E-03        "
    "7.178296E+04\n"
    "        3         3        2.824056E+08        1.680493E+04        2.674587E+03        1.714052E-02        "
    "4.840580E+06\n"
    "1    SIMPLE BEAM EXAMPLE                                                      APRIL  10, 2013  MSC.NASTRAN  "
    "6/17/05   PAGE    14\n";

const std::string k_mode1 =
    "      EIGENVALUE =  8.232776E+06\n"
    "          CYCLES =  4.566603E+02         R E A L   E I G E N V E C T O R   N O .          1\n"
    " \n"
    "      POINT ID.   TYPE          T1             T2             T3             R1             R2             R3\n"
    "             1      G      0.0            0.0            0.0            0.0            0.0            0.0\n"
    "             2      G      1.266788E-17   2.771224E-03   1.857573E-02   5.445647E-17  -3.055872E-02   "
    "4.558909E-03\n";
const std::string k_page =
    "1    SIMPLE BEAM EXAMPLE                                                      APRIL  10, 2013  MSC.NASTRAN  "
    "6/17/05   PAGE    16\n"
    "      MODES                                                                                                       "
    " \n"
    "0                                                                                                                 "
    " \n";
const std::string k_mode2 =
    "      EIGENVALUE =  8.232776E+06\n"
    "          CYCLES =  4.566603E+02         R E A L   E I G E N V E C T O R   N O .          2\n"
    " \n"
    "      POINT ID.   TYPE          T1             T2             T3             R1             R2             R3\n"
    "             1      G      0.0            0.0            0.0            0.0            0.0            0.0\n"
    "             2      G      4.382678E-19   1.857573E-02  -2.771224E-03   1.949025E-18   4.558909E-03   "
    "3.055872E-02\n";

// Displacements in punch format, with the values above; the layout of its lines is that of the same example's forces.
const std::string k_punch =
    "$TITLE   = SIMPLE BEAM EXAMPLE                                                 1\n"
    "$SUBTITLE= MODES                                                               2\n"
    "$LABEL   =                                                                     3\n"
    "$EIGENVECTOR                                                                   4\n"
    "$REAL OUTPUT                                                                   5\n"
    "$SUBCASE ID =           1                                                      6\n"
    "$EIGENVALUE =  8.2327765E+06  MODE =     1                                     7\n"
    "         2       G      1.266788E-17      2.771224E-03      1.857573E-02       8\n"
    "-CONT-                  5.445647E-17     -3.055872E-02      4.558909E-03       9\n"
    "        12       S      1.000000E+00      0.000000E+00      0.000000E+00      10\n"
    "-CONT-                  0.000000E+00      0.000000E+00      0.000000E+00      11\n"
    "$TITLE   = SIMPLE BEAM EXAMPLE                                                12\n"
    "$EIGENVECTOR                                                                  13\n"
    "$REAL OUTPUT                                                                  14\n"
    "$EIGENVALUE =  2.8240563E+08  MODE =     2                                    15\n"
    "         2       G      4.382678E-19      1.857573E-02     -2.771224E-03      16\n"
    "-CONT-                  1.949025E-18      4.558909E-03      3.055872E-02      17\n"
    "        12       S      2.000000E+00                                          18\n"
    "$TITLE   = SIMPLE BEAM EXAMPLE                                                19\n"
    "$ELEMENT FORCES                                                               20\n"
    "$EIGENVALUE =  2.8240563E+08  MODE =     2                                    21\n"
    "         1              1.146587E+05      7.685664E+05      1.001748E+05      22\n"
    "-CONT-                  6.714796E+05      1.448392E+04      9.708680E+04      23\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, from.size(), to);
}

TEST(NastranModes, TheEigenvalueTableIsReadFromAPrintout) {
  const Eigen::VectorXd values =
      mottle::formats::read_f06_eigenvalues(mottle::formats::LineWalker(k_eigenvalues), "m.f06");
  EXPECT_THAT(std::vector(values.begin(), values.end()), ElementsAre(8.232776e6, 8.232776e6, 2.824056e8));
}

TEST(NastranModes, ATableThatStartsAnewReplacesTheOneBefore) {
  const std::string second = replaced(k_eigenvalues, "2.824056E+08", "2.900000E+08");
  const Eigen::VectorXd values =
      mottle::formats::read_f06_eigenvalues(mottle::formats::LineWalker(k_eigenvalues + second), "m.f06");
  EXPECT_THAT(std::vector(values.begin(), values.end()), ElementsAre(8.232776e6, 8.232776e6, 2.9e8));
}

TEST(NastranModes, ATableGoesOnOverAPage) {
  const std::size_t third = k_eigenvalues.find("        3         3");
  const std::string continued = k_eigenvalues.substr(0, third) + k_page + k_eigenvalues.substr(third);
  const std::string titled =
      replaced(continued, "        3         3", "   R E A L   E I G E N V A L U E S\n        3         3");
  EXPECT_EQ(mottle::formats::read_f06_eigenvalues(mottle::formats::LineWalker(titled), "m.f06").size(), 3);
}

TEST(NastranModes, GarbageInTheTableIsNamedByItsLine) {
  const auto read = [](const std::string& text) {
    return [text] { mottle::formats::read_f06_eigenvalues(mottle::formats::LineWalker(text), "m.f06"); };
  };
  EXPECT_THAT(read(replaced(k_eigenvalues, "2.824056E+08", "*********** ")),
              ThrowsMessage<FormatError>(HasSubstr("m.f06:10: ")));
  EXPECT_THAT(read(replaced(k_eigenvalues, "2.824056E+08", "NaN         ")),
              ThrowsMessage<FormatError>(HasSubstr("m.f06:10: ")));
  EXPECT_THAT(read(replaced(k_eigenvalues, "        2         2", "        4         2")),
              ThrowsMessage<FormatError>(HasSubstr("m.f06:9: mode 4 follows mode 1")));
  EXPECT_THAT(read(replaced(k_eigenvalues, "        1         1", "        0         1")),
              ThrowsMessage<FormatError>(HasSubstr("m.f06:8: modes are numbered from 1 on, found 0")));
  EXPECT_THAT(read(replaced(k_eigenvalues, "8.719168E-03        7.178296E+04", "")),
              ThrowsMessage<FormatError>(HasSubstr("m.f06:8: ")));
  EXPECT_THAT(read("no table"), ThrowsMessage<FormatError>(HasSubstr("has no table")));
}

TEST(NastranModes, EigenvectorsAreReadFromAPrintout) {
  const mottle::formats::NamedShapes shapes =
      mottle::formats::read_f06_shapes(mottle::formats::LineWalker(k_mode1 + k_page + k_mode2), "m.f06");
  ASSERT_EQ(shapes.values.rows(), 12);
  ASSERT_EQ(shapes.values.cols(), 2);
  EXPECT_EQ(shapes.names[7], "2:+Y");
  EXPECT_EQ(shapes.names[10], "2:+RY");
  EXPECT_EQ(shapes.values(8, 0), 1.857573e-2);
  EXPECT_EQ(shapes.values(11, 1), 3.055872e-2);
}

TEST(NastranModes, AnEigenvectorGoesOnOverAPage) {
  const std::size_t second = k_mode1.find("             2      G");
  const std::string head = k_mode1.substr(0, k_mode1.find("             1      G"));
  const mottle::formats::NamedShapes whole =
      mottle::formats::read_f06_shapes(mottle::formats::LineWalker(k_mode1), "m.f06");
  const mottle::formats::NamedShapes parts = mottle::formats::read_f06_shapes(
      mottle::formats::LineWalker(k_mode1.substr(0, second) + k_page + head + k_mode1.substr(second)), "m.f06");
  EXPECT_EQ(parts.names, whole.names);
  EXPECT_EQ(parts.values, whole.values);
}

TEST(NastranModes, ModesWithOtherPointsAreRefused) {
  const std::string other = replaced(k_mode2, "             2      G", "             3      G");
  EXPECT_THAT([&] { mottle::formats::read_f06_shapes(mottle::formats::LineWalker(k_mode1 + other), "m.f06"); },
              ThrowsMessage<FormatError>(HasSubstr("m.f06:8: mode 2 lists other degrees of freedom")));
}

TEST(NastranModes, PunchedEigenvectorsAreReadAndForcesAreNot) {
  const mottle::formats::NamedShapes shapes =
      mottle::formats::read_punch_shapes(mottle::formats::LineWalker(k_punch), "m.pch");
  EXPECT_THAT(shapes.names, ElementsAre("2:+X", "2:+Y", "2:+Z", "2:+RX", "2:+RY", "2:+RZ", "12"));
  ASSERT_EQ(shapes.values.cols(), 2);
  EXPECT_EQ(shapes.values(4, 0), -3.055872e-2);
  EXPECT_EQ(shapes.values(2, 1), -2.771224e-3);
  EXPECT_EQ(shapes.values(6, 1), 2.0);
  const Eigen::VectorXd values = mottle::formats::read_punch_eigenvalues(mottle::formats::LineWalker(k_punch), "m.pch");
  EXPECT_THAT(std::vector(values.begin(), values.end()), ElementsAre(8.2327765e6, 2.8240563e8));
}

TEST(NastranModes, FieldsThatTouchAreStillFields) {
  const std::string touching =
      replaced(k_punch, "      2.771224E-03      1.857573E-02", "-2.77122400000E-103.757573000000E-02");
  const mottle::formats::NamedShapes shapes =
      mottle::formats::read_punch_shapes(mottle::formats::LineWalker(touching), "m.pch");
  EXPECT_EQ(shapes.values(1, 0), -2.771224e-10);
  EXPECT_EQ(shapes.values(2, 0), 3.757573e-2);
}

TEST(NastranModes, ABrokenPunchFileIsNamedByItsLine) {
  const auto read = [](const std::string& text) {
    return [text] { mottle::formats::read_punch_shapes(mottle::formats::LineWalker(text), "m.pch"); };
  };
  EXPECT_THAT(
      read(replaced(k_punch, "-CONT-                  5.445647E-17     -3.055872E-02      4.558909E-03       9\n", "")),
      ThrowsMessage<FormatError>(HasSubstr("m.pch:9: not a point")));
  EXPECT_THAT(read(replaced(k_punch, "1.857573E-02", "1.85757*E-02")),
              ThrowsMessage<FormatError>(HasSubstr("m.pch:8: ")));
  EXPECT_THAT(read(replaced(k_punch, "MODE =     2", "MODE =     3")),
              ThrowsMessage<FormatError>(HasSubstr("m.pch:15: mode 3 follows mode 1")));
}

}  // namespace
