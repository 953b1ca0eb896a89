#include "study/results/shape_correlation.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/temporary_folder.hpp"
#include "mottle/core/files.hpp"
#include "mottle/study/jobs/update.hpp"

namespace mottle::study {
namespace {

nlohmann::json correlation_of(const std::string& example) {
  const test::TemporaryFolder folder;
  const auto file = std::filesystem::path(MOTTLE_SOURCE_DIR) / "examples" / example;
  write_results(update(read_study(file), {}), folder.path());
  return nlohmann::json::parse(read_file(folder / "result.json"))["shape_correlation"];
}

/// Results of the aeroplanes that come as measured modes, of one update for all tests.
struct AirframeResults {
  AirframeResults() {
    const auto file = std::filesystem::path(MOTTLE_SOURCE_DIR) / "examples/05-uff-population/study.toml";
    write_results(update(read_study(file), {}), folder.path());
  }
  nlohmann::json json(const std::string& name) const { return nlohmann::json::parse(read_file(folder / name)); }
  test::TemporaryFolder folder;
};

const AirframeResults& airframe_results() {
  static const AirframeResults results;
  return results;
}

TEST(ShapeCorrelation, OfShapesInATableIsThatOfTheMeansOfTheClouds) {
  const nlohmann::json correlation = correlation_of("01-three-masses/shapes.toml");
  EXPECT_EQ(correlation["modes"], (nlohmann::json{1, 2}));
  EXPECT_EQ(correlation["specimens"], (nlohmann::json{10, 10}));
  for (const std::size_t mode : {0U, 1U}) {
    const double before = correlation["initial"]["mac"][mode][mode];
    const double after = correlation["final"]["mac"][mode][mode];
    EXPECT_GT(after, before);
    EXPECT_LT(correlation["final"]["least"][mode].get<double>(), after);
    EXPECT_LT(correlation["final"]["mac"][mode][1 - mode].get<double>(),
              0.05);  // shapes of equal masses are orthogonal
  }
}

TEST(ShapeCorrelation, OfMeasuredModesIsWhatPairingFound) {
  const nlohmann::json correlation = airframe_results().json("result.json")["shape_correlation"];
  ASSERT_EQ(correlation["modes"].size(), 9U);
  EXPECT_EQ(correlation["specimens"][2], 9);  // mode 9 of specimen 3 was not measured
  // pairing.csv has 0.99736 for mode 7 of the first specimen, and the least cannot be more.
  EXPECT_LE(correlation["initial"]["least"][0].get<double>(), 0.99736);
  for (std::size_t k = 0; k < 9; ++k) EXPECT_GT(correlation["final"]["mac"][k][k].get<double>(), 0.98);
}

TEST(MeasuredShape, HasEveryMeasuredNodeBesideTheModelsShapeOfAModelThatFits) {
  const nlohmann::json modes = airframe_results().json("modes.json")["modes"];
  ASSERT_EQ(modes["list"].size(), 9U);
  const auto numbers_in = [](const std::string& base64) { return base64.size() * 3 / 4 / sizeof(float); };
  for (const nlohmann::json& mode : modes["list"]) {
    // Each file has 16 grid points; three numbers each, and up to two bytes that fill base64 up.
    ASSERT_EQ(mode["test"]["nodes"].size(), 16U);
    EXPECT_EQ(numbers_in(mode["test"]["shape"]), 48U);
  }
  ASSERT_EQ(modes["parameters"].size(), 4U);
  EXPECT_EQ(modes["parameters"][0]["name"], "wing_E");
  EXPECT_FALSE(modes["parameters"][0]["triangles"].get<std::string>().empty());
  EXPECT_FALSE(modes["parameters"][1]["points"].empty()) << "a bush between nodes at one place";
}

TEST(ShapeCorrelation, OfFrequenciesAloneThereIsNone) {
  EXPECT_TRUE(correlation_of("01-three-masses/case1.toml").is_null());
}

}  // namespace
}  // namespace mottle::study
