// GENEL: what the card says, and that its matrices are those of a beam written so.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <string>

#include "formats/nastran/model_of.hpp"
#include "mottle/fem/assembly/assembly.hpp"

namespace mottle::formats {
namespace {

/// Stiffness of all free degrees of freedom.
Eigen::MatrixXd stiffness_of(const std::string& deck) {
  FiniteElementModel model = test::model_of(deck).model;
  model.settings.automatic_constraints = AutomaticConstraints::none;
  const Eigen::MatrixXd lower = fem::assemble(model, {}).stiffness.at(Eigen::VectorXd());
  return lower.selfadjointView<Eigen::Lower>();
}

/// E A = 300, E I1 = 75, E I2 = 150, G J = 60, of length 3.
const std::string k_bar =
    "GRID,1\nGRID,2,,3.,0.,0.\nMAT1,1,1000.,400.\nPBAR,1,1,.3,.075,.15,.15\nCBAR,1,1,1,2,0.,1.,0.\n";
const std::string k_points = "GRID,1\nGRID,2,,3.,0.,0.\n";
const std::string k_free_end = "GENEL,9,,2,1,2,2,2,3\n,2,4,2,5,2,6\n";
const std::string k_clamped_end = ",UD,,1,1,1,2,1,3\n,1,4,1,5,1,6\n";
// L/EA; L^3/3EI1, L^2/2EI1; L^3/3EI2, -L^2/2EI2; L/GJ; L/EI2; L/EI1.
const std::string k_flexibility = ",Z,.01,,,,,,.12\n,,,,.06,.06,,-.03\n,.05,,,.02,,.04\n";
// The inverse: EA/L; 12EI1/L^3, -6EI1/L^2; 12EI2/L^3, 6EI2/L^2; GJ/L; 4EI2/L; 4EI1/L.
const std::string k_stiffness =
    ",K,100.,,,,,,33.333333333333333\n,,,,-50.,66.666666666666667,,100.\n,20.,,,200.,,100.\n";
// v = v_A + 3 rz_A, w = w_A - 3 ry_A.
const std::string k_rigid_motion = ",S,1.,,,,,,\n,1.,,,,3.,,,1.\n,,-3.,,,,,1.,\n,,,,,,1.,,\n,,,,,1.\n";

double difference(const std::string& deck) {
  const Eigen::MatrixXd bar = stiffness_of(k_bar);
  return (stiffness_of(k_points + deck) - bar).cwiseAbs().maxCoeff() / bar.maxCoeff();
}

TEST(NastranGeneralElement, EqualsTheBarByTheFlexibilityOfACantilever) {
  EXPECT_LT(difference(k_free_end + k_clamped_end + k_flexibility + k_rigid_motion), 1e-14);
}

TEST(NastranGeneralElement, EqualsTheBarByTheStiffnessOfACantilever) {
  EXPECT_LT(difference(k_free_end + k_clamped_end + k_stiffness + k_rigid_motion), 1e-14);
}

TEST(NastranGeneralElement, FindsItsRigidMotionByItsPoints) {
  EXPECT_LT(difference(k_free_end + k_clamped_end + k_flexibility), 1e-14);
  EXPECT_LT(difference(k_free_end + k_clamped_end + k_stiffness), 1e-14);
}

// Without UD the other end is clamped.
TEST(NastranGeneralElement, WithoutSupportsActsOnItsOwnDegreesOfFreedomAlone) {
  Eigen::MatrixXd expected = stiffness_of(k_bar);
  expected.leftCols(6).setZero();
  expected.topRows(6).setZero();
  const Eigen::MatrixXd found = stiffness_of(k_points + k_free_end + k_flexibility);
  EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-14 * expected.maxCoeff());
}

// Somewhere in space, each point with axes of its own, the six supports at two points: a rigid link between all points
// leaves nothing to stretch.
TEST(NastranGeneralElement, ResistsNoRigidMotionWhateverTheAxesOfItsPoints) {
  const std::string points =
      "CORD2C,5,,1.,2.,0.,1.,3.,2.\n,4.,0.,1.\nCORD2R,6,,0.,0.,0.,1.,1.,1.\n,1.,0.,0.\n"
      "GRID,1,,10.,2.,3.,6\nGRID,2,,13.,1.,4.,5\nGRID,3,,11.,5.,2.,5\n";
  const std::string element =
      "GENEL,9,,2,1,2,2,3,3\n,2,4\n,UD,,1,1,1,2,1,3\n,1,4,1,5,3,2\n,K,9.,1.,2.,3.,8.,1.,1.\n,7.,2.,6.\n";
  const Eigen::MatrixXd free = stiffness_of(points + element);
  EXPECT_LT(stiffness_of(points + element + "RBE2,1,1,123456,2,3\n").cwiseAbs().maxCoeff(), 1e-12 * free.maxCoeff());
}

// The order of the numbers: K by columns from the diagonal, S by rows.
TEST(NastranGeneralElement, HasItsNumbersInTheOrderOfTheManual) {
  const NastranModel read = test::model_of(
      "GRID,1\nGRID,4\nGRID,24\nGRID,6\nSPOINT,42,33\nGENEL,629,,1,1,4,2,42,0\n,24,2\n,UD,,6,2,33,0\n"
      ",K,1.,2.,3.,4.,5.,6.,7.\n,8.,9.,10.\n,S,1.5,2.5,3.5,4.5,5.5,6.5,7.5\n,8.5\n");
  const GeneralElement& element = read.model.elements<GeneralElement>().front();
  Eigen::Matrix4d stiffness;
  stiffness << 1, 2, 3, 4, 2, 5, 6, 7, 3, 6, 8, 9, 4, 7, 9, 10;
  Eigen::Matrix<double, 4, 2> motion;
  motion << 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5, 8.5;
  EXPECT_EQ(element.stiffness, stiffness);
  EXPECT_EQ(element.rigid_motion, motion);
  EXPECT_THAT(element.components, ::testing::ElementsAre(0, 1, 0, 1, 1, 0));
  EXPECT_EQ(read.element_counts.at("GENEL"), 1);
}

TEST(NastranGeneralElement, RefusesSupportsThatLeaveARigidMotion) {
  const std::string supports = ",UD,,1,1,1,2,1,3\n,1,4,1,5,3,1\n";  // both points lie on x: nothing holds rz
  EXPECT_THAT(test::message_of<InvalidInput>(
                  [&] { stiffness_of(k_points + "GRID,3,,1.,0.,0.\n" + k_free_end + supports + k_flexibility); }),
              ::testing::StartsWith("GENEL 9: its six UD do not determine a rigid-body motion"));
}

}  // namespace
}  // namespace mottle::formats
