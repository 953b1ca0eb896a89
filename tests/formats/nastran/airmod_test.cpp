// The AIRMOD deck of DLR, where it lies beside the project: counts taken from the file by grep.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "mottle/formats/nastran/model.hpp"

namespace mottle::formats {
namespace {

class Airmod : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path deck = MOTTLE_SOURCE_DIR "/../shared/data/airmod/AIRMOD103.bdf";
    if (!std::filesystem::exists(deck)) GTEST_SKIP() << deck << " is not there";
    read = read_nastran_model(deck);
  }

  double field(const std::string& card, int id, const std::string& name) const {
    for (const CardField& known : read.model.fields) {
      if (known.card == card && known.id == id && known.name == name) return known.value;
    }
    ADD_FAILURE() << card << ' ' << id << ' ' << name << " is missing";
    return 0.0;
  }

  NastranModel read;
};

TEST_F(Airmod, HasEveryNodeAndElement) {
  EXPECT_EQ(read.model.nodes.size(), 3136U);
  const std::map<std::string, int> counts = {{"CELAS1", 561}, {"CHEXA", 1440}, {"CMASS1", 55},
                                             {"CONM2", 18},   {"CPENTA", 6},   {"CROD", 3}};
  EXPECT_EQ(read.element_counts, counts);
  EXPECT_EQ(read.files.size(), 3U);
}

TEST_F(Airmod, HasTheEighteenUpdatingParameters) {
  EXPECT_EQ(field("MAT1", 2, "E"), 1800.0);
  EXPECT_EQ(field("MAT1", 3, "E"), 7500.0);
  EXPECT_EQ(field("PELAS", 160, "K"), 130.0);
  EXPECT_EQ(field("PELAS", 3, "K"), 1e9);
  EXPECT_EQ(field("PMASS", 1042, "M"), 0.186);
  EXPECT_EQ(field("PELAS", 11, "K"), 5e7);
}

TEST_F(Airmod, HasTheSelectedConstraintsAndSettings) {
  ASSERT_EQ(read.model.fixed.size(), 2U);
  EXPECT_EQ(read.model.nodes[static_cast<std::size_t>(read.model.fixed[0].first)].id, 3593);
  EXPECT_EQ(read.model.fixed[0].second, 0x07);
  EXPECT_EQ(read.model.settings.modes, 35);
  EXPECT_TRUE(read.model.settings.coupled_mass);
  EXPECT_EQ(read.model.settings.automatic_constraints, AutomaticConstraints::soft);
  EXPECT_EQ(read.model.settings.drilling, 100.0);
}

TEST_F(Airmod, ReadsNumbersByColumnsEvenWhereTheyTouch) {
  const Node& node = read.model.nodes[static_cast<std::size_t>(read.model.find_node(3599))];
  EXPECT_EQ(node.position, Eigen::Vector3d(1.425, -1.6e-2, 0.45));  // "-1.600-2" in columns 33 to 40, ".45" behind it
}

TEST_F(Airmod, NeedsNoNote) {
  EXPECT_TRUE(read.notes.empty());
}

}  // namespace
}  // namespace mottle::formats
