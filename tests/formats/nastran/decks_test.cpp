// Whole decks of tests/formats/nastran, each in the manner of another preprocessor. They also seed the fuzzer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "mottle/formats/nastran/model.hpp"

namespace mottle::formats {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

using Counts = std::map<std::string, int>;

NastranModel read_deck(const std::string& name, const NastranOptions& options = {}) {
  return read_nastran_model(std::string(MOTTLE_SOURCE_DIR "/tests/formats/nastran/") + name, options);
}

TEST(NastranDecks, ReadSolidsInEveryFieldFormat) {
  const NastranModel read = read_deck("solids.bdf");
  EXPECT_EQ(read.element_counts, (Counts{{"CHEXA", 1}, {"CPENTA", 1}, {"CROD", 1}, {"CTETRA", 1}}));
  ASSERT_EQ(read.model.nodes.size(), 9U);
  EXPECT_EQ(read.model.nodes[3].position, Eigen::Vector3d(-2.84441e-19, 1, 0));
  EXPECT_EQ(read.model.nodes[7].position, Eigen::Vector3d(0, 1, 1));
  EXPECT_EQ(read.model.nodes[8].position, Eigen::Vector3d(0.5, 0.5, 2));
  ASSERT_THAT(read.model.fixed, SizeIs(9));
  EXPECT_EQ(read.model.fixed[0].second, 0x3f);
  EXPECT_EQ(read.model.fixed[8].second, 0x38);
  EXPECT_EQ(read.model.settings.modes, 10);
  EXPECT_THAT(read.notes, IsEmpty());
}

TEST(NastranDecks, ReadShellsInACylindricalSystem) {
  const NastranModel read = read_deck("shells.bdf");
  EXPECT_EQ(read.element_counts,
            (Counts{{"CBAR", 2}, {"CBEAM", 1}, {"CONM2", 1}, {"CONROD", 1}, {"CQUAD4", 1}, {"CTRIA3", 2}}));
  // Grid point 5 lies at 90 degrees, so its radius is basic y; CBAR 4's orientation points inwards at 0 degrees.
  EXPECT_LT((read.model.nodes[4].position - Eigen::Vector3d(0, 1, 0)).norm(), 1e-15);
  EXPECT_LT((read.model.elements<BeamElement>()[0].orientation - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((read.model.elements<PointMassElement>()[0].offset - Eigen::Vector3d(0, 0, 0.1)).norm(), 1e-15);
  EXPECT_THAT(read.model.fixed, ElementsAre(std::pair<int, Components>(6, 0x3f)));
  EXPECT_THAT(read_deck("shells.bdf", {.subcase = 2}).model.fixed, SizeIs(2));
}

TEST(NastranDecks, ReadSpringsAndRigidLinks) {
  const NastranModel read = read_deck("springs.bdf");
  EXPECT_THAT(read.model.nodes, SizeIs(9));
  EXPECT_THAT(read.model.elements<ScalarElement>(), SizeIs(9));
  EXPECT_THAT(read.model.elements<BushElement>(), SizeIs(3));
  EXPECT_THAT(read.model.multipoint_equations, SizeIs(1));
  EXPECT_EQ(read.model.multipoint_equations[0].terms.size(), 3U);
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("the only SPC set, 1, was taken"), HasSubstr("the only MPC set, 1")));
}

TEST(NastranDecks, ReadSeveralFiles) {
  const NastranModel read = read_deck("include_main.bdf");
  EXPECT_THAT(read.files, SizeIs(4));
  EXPECT_THAT(read.model.nodes, SizeIs(2));
  EXPECT_EQ(read.element_counts, (Counts{{"CELAS2", 1}, {"CONM2", 1}}));
  EXPECT_THAT(read.model.fixed, ElementsAre(std::pair<int, Components>(0, 0x3f)));
}

}  // namespace
}  // namespace mottle::formats
