#include "report/cloud_data.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "core/temporary_folder.hpp"
#include "mottle/core/error.hpp"

namespace mottle::report {
namespace {

/// A file of `clouds` clouds with `samples` samples of one parameter and one output each.
std::filesystem::path write_clouds(const test::TemporaryFolder& folder, int clouds, int samples) {
  const std::filesystem::path file = folder / "clouds.csv";
  std::ofstream stream(file);
  stream << "iteration,k1,f1\n";
  for (int i = 0; i < clouds; ++i) {
    for (int s = 0; s < samples; ++s) stream << i << ',' << (1.0 + s / 3.0) << ',' << (2.0 + s / 7.0) << '\n';
  }
  return file;
}

TEST(CloudData, KeepsTheFirstAndTheLastCloudWhole) {
  const test::TemporaryFolder folder;
  const Json clouds = clouds_json(write_clouds(folder, 200, 500), 1);
  ASSERT_EQ(clouds.size(), 200U);
  EXPECT_EQ(clouds.front()["outputs"].size(), 500U);
  EXPECT_EQ(clouds.back()["outputs"].size(), 500U);
  EXPECT_EQ(clouds[100]["outputs"].size(), 151U);  // 60,000 / (198 * 2)
  EXPECT_EQ(clouds[100]["parameters"].size(), 151U);
}

TEST(CloudData, KeepsAllOfFewClouds) {
  const test::TemporaryFolder folder;
  for (const Json& cloud : clouds_json(write_clouds(folder, 4, 500), 1)) EXPECT_EQ(cloud["outputs"].size(), 500U);
}

TEST(CloudData, HasSixDigitsOfTheRange) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "clouds.csv";
  std::ofstream(file) << "iteration,k1,f1\n0,1.23456789,5\n0,0,6\n";
  EXPECT_EQ(clouds_json(file, 1)[0]["parameters"][0][0], 1.23457);
}

TEST(CloudData, RefusesAFileOfOtherColumns) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(clouds_json(write_clouds(folder, 1, 1), 2), FormatError);
}

}  // namespace
}  // namespace mottle::report
