// From "MAT1:2:E" to fields: what is found, what is refused with which words, which values are possible.
#include "mottle/model/parameters/field_targets.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/message_of.hpp"
#include "fem/models.hpp"
#include "model/structures.hpp"

namespace mottle::model {
namespace {

using test::one_each;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double k_infinity = std::numeric_limits<double>::infinity();

/// A beam, a shell, a point mass with an offset, a spring, a bush's damper.
FiniteElementModel small_model() {
  test::ModelMaker maker;
  const int metal = maker.material(2, 2e11, 0.3, 7800.0);
  maker.node(1, {0, 0, 0});
  maker.node(2, {1, 0, 0});
  maker.node(5, {1, 1, 0});
  const int property = maker.beam_property(4, metal, 1e-3, 2e-7, 1e-7, 1e-7);
  maker.model.beam_properties[0].inertia_12 = maker.field("PBAR", 4, "I12", 0.0);
  maker.beam(10, 0, 1, property);
  maker.model.elements<ShellElement>().push_back(
      {.id = 11, .node_count = 3, .nodes = {0, 1, 2, 0}, .property = maker.shell_property(6, metal, 0.01)});
  maker.point_mass(8, 2, 1.5).offset = {0.1, 0.2, 0.3};
  maker.spring(12, 0, 0, -1, 0, 0.0);
  maker.field("PBUSH", 13, "B1", 3.0);
  maker.field("PSHELL", 6, "NSM", 0.2);
  return maker.model;
}

FieldTargets find(const std::vector<ParameterTargets>& parameters) {
  FiniteElementModel model = small_model();
  return find_field_targets(model, parameters);
}

std::string refusal(const std::string& target, bool is_factor = false) {
  return test::message_of<InvalidInput>([&] { find({{"p", {target}, is_factor}}); });
}

TEST(FieldTargets, FindNumbersOfCardsInAnyLetterCase) {
  FiniteElementModel model = small_model();
  const FieldTargets targets = find_field_targets(model, one_each({"mat1:2:e", "PSHELL:6:T"}));
  ASSERT_EQ(targets.parameters.size(), 2U);
  EXPECT_EQ(targets.parameters[0].fields, std::vector<FieldIndex>{test::field_of(model, "MAT1", 2, "E")});
  EXPECT_EQ(targets.parameters[1].fields, std::vector<FieldIndex>{test::field_of(model, "PSHELL", 6, "T")});
  EXPECT_TRUE(targets.geometry.empty());
}

TEST(FieldTargets, MoveEveryKindOfGeometry) {
  FiniteElementModel model = small_model();
  const FieldTargets targets = find_field_targets(
      model, one_each({"GRID:5:Y", "CBAR:10:X3", "CBAR:10:W2A", "CBAR:10:W3B", "CONM2:8:X2", "CTRIA3:11:ZOFFS"}));
  Eigen::VectorXd x(6);
  x << 1, 2, 3, 4, 5, 6;
  const FiniteElementModel moved = model_at(model, targets, x);
  EXPECT_EQ(moved.nodes[2].position, Eigen::Vector3d(1, 1, 0));
  EXPECT_EQ(moved.elements<BeamElement>()[0].orientation, Eigen::Vector3d(0, 1, 2));
  EXPECT_EQ(moved.elements<BeamElement>()[0].offsets[0], Eigen::Vector3d(0, 3, 0));
  EXPECT_EQ(moved.elements<BeamElement>()[0].offsets[1], Eigen::Vector3d(0, 0, 4));
  EXPECT_EQ(moved.elements<PointMassElement>()[0].offset, Eigen::Vector3d(0.1, 5, 0.3));
  EXPECT_EQ(moved.elements<ShellElement>()[0].offset, 6.0);
}

TEST(FieldTargets, MultiplyTheDecksValueByAFactor) {
  FiniteElementModel model = small_model();
  const FieldTargets targets = find_field_targets(
      model, {{"stiff", {"MAT1:2:E", "PBAR:4:A"}, true}, {"mass", {"CONM2:8:M", "PSHELL:6:NSM"}, false}});
  const FiniteElementModel moved = model_at(model, targets, Eigen::Vector2d(1.5, 7.0));
  EXPECT_EQ(moved.value(test::field_of(model, "MAT1", 2, "E")), 3e11);
  EXPECT_EQ(moved.value(test::field_of(model, "PBAR", 4, "A")), 1.5e-3);
  EXPECT_EQ(moved.value(test::field_of(model, "CONM2", 8, "M")), 7.0);
  EXPECT_EQ(moved.value(test::field_of(model, "PSHELL", 6, "NSM")), 7.0);
}

TEST(FieldTargets, RefuseWhatIsNoTarget) {
  for (const char* target : {"", "E1", "MAT1:E", "MAT1::E", "MAT1:x:E", "MAT1:2x:E", "MAT1:99999999999:E", ":"}) {
    EXPECT_THAT(refusal(target), HasSubstr("is not CARD:ID:FIELD, like MAT1:2:E")) << target;
  }
}

TEST(FieldTargets, SayWhichFieldsACardHas) {
  EXPECT_THAT(refusal("MAT1:2:EE"), AllOf(HasSubstr("parameter 'p': it acts on nothing"), HasSubstr("E, NU, RHO")));
  EXPECT_THAT(refusal("MAT1:2:RH"), HasSubstr("did you mean 'RHO'"));
  EXPECT_THAT(refusal("CONM2:8:X4"), HasSubstr("M, X1, X2, X3"));
}

TEST(FieldTargets, SayWhichIdsACardHas) {
  EXPECT_THAT(refusal("MAT1:3:E"), HasSubstr("the deck has no MAT1 3; it has 2"));
  EXPECT_THAT(refusal("GRID:99:X"), HasSubstr("the deck has no GRID 99; it has 1, 2, 5"));
  EXPECT_THAT(refusal("CBAR:99:W1A"), HasSubstr("the deck has no CBAR 99; it has 10"));
}

TEST(FieldTargets, SayWhichDirectionsAGridHas) {
  EXPECT_THAT(refusal("GRID:5:+X"), HasSubstr("X, Y, Z"));
}

TEST(FieldTargets, SayWhichCardsThereAre) {
  EXPECT_THAT(refusal("MAT8:3:E1"), AllOf(HasSubstr("did you mean 'MAT1'"), HasSubstr("PSHELL")));
}

TEST(FieldTargets, RefuseAFieldOfTwoParameters) {
  const auto tie = [](const std::string& target) {
    return test::message_of<InvalidInput>([&] { find({{"a", {target}, false}, {"b", {target}, true}}); });
  };
  EXPECT_EQ(tie("MAT1:2:E"), "parameter 'b': target 'MAT1:2:E' is already tied to parameter 'a'");
  EXPECT_EQ(tie("GRID:2:X"), "parameter 'b': target 'GRID:2:X' is already tied to parameter 'a'");
}

TEST(FieldTargets, RefuseAFactorOnZero) {
  EXPECT_THAT(refusal("CELAS2:12:K", true), HasSubstr("whose nominal value is 0"));
  EXPECT_THAT(refusal("GRID:1:Z", true), HasSubstr("whose nominal value is 0"));
}

TEST(FieldTargets, RefuseAParameterWithoutTarget) {
  EXPECT_THAT(test::message_of<InvalidInput>([] { find({{"p", {}, false}}); }), HasSubstr("it has no target"));
}

PhysicalLimit limit(const std::string& target, bool is_factor = false) {
  return find({{"p", {target}, is_factor}}).limits[0];
}

TEST(FieldTargets, KeepStiffnessAndMassPositive) {
  for (const char* target : {"MAT1:2:E", "MAT1:2:RHO", "PSHELL:6:T", "PBAR:4:I1", "CELAS2:12:K", "CONM2:8:M"}) {
    EXPECT_EQ(limit(target).lower, 0.0) << target;
    EXPECT_TRUE(limit(target).excludes_lower) << target;
  }
}

TEST(FieldTargets, AllowDampingAndAddedMassToVanish) {
  for (const char* target : {"PBUSH:13:B1", "PSHELL:6:NSM"}) {
    EXPECT_EQ(limit(target).lower, 0.0) << target;
    EXPECT_FALSE(limit(target).excludes_lower) << target;
  }
}

TEST(FieldTargets, LeaveGeometryAndProductsUnlimited) {
  for (const char* target : {"GRID:5:X", "CBAR:10:X1", "CONM2:8:X1", "CTRIA3:11:ZOFFS", "PBAR:4:I12"}) {
    EXPECT_EQ(limit(target).lower, -k_infinity) << target;
  }
  EXPECT_EQ(limit("MAT1:2:NU").lower, -1.0);
  EXPECT_EQ(limit("MAT1:2:NU", true).lower, 0.0);
}

TEST(FieldTargets, TiedToOneParameterObeyTheStrictestLimit) {
  const FieldTargets targets = find({{"p", {"PSHELL:6:NSM", "GRID:5:X", "CONM2:8:M"}, false}});
  EXPECT_EQ(targets.limits[0].lower, 0.0);
  EXPECT_TRUE(targets.limits[0].excludes_lower);
}

}  // namespace
}  // namespace mottle::model
