// Shapes of a chain of three masses that have no size, or miss a component, in every specimen.
#include <gtest/gtest.h>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using testing::HasSubstr;

/// Why universal files with modal masses by mode at some of the chain's points are refused.
std::string refusal_of_chain(const std::vector<double>& masses, const std::vector<int>& points) {
  const std::vector<std::vector<double>> shapes{
      {9.2975, 14.7955, -26.356}, {14.637, 11.923, 11.963}, {17.97, -18.17, -3.90}};
  const std::vector<double> frequencies{1.90, 5.78, 8.98};
  const test::StudyFolder folder;
  for (int specimen = 0; specimen < 3; ++specimen) {
    std::string text;
    for (std::size_t mode = 0; mode < 3; ++mode) {
      text += fmt::format("    -1\n    55\nshape\nNONE\nNONE\nNONE\nNONE\n{:10d}{:10d}{:10d}{:10d}{:10d}{:10d}\n", 1, 2,
                          2, 8, 2, 3);
      text += fmt::format("{:10d}{:10d}{:10d}{:10d}\n{:13.5E}{:13.5E}{:13.5E}{:13.5E}\n", 2, 4, 1, mode + 1,
                          frequencies[mode] + 0.01 * specimen, masses[mode], 0.01, 0.0);
      for (const int point : points) {
        text += fmt::format("{:10d}\n{:13.5E}{:13.5E}{:13.5E}\n", point,
                            shapes[static_cast<std::size_t>(point) - 1][mode], 0.0, 0.0);
      }
      text += "    -1\n";
    }
    folder.write(fmt::format("chain-{}.uff", specimen), text);
  }
  folder.write("chain.bdf", test::k_chain_deck);
  folder.write("study.toml", R"([model]
kind = "nastran"
file = "chain.bdf"
[[parameter]]
name = "k2"
target = "CELAS2:2:K"
distribution = { kind = "normal", mean = 1500, std = 50 }
[outputs]
frequencies = [1, 2, 3]
shapes = { modes = [1, 2], dofs = ["1:+X", "2:+X", "3:+X"] }
[test]
file = "chain-*.uff"
)");
  return folder.refusal();
}

TEST(ModeFiles, WithoutSizeAreToldFromComponentsThatWereNotMeasured) {
  const std::string unscaled = refusal_of_chain({0.0, 1.0, 1.0}, {1, 2, 3});
  EXPECT_THAT(unscaled, HasSubstr("output 'phi1:1:+X' is not used of any specimen: the tests' shapes of mode 1 have no "
                                  "modal mass"));
  EXPECT_THAT(unscaled, HasSubstr("outputs.shapes.size = \"free\""));
  EXPECT_THAT(refusal_of_chain({1.0, 1.0, 1.0}, {1, 2}), HasSubstr("output 'phi1:3:+X' is never measured"));
}

TEST(ModeFiles, OfFreeShapesAreRefusedWithTheComponentThatIsMissing) {
  const std::string said = refusal_of_chain({0.0, 0.0, 0.0}, {1, 2});
  EXPECT_THAT(said, HasSubstr("output 'phi1:1:+X' follows from no specimen"));
  EXPECT_THAT(said, HasSubstr("and phi1:3:+X is never measured; leave it out of dofs"));
}

}  // namespace
}  // namespace mottle::study
