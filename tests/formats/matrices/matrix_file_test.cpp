#include "mottle/formats/matrices/matrix_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>
#include <filesystem>

#include "core/message_of.hpp"
#include "core/temporary_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"

namespace mottle::formats {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string place(const std::string& name) {
  return std::string(MOTTLE_SOURCE_DIR) + "/tests/formats/matrices/" + name;
}

/// The matrix that make_references.py writes in every format.
Eigen::MatrixXd reference() {
  constexpr int k_rows = 6;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(k_rows, k_rows);
  for (int i = 1; i <= k_rows; ++i) {
    for (int j = std::max(1, i - 2); j <= std::min(k_rows, i + 2); ++j) {
      matrix(i - 1, j - 1) = i == j ? 10.0 + i : std::cos(i * j + 1.0);
    }
  }
  return matrix;
}

Eigen::MatrixXd full(const SparseMatrix& lower) {
  const Eigen::MatrixXd dense = lower;
  return dense.selfadjointView<Eigen::Lower>();
}

struct FormatCase {
  const char* place;
  double tolerance;  ///< what the file's digits leave
};

class EveryFormat : public testing::TestWithParam<FormatCase> {};

TEST_P(EveryFormat, HoldsTheReferenceMatrix) {
  const SymmetricMatrix matrix = read_symmetric_matrix(place(GetParam().place));
  const Eigen::MatrixXd found = full(matrix.lower);
  ASSERT_GE(found.rows(), 6);
  EXPECT_LE((found.topLeftCorner(6, 6) - reference()).cwiseAbs().maxCoeff(), GetParam().tolerance);
}

INSTANTIATE_TEST_SUITE_P(Files, EveryFormat,
                         testing::Values(FormatCase{"symmetric.mtx", 1e-15}, FormatCase{"general.mtx", 1e-15},
                                         FormatCase{"array.mtx", 1e-15}, FormatCase{"scipy.rua", 1e-15},
                                         FormatCase{"layout.rsa", 1e-15}, FormatCase{"input_STIF1.mtx", 1e-14},
                                         FormatCase{"coordinate_STIF1.mtx", 1e-14}, FormatCase{"punch.pch#KAAX", 1e-8},
                                         FormatCase{"punch.pch#maax", 1e-5}, FormatCase{"text_dense.op4", 1e-15},
                                         FormatCase{"text_strings.op4", 1e-15}, FormatCase{"text_big.op4", 1e-15},
                                         FormatCase{"little_dense.op4", 1e-15}, FormatCase{"little_strings.op4", 1e-15},
                                         FormatCase{"little_big.op4", 1e-15}, FormatCase{"big_endian.op4#KAA", 1e-15},
                                         FormatCase{"octave.h5#A/value", 1e-15}),
                         [](const auto& each) {
                           std::string name = each.param.place;
                           for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
                           return name;
                         });

TEST(MatrixFile, ReadsTheMatrixThatIsNamed) {
  const SymmetricMatrix matrix = read_symmetric_matrix(place("big_endian.op4#MAA"));
  EXPECT_LE((full(matrix.lower) - 2.0 * reference()).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(MatrixFile, AsksForANameWhereAFileHoldsSeveral) {
  EXPECT_THAT(test::message_of<InvalidInput>([] { read_symmetric_matrix(place("punch.pch")); }),
              HasSubstr("holds the matrices KAAX, MAAX; name one behind a '#'"));
  EXPECT_THAT(test::message_of<InvalidInput>([] { read_symmetric_matrix(place("punch.pch#KAA")); }),
              HasSubstr("did you mean 'KAAX'?"));
}

TEST(MatrixFile, CarriesNamesOfDegreesOfFreedom) {
  const auto names = ElementsAre("101:+X", "101:+Z", "102:+X", "102:+Z", "103:+X", "103:+Z");
  EXPECT_THAT(read_symmetric_matrix(place("input_STIF1.mtx")).names, names);
  EXPECT_THAT(read_symmetric_matrix(place("punch.pch#KAAX")).names, names);
  EXPECT_THAT(read_symmetric_matrix(place("layout.rsa")).names, names);
}

TEST(MatrixFile, MarksTheRowsThatAbaqusHoldsByAPenalty) {
  EXPECT_THAT(read_symmetric_matrix(place("coordinate_STIF1.mtx")).fixed_rows, ElementsAre(6));
}

TEST(MatrixFile, ReadsWhatCalculixStores) {
  const SymmetricMatrix stiffness = read_symmetric_matrix(place("bar.sti"));
  const SymmetricMatrix mass = read_symmetric_matrix(place("bar.mas"));
  EXPECT_THAT(std::vector(stiffness.names.begin(), stiffness.names.begin() + 4),
              ElementsAre("5:+X", "5:+Y", "5:+Z", "6:+X"));
  ASSERT_EQ(stiffness.lower.rows(), 36);
  ASSERT_EQ(mass.names, stiffness.names);
  // u = x / L: uniform strain without contraction, and the integral of (x / L)^2.
  Eigen::VectorXd motion = Eigen::VectorXd::Zero(36);
  for (std::size_t row = 0; row < stiffness.names.size(); row += 3) {
    const int section = (std::stoi(stiffness.names[row]) - 1) / 4;
    motion(static_cast<Eigen::Index>(row)) = section / 3.0;
  }
  constexpr double k_area = 0.1 * 0.15;
  constexpr double k_hindered = 2.1e11 * 0.7 / (1.3 * 0.4);
  constexpr double k_digits = 1e-11;  // 14 of each entry, which cancel in the sum
  EXPECT_NEAR(motion.dot(full(mass.lower) * motion) / (7800.0 * k_area * 3.0 / 3.0), 1.0, k_digits);
  EXPECT_NEAR(motion.dot(full(stiffness.lower) * motion) / (k_hindered * k_area / 3.0), 1.0, k_digits);
}

/// A group of datasets, written by the HDF5 library itself.
void write_group(const std::filesystem::path& file,
                 const std::vector<std::pair<std::string, std::vector<double>>>& sets) {
  const hid_t id = H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t group = H5Gcreate2(id, "K", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  for (const auto& [name, values] : sets) {
    const hsize_t size = values.size();
    const hid_t space = H5Screate_simple(1, &size, nullptr);
    const hid_t type = name == "data" ? H5T_IEEE_F64BE : H5T_STD_I32LE;
    const hid_t set = H5Dcreate2(group, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(set);
    H5Sclose(space);
  }
  H5Gclose(group);
  H5Fclose(id);
}

TEST(MatrixFile, ReadsGroupsOfHdf5) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "groups.h5";
  const Eigen::Matrix2d expected{{2.0, -1.0}, {-1.0, 3.0}};
  write_group(file, {{"data", {2, -1, -1, 3}}, {"indices", {0, 1, 0, 1}}, {"indptr", {0, 2, 4}}});
  EXPECT_EQ(full(read_symmetric_matrix(file.string() + "#K").lower), expected);
  write_group(file, {{"data", {2, -1, 3}}, {"row", {0, 1, 1}}, {"col", {0, 0, 1}}});
  EXPECT_EQ(full(read_symmetric_matrix(file.string()).lower), expected);
  write_group(file, {{"data", {2, -1, 3}}, {"indices", {0, 1, 7}}, {"indptr", {0, 2, 3}}});
  EXPECT_THAT(test::message_of<FormatError>([&] { read_symmetric_matrix(file.string()); }),
              HasSubstr("entry (2, 8) is outside"));
  write_group(file, {{"data", {2, -1, 3}}, {"indices", {0, 1, 1}}, {"indptr", {0, 9, 3}}});
  EXPECT_THAT(test::message_of<FormatError>([&] { read_symmetric_matrix(file.string()); }),
              HasSubstr("'/K/indptr' is not"));
}

struct Malformed {
  const char* name;
  std::string text;
  const char* message;
};

class MalformedMatrix : public testing::TestWithParam<Malformed> {};

TEST_P(MalformedMatrix, IsAnErrorWithFileAndLine) {
  EXPECT_THAT(test::message_of<FormatError>([] { parse_symmetric_matrix(GetParam().text, "k.x", ""); }),
              HasSubstr(GetParam().message));
}

const std::string k_market = "%%MatrixMarket matrix coordinate real symmetric\n";
const std::string k_output4 = "       2       2       6       2K       1P,3E23.16\n";
const std::string k_boeing = "title\n 3 1 1 1\nRSA 2 2 2 0\n(3I8)           (3I8)           (3E20.12)           \n";
const std::string k_dmig = "DMIG    K              0       6       2       0\n";

INSTANTIATE_TEST_SUITE_P(
    Files, MalformedMatrix,
    testing::Values(
        Malformed{"NoEntry", "", "k.x: holds no matrix entry"},
        Malformed{"MarketField", "%%MatrixMarket matrix coordinate complex symmetric\n1 1 1\n1 1 1 0\n",
                  "k.x:1: field 'complex' is not read here"},
        Malformed{"MarketSkew", "%%MatrixMarket matrix coordinate real skew-symmetric\n1 1 0\n",
                  "k.x:1: a stiffness or mass matrix is symmetric"},
        Malformed{"MarketHeader", "%%MatrixMarket vector\n", "k.x:1: expected '%%MatrixMarket matrix"},
        Malformed{"MarketNotSquare", k_market + "2 3 1\n1 1 1\n", "k.x:2: the matrix is 2 x 3, not square"},
        Malformed{"MarketNearlyEmpty", k_market + "9000000 9000000 1\n1 1 1\n", "nearly all of its rows are empty"},
        Malformed{"MarketHuge", k_market + "2000000000 2000000000 1\n1 1 1\n", "k.x:2: 2000000000 rows, more than"},
        Malformed{"MarketShort", k_market + "2 2 3\n1 1 1\n", "k.x:3: the file ends here; expected entry 2 of 3"},
        Malformed{"MarketLong", k_market + "2 2 1\n1 1 1\n2 2 1\n", "k.x:4: stands after the last entry"},
        Malformed{"MarketOutside", k_market + "2 2 1\n3 1 1\n", "k.x:3: entry (3, 1) is outside of the 2 x 2 matrix"},
        Malformed{"MarketZeroBased", k_market + "2 2 1\n0 0 1\n", "k.x:3: entry (0, 0) is outside"},
        Malformed{"MarketUpper", k_market + "2 2 1\n1 2 1\n", "k.x:3: a symmetric matrix is stored by its lower"},
        Malformed{"MarketTwice", k_market + "2 2 2\n1 1 1\n1 1 1\n", "k.x:4: entry (1, 1) is given twice"},
        Malformed{"MarketNumber", k_market + "2 2 1\n1 1 x\n", "k.x:3: 'x' is not a finite number"},
        Malformed{"MarketInfinite", k_market + "2 2 1\n1 1 inf\n", "k.x:3: 'inf' is not a finite number"},
        Malformed{"NotSymmetric",
                  "%%MatrixMarket matrix coordinate real general\n2 2 4\n1 1 2\n2 1 -1\n1 2 -1.1\n2 2 2\n",
                  "the matrix is not symmetric: entries (2, 1) and (1, 2) are -1 and -1.1"},
        Malformed{"OneSided", "%%MatrixMarket matrix coordinate real general\n3 3 3\n1 1 2\n2 1 -1\n1 3 -1\n",
                  "the matrix is not symmetric"},
        Malformed{"TripleWords", "1 1 2.0\n1 2\n", "k.x:2: '1 2' is not 'row column value'"},
        Malformed{"TripleRow", "1 1.5 2.0\n", "k.x:1: '1 1.5 2.0' is not 'row column value'"},
        Malformed{"AbaqusFields", "1,1, 1,1\n", "is not 'node, component, node, component, value'"},
        Malformed{"AbaqusComponent", "1,0, 1,1, 3.0\n", "is not 'node, component"},
        Malformed{"DmigForm", "DMIG    K              0       9       2       0\n", "k.x:1: matrix 'K' has form 9"},
        Malformed{"DmigComplex", "DMIG    K              0       6       3       0\n", "k.x:1: matrix 'K' has type 3"},
        Malformed{"DmigNoHeader", "DMIG*   K                              1               1\n",
                  "k.x:1: a column of 'K' stands before its header"},
        Malformed{"DmigNoColumn", k_dmig + "*                      1               1 1.0\n",
                  "k.x:2: a row stands before"},
        Malformed{"DmigComponent", k_dmig + "DMIG*   K                              1               7\n",
                  "k.x:2: grid point 1, component 7: components are 0 to 6"},
        Malformed{"DmigOther", k_dmig + "GRID    1\n", "k.x:2: 'GRID' is not a DMIG card"},
        Malformed{"Output4Column", k_output4 + "       5       1       2\n",
                  "k.x:2: column 5 with 2 words follows column 0"},
        Malformed{"Output4Head", k_output4 + "       1       0       3\n x\n", "k.x:3: expected the head of a string"},
        Malformed{"Output4String", k_output4 + "       1       0       3\n  655361\n",
                  "k.x:3: a string of 9 words in column 1, where 2 words are left"},
        Malformed{"Output4End", k_output4 + "       1       1       2\n 1.0\n",
                  "k.x:3: the file ends here; expected more"},
        Malformed{"Output4Complex",
                  "       2       2       6       4K       1P,3E23.16\n       3       1       1\n 1.0\n",
                  "matrix 'K' is complex"},
        Malformed{"BoeingType", "title\n 3 1 1 1\nCSA 2 2 2 0\n(3I8)           (3I8)           (3E20.12)\n",
                  "k.x:3: type 'CSA' is not read here"},
        Malformed{"BoeingFormat", "title\n 3 1 1 1\nRSA 2 2 2 0\nfree            (3I8)           (3E20.12)\n",
                  "k.x:4: 'free' is not a Fortran format"},
        Malformed{"BoeingPointer", k_boeing + "       1       9       3\n", "k.x:5: column pointer 9 is wrong"},
        Malformed{"BoeingRow", k_boeing + "       1       2       3\n       1       7\n",
                  "k.x:6: row 7 is outside of the 2 x 2 matrix"},
        Malformed{"BoeingEnd", k_boeing + "       1       2       3\n       1       2\n",
                  "k.x:6: the file ends here; expected values"}),
    [](const auto& each) { return std::string(each.param.name); });

TEST(MatrixFile, RefusesBinaryOutput4ThatIsCutOff) {
  const std::string whole = read_file(place("little_strings.op4"));
  for (std::size_t size = 4; size + 1 < whole.size(); ++size) {
    EXPECT_THROW(parse_symmetric_matrix(whole.substr(0, size), "k.op4", ""), FormatError) << size;
  }
}

TEST(MatrixFile, ReadsNamesOfRows) {
  EXPECT_THAT(parse_row_names("101.3\n7.0\n12:+RX\n", "k.dof"), ElementsAre("101:+Z", "7", "12:+RX"));
  EXPECT_THAT(test::message_of<FormatError>([] { parse_row_names("101.3\n101.9\n", "k.dof"); }),
              HasSubstr("k.dof:2: '101.9' is not NODE.DIRECTION"));
}

}  // namespace
}  // namespace mottle::formats
