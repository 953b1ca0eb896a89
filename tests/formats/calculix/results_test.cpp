#include "mottle/formats/calculix/results.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "core/message_of.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/formats/matrices/matrix_file.hpp"

namespace mottle::formats {
namespace {

using testing::HasSubstr;

const std::string k_bar = std::string(MOTTLE_SOURCE_DIR) + "/tests/formats/matrices/bar";

/// The bar's modes by Eigen, from the matrices that CalculiX stored.
struct Solved {
  Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes;
  std::vector<std::string> names;

  Solved() {
    const SymmetricMatrix stiffness = read_symmetric_matrix(k_bar + ".sti");
    const SymmetricMatrix mass = read_symmetric_matrix(k_bar + ".mas");
    modes.compute(Eigen::MatrixXd(stiffness.lower), Eigen::MatrixXd(mass.lower));
    names = stiffness.names;
  }
};

TEST(CalculixResults, EigenvaluesAreThoseOfTheStoredMatrices) {
  const Eigen::VectorXd found = parse_calculix_eigenvalues(read_file(k_bar + ".dat"), "bar.dat");
  const Solved solved;
  ASSERT_EQ(found.size(), 5);
  EXPECT_TRUE(found.isApprox(solved.modes.eigenvalues().head(5), 1e-6));  // 7 digits
}

TEST(CalculixResults, ShapesAreThoseOfTheStoredMatrices) {
  const std::vector<CalculixShape> shapes = parse_calculix_shapes(read_file(k_bar + ".frd"), "bar.frd");
  const Solved solved;
  ASSERT_EQ(shapes.size(), 5U);
  for (std::size_t r = 0; r < shapes.size(); ++r) {
    const auto mode = static_cast<Eigen::Index>(r);
    const double lambda = solved.modes.eigenvalues()(mode);
    EXPECT_NEAR(shapes[r].frequency, std::sqrt(lambda) / (2.0 * M_PI), 1e-8 * std::sqrt(lambda));
    Eigen::VectorXd shape(static_cast<Eigen::Index>(solved.names.size()));
    for (std::size_t k = 0; k < solved.names.size(); ++k) {
      const std::string& name = solved.names[k];
      shape(static_cast<Eigen::Index>(k)) = shapes[r].displacements.at(std::stoi(name))(name.back() - 'X');
    }
    const Eigen::VectorXd expected = solved.modes.eigenvectors().col(mode);
    const double cosine = shape.normalized().dot(expected.normalized());
    EXPECT_NEAR(std::abs(cosine), 1.0, 1e-9) << r;  // 6 digits
  }
}

// As CalculiX 2.20 writes a *STATIC step and a mode of the *FREQUENCY step behind it.
TEST(CalculixResults, DisplacementsOfAPreloadAreNoShape) {
  const std::string block = " -4  DISP        4    1\n -1         3 1.00000E+00 2.00000E+00 3.00000E+00\n -3\n";
  const std::vector<CalculixShape> shapes =
      parse_calculix_shapes("  100CL  101 1.000000000         128                     0    1           1\n" + block +
                                "  100CL  102 18.92311740         128                     2    2MODAL      1\n" + block,
                            "beam.frd");
  ASSERT_EQ(shapes.size(), 1U);
  EXPECT_EQ(shapes[0].frequency, 18.9231174);
}

TEST(CalculixResults, FaultsAreToldWithFileAndLine) {
  const auto shapes = [](const std::string& text) {
    return test::message_of<FormatError>([&] { parse_calculix_shapes(text, "a.frd"); });
  };
  EXPECT_THAT(shapes("    1C\n 9999\n"), HasSubstr("a.frd: holds no displacements"));
  EXPECT_THAT(shapes(" -4  DISP        4    1\n -1         1 1.00000E+00\n"),
              HasSubstr("a.frd:2: the line ends before"));
  EXPECT_THAT(shapes(" -4  DISP        4    1\n -1         1 1.00000E+00 x.00000E+00 1.00000E+00\n"),
              HasSubstr("a.frd:2: ' x.00000E+00' is not a finite number"));
  EXPECT_THAT(shapes(" -4  DISP        4    1\n -1         1 1.00000E+00 1.00000E+00 1.00000E+00\n"),
              HasSubstr("a.frd:2: the file ends here"));
  const auto values = [](const std::string& text) {
    return test::message_of<FormatError>([&] { parse_calculix_eigenvalues(text, "a.dat"); });
  };
  EXPECT_THAT(values("\n"), HasSubstr("a.dat: holds no table"));
  EXPECT_THAT(values(" E I G E N V A L U E   O U T P U T\n 1 0.1E+02\n 3 0.2E+02\n"),
              HasSubstr("a.dat:3: mode 3 follows mode 1"));
  EXPECT_THAT(values(" E I G E N V A L U E   O U T P U T\n 2 0.1E+02\n"), HasSubstr("a.dat:2: the first mode is 2"));
  // Of a contact with friction, as CalculiX 2.20 writes it.
  EXPECT_THAT(values("     E I G E N V A L U E   O U T P U T\n\n MODE NO                     FREQUENCY\n"
                     "                      REAL PART         IMAGINARY PART\n\n"
                     "      1   0.4504251E+06   0.7168738E+05   0.0000000E+00\n"),
              HasSubstr("a.dat:3: its modes are those of a stiffness that is not symmetric"));
  EXPECT_THAT(values(" E I G E N V A L U E   O U T P U T\n 1 ****\n"), HasSubstr("a.dat:2: '****' is not"));
}

}  // namespace
}  // namespace mottle::formats
