#include <gtest/gtest.h>

#include "mottle/formats/nastran/model.hpp"

namespace {

bool is_design(const char* card, const char* name) {
  return mottle::formats::is_design_number({card, 1, name, 1.0});
}

TEST(DesignNumbers, AreModuliDensitiesDimensionsSpringsAndMasses) {
  for (const char* name : {"E", "G", "RHO"}) EXPECT_TRUE(is_design("MAT1", name)) << name;
  for (const char* card : {"PBAR", "PBEAM"}) {
    for (const char* name : {"A", "I1", "I2", "J"}) EXPECT_TRUE(is_design(card, name)) << card << name;
  }
  for (const char* card : {"PROD", "CONROD", "PTUBE"}) {
    for (const char* name : {"A", "J"}) EXPECT_TRUE(is_design(card, name)) << card << name;
  }
  for (const char* card : {"PELAS", "CELAS2", "CELAS4"}) EXPECT_TRUE(is_design(card, "K")) << card;
  for (const char* card : {"PMASS", "CMASS2", "CMASS4", "CONM2"}) EXPECT_TRUE(is_design(card, "M")) << card;
  for (const char* card : {"PBARL", "PBEAML"}) EXPECT_TRUE(is_design(card, "DIM12")) << card;
  for (const char* name : {"K1", "K6"}) EXPECT_TRUE(is_design("PBUSH", name)) << name;
  EXPECT_TRUE(is_design("PSHELL", "T"));
}

TEST(DesignNumbers, AreNeitherDampersNorAdditionsNorGeometry) {
  const std::pair<const char*, const char*> others[] = {
      {"MAT1", "NU"},  {"PBAR", "I12"}, {"PBAR", "NSM"}, {"PBARL", "NSM"}, {"PSHELL", "NSM"}, {"CQUAD4", "T"},
      {"PBUSH", "B1"}, {"PDAMP", "B"},  {"CDAMP2", "B"}, {"CONM2", "I11"}, {"CONM1", "M11"},  {"GRID", "X"},
      {"CBAR", "X1"},  {"PLATE", "T"},  {"CELAS1", "K"}, {"MAT1", ""}};
  for (const auto& [card, name] : others) EXPECT_FALSE(is_design(card, name)) << card << name;
}

}  // namespace
