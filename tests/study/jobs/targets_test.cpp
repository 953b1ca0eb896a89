// Sensitivities of a deck's modes by its numbers: closed forms, and another way to the same numbers.
#include "mottle/study/jobs/targets.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mottle/study/jobs/modes.hpp"
#include "support/study_folder.hpp"

namespace mottle::study {
namespace {

using test::edited;
using test::StudyFolder;
using test::TextChange;
using testing::HasSubstr;

/// A cantilever of one material: every frequency goes with sqrt(E / rho); bending with sqrt(I / A).
std::string cantilever(double width, double height, const std::vector<TextChange>& changes = {}) {
  return edited(
      fmt::format("SOL 103\nCEND\nSPC = 1\nMETHOD = 10\nBEGIN BULK\nEIGRL,10,,,4\nGRID,1\nGRID,2,,0.5\n"
                  "GRID,3,,1.0\nGRID,4,,1.5\nSPC1,1,123456,1\nCBAR,1,1,1,2,0.,0.,1.\nCBAR,2,1,2,3,0.,0.,1.\n"
                  "CBAR,3,1,3,4,0.,0.,1.\nPBARL,1,1,,BAR\n,{:#.8g},{:#.8g}\nMAT1,1,7.+10,,.3,2700.\nENDDATA\n",
                  width, height),
      changes);
}

/// A mass on two springs of one stiffness across each other, and another far above: two modes of one frequency.
const std::string k_pair =
    "SOL 103\nCEND\nMETHOD = 10\nSPC = 1\nBEGIN BULK\nEIGRL,10,,,3\nGRID,1,,0.,0.,0.\nSPC1,1,3456,1\nPELAS,1,1000.\n"
    "PELAS,2,1000.\nCELAS1,1,1,1,1\nCELAS1,2,2,1,2\nCONM2,3,1,,2.\nSPOINT,9\nCELAS2,4,90000.,9,0\nCMASS2,5,1.,9,0\n"
    "ENDDATA\n";

/// The targets of a deck.
TargetsOutcome targets_of(const std::string& deck, TargetsSettings settings = {}) {
  const StudyFolder folder;
  folder.write("deck.bdf", deck);
  settings.model = folder / "deck.bdf";
  return find_targets(settings);
}

Eigen::VectorXd frequencies_of(const std::string& deck) {
  const StudyFolder folder;
  folder.write("deck.bdf", deck);
  return find_modes({.model = folder / "deck.bdf", .compare = {}}).frequencies();
}

const Target& target(const TargetsOutcome& outcome, const std::string& name) {
  for (const Target& listed : outcome.targets) {
    if (listed.name == name) return listed;
  }
  throw std::logic_error("no target is called " + name);
}

void expect_all(const Eigen::RowVectorXd& values, double expected) {
  EXPECT_GT(values.size(), 0);
  for (const double value : values) EXPECT_NEAR(value, expected, 1e-10);
}

TEST(Targets, OfAUniformCantileverHaveTheClosedForms) {
  const TargetsOutcome outcome = targets_of(cantilever(0.02, 0.03));
  const Target& modulus = target(outcome, "MAT1:1:E");
  const Target& density = target(outcome, "MAT1:1:RHO");
  expect_all(modulus.sensitivity, 0.5);
  expect_all(density.sensitivity, -0.5);
  EXPECT_EQ(modulus.elements, 3);
  EXPECT_EQ(modulus.unit, "Pa");
  expect_all(modulus.strain, 1.0);
  expect_all(density.kinetic, 1.0);
}

TEST(Targets, OfASectionHaveTheSensitivitiesOfDecksSolvedAnew) {
  constexpr double step = 1e-3;
  const TargetsOutcome outcome = targets_of(cantilever(0.02, 0.03));
  const std::vector<std::pair<std::string, std::pair<double, double>>> moves{{"PBARL:1:DIM1", {step, 0.0}},
                                                                             {"PBARL:1:DIM2", {0.0, step}}};
  for (const auto& [name, move] : moves) {
    const Eigen::VectorXd up = frequencies_of(cantilever(0.02 * (1.0 + move.first), 0.03 * (1.0 + move.second)));
    const Eigen::VectorXd down = frequencies_of(cantilever(0.02 * (1.0 - move.first), 0.03 * (1.0 - move.second)));
    const Target& dimension = target(outcome, name);
    for (Eigen::Index mode = 0; mode < dimension.sensitivity.size(); ++mode) {
      // (h^2) times a third derivative of order one
      EXPECT_NEAR(dimension.sensitivity(mode), (up(mode) - down(mode)) / (up(mode) + down(mode)) / step, 1e-5) << name;
    }
  }
}

/// Ground - k1 - m1 - k2 - m2 - k3 - ground, m2 omitted: u2 = k2 / (k2 + k3) u1.
double omitted_hz(const std::vector<double>& k) {
  const double ratio = k[1] / (k[1] + k[2]);
  return std::sqrt((k[0] + k[2] * ratio) / (2.0 + 0.7 * ratio * ratio)) / (2.0 * std::numbers::pi);
}

TEST(Targets, OfAStaticReductionMoveWithTheStiffnesses) {
  const std::string deck =
      "SOL 103\nCEND\nMETHOD = 10\nBEGIN BULK\nEIGRL,10,,,1\nSPOINT,1,2\nCELAS2,1,300.,1,0\nCELAS2,2,500.,1,0,2,0\n"
      "CELAS2,3,200.,2,0\nCMASS2,4,2.,1,0\nCMASS2,5,.7,2,0\nOMIT,2,0\nENDDATA\n";
  const std::vector<double> springs{300.0, 500.0, 200.0};
  const Eigen::VectorXd frequencies = frequencies_of(deck);
  ASSERT_EQ(frequencies.size(), 1);
  EXPECT_NEAR(frequencies(0), omitted_hz(springs), 1e-10);
  const TargetsOutcome outcome = targets_of(deck);
  constexpr double step = 1e-4;
  for (std::size_t i = 0; i < 3; ++i) {
    std::vector<double> up = springs;
    std::vector<double> down = springs;
    up[i] *= 1.0 + step;
    down[i] *= 1.0 - step;
    EXPECT_NEAR(target(outcome, fmt::format("CELAS2:{}:K", i + 1)).sensitivity(0),
                std::log(omitted_hz(up) / omitted_hz(down)) / (2.0 * step), 1e-7);
  }
}

TEST(Targets, OfModesOfOneFrequencyHaveTheValuesIntoWhichItSplits) {
  const TargetsOutcome outcome = targets_of(k_pair);
  EXPECT_NEAR(outcome.frequencies(0), outcome.frequencies(1), 1e-12);
  for (const char* name : {"PELAS:1:K", "PELAS:2:K"}) {  // each moves one combination by half, the other not at all
    const Target& spring = target(outcome, name);
    EXPECT_TRUE(spring.sensitivity.isApprox(Eigen::RowVector3d(0.0, 0.5, 0.0), 1e-10)) << spring.sensitivity;
    EXPECT_TRUE(spring.strain.isApprox(Eigen::RowVector3d(0.0, 1.0, 0.0), 1e-10)) << spring.strain;
  }
}

TEST(Targets, CutNoRepeatedFrequency) {
  const TargetsOutcome outcome = targets_of(k_pair, {.model = {}, .modes = 1});
  EXPECT_EQ(outcome.frequencies.size(), 2);
  EXPECT_TRUE(target(outcome, "PELAS:1:K").sensitivity.isApprox(Eigen::RowVector2d(0.0, 0.5), 1e-10));
}

TEST(Targets, HaveFrequenciesInTheUnitThatGoesWithTheOthers) {
  const std::string deck = cantilever(20.0, 30.0, {{"7.+10,,.3,2700.", "70.,,.3,2.7-6"}});
  const RunSummary summary = summarise(targets_of(deck));
  EXPECT_EQ(nlohmann::json::parse(summary.json)["frequency_unit"], "kHz");
  EXPECT_THAT(fmt::format("{}", fmt::join(summary.lines, "\n")), HasSubstr("modes [kHz]:"));
  const StudyFolder folder;
  folder.write("deck.bdf", deck);
  const RunSummary modes = summarise(find_modes({.model = folder / "deck.bdf", .compare = {}}), "out");
  EXPECT_THAT(fmt::format("{}", fmt::join(modes.lines, "\n")), HasSubstr("frequency kHz"));
}

TEST(Targets, HaveNoMassOfTheUnitsWhereWtmassMultipliesIt) {
  const std::string deck =
      cantilever(0.8, 1.2, {{"7.+10,,.3,2700.", "1.+7,,.3,.1"}, {"EIGRL,10", "PARAM,WTMASS,.00259\nEIGRL,10"}});
  EXPECT_EQ(target(targets_of(deck), "MAT1:1:RHO").unit, "lbf s^2/in^4 / WTMASS");
}

TEST(Targets, GuessUnitsWhereNoneAreGiven) {
  const std::string deck = cantilever(20.0, 30.0, {{"7.+10,,.3,2700.", "7.+4,,.3,2.7-9"}});
  const TargetsOutcome outcome = targets_of(deck);
  EXPECT_EQ(target(outcome, "MAT1:1:E").unit, "MPa");
  EXPECT_THAT(fmt::format("{}", fmt::join(summarise(outcome).lines, "\n")), HasSubstr("units: mm-t-s (GUESSED"));
  EXPECT_EQ(target(targets_of(deck, {.model = {}, .units = "SI"}), "MAT1:1:E").unit, "Pa");
}

TEST(Targets, HaveNoSensitivityOfARigidBodyMode) {
  const TargetsOutcome outcome = targets_of(
      "SOL 103\nCEND\nMETHOD = 10\nBEGIN BULK\nEIGRL,10,,,4\nSPOINT,1,2\nCELAS2,1,1000.,1,1,2,1\nCMASS2,2,2.,1,1\n"
      "CMASS2,3,3.,2,1\nENDDATA\n",
      {.model = {}, .modes = 2});
  EXPECT_EQ(outcome.frequencies(0), 0.0);
  EXPECT_TRUE(std::isnan(target(outcome, "CELAS2:1:K").sensitivity(0)));
  // Reduced mass 6/5: the mass m has the fraction 1 - m / (m1 + m2) of the kinetic energy.
  EXPECT_NEAR(target(outcome, "CELAS2:1:K").sensitivity(1), 0.5, 1e-10);
  EXPECT_NEAR(target(outcome, "CMASS2:2:M").sensitivity(1), -0.3, 1e-10);
  EXPECT_NEAR(target(outcome, "CMASS2:3:M").sensitivity(1), -0.2, 1e-10);
  const nlohmann::json summary = nlohmann::json::parse(summarise(outcome).json);
  for (const nlohmann::json& listed : summary["targets"]) {
    if (listed["target"] == "CELAS2:1:K") {
      EXPECT_TRUE(listed["sensitivity"][0].is_null());
    }
  }
}

TEST(Targets, HaveTheSameNumbersInTableAndJson) {
  const TargetsOutcome outcome = targets_of(cantilever(0.02, 0.03));
  const nlohmann::json listed = nlohmann::json::parse(summarise(outcome).json)["targets"];
  const test::WrittenTable table = test::table_of(targets_csv(outcome));
  ASSERT_EQ(table.rows.size(), listed.size());
  for (std::size_t i = 0; i < listed.size(); ++i) {
    EXPECT_EQ(table.texts("target")[i], listed[i]["target"]);
    for (std::size_t mode = 0; mode < listed[i]["sensitivity"].size(); ++mode) {
      EXPECT_EQ(table.numbers(fmt::format("sensitivity_{}", mode + 1))[i], listed[i]["sensitivity"][mode]);
    }
  }
}

TEST(Targets, ListAllNumbersWhereTheyAreAskedFor) {
  const TargetsOutcome usual = targets_of(cantilever(0.02, 0.03));
  const TargetsOutcome every = targets_of(cantilever(0.02, 0.03), {.model = {}, .lists_all = true});
  EXPECT_EQ(every.targets.size(), usual.targets.size() + static_cast<std::size_t>(usual.left_out));
  EXPECT_NO_THROW(target(every, "MAT1:1:NU"));
}

}  // namespace
}  // namespace mottle::study
