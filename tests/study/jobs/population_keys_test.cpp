// The keys of a study that shape the population, and the methods that use them: scale, covariance, repeatability.
#include <gtest/gtest.h>

#include <cmath>

#include "support/study_folder.hpp"

namespace mottle::study {
namespace {

using test::StudyCall;
using test::StudyFolder;
using test::TextChange;
using testing::HasSubstr;

const std::vector<std::string> k_methods{"inversion", "perturbation", "covariance-adjustment", "moment-matching"};
const std::string k_repeats =
    "specimen,f1,f2,f3\na,0.170,0.310,0.450\na,0.172,0.312,0.449\na,0.171,0.308,0.451\nb,0.160,0.320,0.440\n"
    "b,0.163,,0.442\n";

TextChange by(const std::string& method) {
  return {"method = \"mares\"", "method = \"" + method + "\""};
}
TextChange with_covariance(const std::string& value) {
  return {"samples = 200", "samples = 200\ncovariance = " + value};
}
TextChange with_repeatability(const std::string& value) {
  return {"\"tests.csv\"", "\"tests.csv\"\nrepeatability = " + value};
}

nlohmann::json updated(std::vector<TextChange> changes) {
  return StudyFolder().update_changed(changes);
}

std::string said_of(const std::vector<TextChange>& changes) {
  const StudyFolder folder;
  folder.write("repeats.csv", k_repeats);
  folder.change(changes);
  return folder.check();
}

void expect_near(const nlohmann::json& first, const nlohmann::json& second, double tolerance) {
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i)
    EXPECT_NEAR(first[i].get<double>(), second[i].get<double>(), tolerance);
}

/// Sum of squares about the mean.
double squares(const std::vector<double>& values) {
  double mean = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return sum;
}

TEST(PopulationKeys, LetEveryMethodEstimateThePopulation) {
  for (const std::string& method : k_methods) {
    const nlohmann::json result = updated({by(method)});
    EXPECT_EQ(result["status"], "converged") << method << ": " << result["message"];
    EXPECT_EQ(result["method"], method);
  }
}

TEST(PopulationKeys, TakeADiagonalCovariance) {
  for (const std::string& method : k_methods) {
    EXPECT_EQ(updated({by(method), with_covariance("\"diagonal\"")})["parameters"]["covariance"][0][1], 0.0) << method;
  }
}

TEST(PopulationKeys, TakeGroupsOfParameters) {
  const nlohmann::json covariance =
      updated({by("perturbation"), with_covariance(R"([["k1", "k2"]])")})["parameters"]["covariance"];
  EXPECT_NE(covariance[0][1], 0.0);
}

TEST(PopulationKeys, SayWhatMayBeCorrelated) {
  const TextChange inversion = by("inversion");
  EXPECT_THAT(said_of({inversion}), HasSubstr("covariance: full"));
  EXPECT_THAT(said_of({inversion, with_covariance("\"diagonal\"")}), HasSubstr("covariance: diagonal"));
  EXPECT_THAT(said_of({inversion, with_covariance(R"([["k2", "k1"]])")}),
              HasSubstr("covariance: only within [k1, k2]"));
  EXPECT_THAT(said_of({with_covariance("\"diagonal\"")}), HasSubstr("covariance: not used"));
}

TEST(PopulationKeys, TakeScales) {
  for (const std::string& method : k_methods) {
    const nlohmann::json plain = updated({by(method)})["parameters"];
    for (const std::string scale : {"log", "logit"}) {
      SCOPED_TRACE(method + " on " + scale);
      StudyFolder folder;
      const nlohmann::json result = folder.update_changed(
          {by(method), {"bounds = [0.5, 3.0]", "bounds = [0.5, 3.0]\nscale = \"" + scale + "\""}});
      EXPECT_EQ(result["status"], "converged") << result["message"];
      // The scatter is 20 %: mean and deviation of x depend little on the scale.
      for (const char* key : {"mean", "std"}) {
        EXPECT_NEAR(result["parameters"][key][0].get<double>(), plain[key][0].get<double>(), 0.06) << key;
      }
      const std::vector<double> drawn = folder.table("out/cloud-final.csv").numbers("k1");
      EXPECT_GT(*std::min_element(drawn.begin(), drawn.end()), scale == "logit" ? 0.5 : 0.0);
    }
  }
}

TEST(PopulationKeys, SayTheScale) {
  EXPECT_THAT(said_of({{"bounds = [0.5, 3.0]", "scale = \"log\""}}), HasSubstr("normal on its logarithm"));
}

// Tests from far outside of the bounds: the outputs no longer see the parameter, its mean rounds to the end.
TEST(PopulationKeys, LetAParameterBePressedToTheEndOfItsLogit) {
  const TextChange narrow{"mean = 2.0, std = 0.3 }\nbounds = [0.5, 3.0]",
                          "mean = 0.8, std = 0.03 }\nbounds = [0.76, 0.88]\nscale = \"logit\""};
  std::vector<std::string> methods = k_methods;
  methods.emplace_back("maximum-likelihood");
  for (const std::string& method : methods) {
    for (const std::string surrogate : {"", "[surrogate]\nkind = \"chaos\"\n", "[surrogate]\nkind = \"kriging\"\n"}) {
      SCOPED_TRACE(method + " " + surrogate);
      StudyFolder folder;
      folder.write(
          "study.toml",
          test::three_masses(
              {by(method), {"iterations = 30", "iterations = 3"}, {"samples = 200", "samples = 100"}, narrow}) +
              surrogate);
      try {
        const nlohmann::json found = folder.update();
        EXPECT_GT(found["parameters"]["mean"][0], 0.76);
        EXPECT_LT(found["parameters"]["mean"][0], 0.88);
        if (found["identifiability"].is_null()) continue;
        for (const nlohmann::json& value : found["identifiability"]["singular_values"]) {
          EXPECT_TRUE(value == 0.0 || value > 1e-300) << value;
        }
      } catch (const SystemFailure& error) {  // an answer too
        EXPECT_THAT(error.what(), testing::Not(HasSubstr("nan")));
      }
    }
  }
}

TEST(Repeatability, IsGivenByPatternsOfWhichTheNarrowerCounts) {
  const std::string said = said_of({with_repeatability(R"({ "f*" = 0.001, f2 = 0.002, "f?" = 0.003 })")});
  EXPECT_THAT(said, HasSubstr("f2 = 0.002: applies to f2."));
  EXPECT_THAT(said, HasSubstr("f? = 0.003: applies to f1, f3."));
  EXPECT_THAT(said, HasSubstr("f* = 0.001: applies to no output"));
}

TEST(Repeatability, InPerCentIsThatOfTheMean) {
  const nlohmann::json part = updated({by("perturbation"), with_repeatability(R"({ "f*" = "1 %" })")});
  const std::vector<double> means = test::doubles(part["outputs"]["test_mean"]);
  const nlohmann::json whole =
      updated({by("perturbation"), with_repeatability(fmt::format("{{ f1 = {}, f2 = {}, f3 = {} }}", 0.01 * means[0],
                                                                  0.01 * means[1], 0.01 * means[2]))});
  expect_near(part["parameters"]["std"], whole["parameters"]["std"], 1e-9);
}

TEST(Repeatability, IsTakenOffTheScatter) {
  const nlohmann::json plain = updated({by("perturbation")});
  const nlohmann::json noisy = updated({by("perturbation"), with_repeatability(R"({ "f*" = 0.003 })")});
  EXPECT_LT(noisy["parameters"]["std"][0], plain["parameters"]["std"][0]);
}

TEST(Repeatability, OfRepeatsIsPooledWithinSpecimens) {
  StudyFolder folder;
  folder.write("repeats.csv", k_repeats);
  const nlohmann::json repeats = folder.update_changed({by("perturbation"), with_repeatability("\"repeats.csv\"")});
  const std::vector<double> noise{std::sqrt((squares({0.170, 0.172, 0.171}) + squares({0.160, 0.163})) / 3.0),
                                  std::sqrt(squares({0.310, 0.312, 0.308}) / 2.0),
                                  std::sqrt((squares({0.450, 0.449, 0.451}) + squares({0.440, 0.442})) / 3.0)};
  const nlohmann::json given =
      updated({by("perturbation"),
               with_repeatability(fmt::format("{{ f1 = {}, f2 = {}, f3 = {} }}", noise[0], noise[1], noise[2]))});
  expect_near(repeats["parameters"]["std"], given["parameters"]["std"], 1e-9);
  EXPECT_THAT(said_of({with_repeatability("\"repeats.csv\"")}), HasSubstr("2 to 3 degrees of freedom"));
  EXPECT_EQ(folder.update({.study = "out/study.toml", .out = "again"})["parameters"]["std"],
            repeats["parameters"]["std"]);
}

TEST(NoiseOfTheTruth, IsGivenByPatternsAndInPerCent) {
  StudyFolder folder;
  folder.change({{"[outputs]", "[truth]\nspecimens = 400\nnoise = { \"f*\" = \"10 %\", f3 = 0.0 }\n\n[outputs]"}});
  const test::WrittenTable specimens = folder.simulate();
  const test::WrittenTable exact = folder.table("drawn/specimens-truth.csv");
  for (const auto& [name, expected] : {std::pair{"f1", 0.1 * 0.2}, {"f3", 0.0}}) {  // f1 is about 0.2 Hz at k1 = k2 = 2
    std::vector<double> noise = specimens.numbers(name);
    for (std::size_t i = 0; i < noise.size(); ++i) noise[i] -= exact.numbers(name)[i];
    EXPECT_NEAR(std::sqrt(squares(noise) / 400.0), expected, 0.15 * expected) << name;
  }
}

}  // namespace
}  // namespace mottle::study
