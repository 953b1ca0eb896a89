// Shapes without modal mass: their size is no data, whatever it is.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::edited;
using test::StudyFolder;
using testing::HasSubstr;

const std::string k_study = R"(title = "Shapes without modal mass"
seed = 11

[model]
kind = "mass-spring"
masses = { m1 = 1.0, m2 = 1.0, m3 = 1.0 }
springs = [
  { name = "k1", between = ["ground", "m1"], stiffness = 1.0 },
  { name = "k4", between = ["m1", "m2"], stiffness = 1.0 },
  { name = "k5", between = ["m2", "m3"], stiffness = 1.0 },
]

[[parameter]]
name = "mass"
target = "mass:m1"
distribution = { kind = "normal", mean = 1.0, std = 0.3 }

[[parameter]]
name = "k1"
target = "spring:k1"
distribution = { kind = "normal", mean = 1.0, std = 0.3 }

[outputs]
frequencies = [1, 2]
shapes = { modes = [1, 2], dofs = ["m1", "m2", "m3"] }

[test]
file = "modes-*.csv"
repeatability = { "f*" = "0.1 %", "phi*" = 0.005 }

[update]
method = "maximum-likelihood"
samples = 400

[truth]
specimens = 40
noise = { "f*" = "0.1 %", "phi*" = 0.005 }

[[truth.parameter]]
name = "mass"
target = "mass:m1"
distribution = { kind = "normal", mean = 1.577, std = 0.05 }

[[truth.parameter]]
name = "k1"
target = "spring:k1"
distribution = { kind = "normal", mean = 1.2, std = 0.06 }
)";
const std::vector<double> k_true_mean{1.577, 1.2};
const std::vector<double> k_true_std{0.05, 0.06};
const std::vector<std::string> k_masses{"m1", "m2", "m3"};

/// Numbers of forty specimens of the truth, by output.
const std::map<std::string, std::vector<double>>& specimens() {
  static const std::map<std::string, std::vector<double>> columns = [] {
    StudyFolder folder;
    folder.write("study.toml", k_study);
    const test::WrittenTable table = folder.simulate();
    std::map<std::string, std::vector<double>> numbers;
    for (const std::string& name : table.header) numbers[name] = table.numbers(name);
    return numbers;
  }();
  return columns;
}

/// A table of shapes a specimen; `size` of specimen and mode is the factor on the mass-normalised shape.
void write_modes(const StudyFolder& folder, const std::function<double(int specimen, int mode)>& size) {
  for (int s = 0; s < 40; ++s) {
    const auto value = [&](const std::string& name) { return specimens().at(name)[static_cast<std::size_t>(s)]; };
    std::string text = fmt::format("dof,{},{}\n", value("f1"), value("f2"));
    for (const std::string& mass : k_masses) {
      text += fmt::format("{},{},{}\n", mass, value("phi1:" + mass) * size(s, 1), value("phi2:" + mass) * size(s, 2));
    }
    folder.write(fmt::format("modes-{:02}.csv", s + 1), text);
  }
}

nlohmann::json updated(StudyFolder& folder, const std::vector<test::TextChange>& changes = {}) {
  folder.write("study.toml", edited(k_study, changes));
  return folder.update();
}

TEST(FreeShapes, FindTheTruthWhateverTheirSize) {
  StudyFolder folder;
  write_modes(folder, [](int, int) { return 1.0; });
  const nlohmann::json first = updated(folder);
  write_modes(folder, [](int s, int mode) { return (s % 2 == 0 ? 1.0 : -1.0) * std::pow(10.0, s % 7 - 3) * mode; });
  const nlohmann::json other = updated(folder);
  EXPECT_EQ(first["outputs"]["names"], nlohmann::json({"f1", "f2", "phi1:m1", "phi1:m2", "phi2:m2", "phi2:m3"}));
  for (std::size_t k = 0; k < 2; ++k) {
    const double mean = first["parameters"]["mean"][k];
    const double std = first["parameters"]["std"][k];
    EXPECT_NEAR(other["parameters"]["mean"][k].get<double>(), mean, 1e-9);
    EXPECT_NEAR(other["parameters"]["std"][k].get<double>(), std, 1e-9);
    // Four standard errors of a mean and of a standard deviation from 40 specimens.
    EXPECT_NEAR(mean, k_true_mean[k], 4.0 * k_true_std[k] / std::sqrt(40.0));
    EXPECT_NEAR(std, k_true_std[k], 4.0 * k_true_std[k] / std::sqrt(80.0));
  }
  EXPECT_EQ(first["verdict"]["conclusion"], "adequate");
  EXPECT_THAT(test::sentences(first["notes"]), HasSubstr("size of shapes is free"));
}

TEST(FreeShapes, AreComparedByTheirDirectionsByAllMethods) {
  StudyFolder folder;
  write_modes(folder, [](int s, int) { return 3.0 + s; });
  for (const std::string method :
       {"mares", "deterministic", "inversion", "perturbation", "moment-matching", "covariance-adjustment"}) {
    const nlohmann::json result = updated(folder, {{"maximum-likelihood", method}});
    for (std::size_t k = 0; k < 2; ++k) {
      // First-order methods start 1.9 standard deviations of the prior away.
      EXPECT_NEAR(result["parameters"]["mean"][k].get<double>(), k_true_mean[k], 0.05) << method;
    }
  }
}

TEST(FreeShapes, MayBeSaidToBeMassNormalised) {
  StudyFolder folder;
  const test::TextChange stated{"\"m3\"] }", "\"m3\"], size = \"mass-normalised\" }"};
  write_modes(folder, [](int, int) { return 1.0; });
  EXPECT_EQ(updated(folder, {stated})["outputs"]["names"].size(), 8U);
  write_modes(folder, [](int, int) { return 50.0; });
  EXPECT_THAT(folder.check(), HasSubstr("times as large as the model's"));
}

TEST(FreeShapes, MayStandInATableOfOutputs) {
  const std::vector<std::string> names{"f1", "f2", "phi1:m1", "phi1:m2", "phi1:m3", "phi2:m1", "phi2:m2", "phi2:m3"};
  StudyFolder folder;
  std::vector<nlohmann::json> means;
  for (const double factor : {1.0, -20.0}) {
    std::vector<std::vector<double>> rows(40);
    for (std::size_t s = 0; s < rows.size(); ++s) {
      for (const std::string& name : names) {
        rows[s].push_back(specimens().at(name)[s] * (name.starts_with("phi2") ? factor : 1.0));
      }
    }
    folder.write("tests.csv", test::csv_text(fmt::format("{}", fmt::join(names, ",")), rows));
    const nlohmann::json result =
        updated(folder, {{"\"m3\"] }", "\"m3\"], size = \"free\" }"}, {"modes-*.csv", "tests.csv"}});
    EXPECT_EQ(result["outputs"]["names"].size(), 6U);
    means.push_back(result["parameters"]["mean"]);
  }
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(means[0][k].get<double>(), means[1][k].get<double>(), 1e-9);
}

TEST(FreeShapes, ThatMissAComponentAreLeftOutAndSaidToBe) {
  const StudyFolder folder;
  write_modes(folder, [](int, int) { return 2.0; });
  folder.write("study.toml", k_study);
  std::vector<std::string> lines = test::lines_of(folder.text("modes-03.csv"));
  lines[1] = "m1,nan," + test::split(lines[1], ',')[2];
  folder.write("modes-03.csv", fmt::format("{}\n", fmt::join(lines, "\n")));
  EXPECT_THAT(folder.check(), HasSubstr("nearly orthogonal to the reference's: specimen 3 mode 1"));
}

TEST(FreeShapes, LeaveOutASpecimenOfWhichNothingIsLeft) {
  StudyFolder folder;
  write_modes(folder, [](int s, int) { return s == 0 ? 0.0 : 2.0; });
  const nlohmann::json result = updated(folder);
  EXPECT_THAT(test::sentences(result["notes"]), testing::ContainsRegex("no output is left.*specimen 1;"));
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(result["parameters"]["mean"][k].get<double>(), k_true_mean[k], 4.0 * k_true_std[k] / std::sqrt(39.0));
  }
}

/// Two masses whose shape turns by more than 22 degrees between the prior and the truth.
TEST(FreeShapes, FarFromTheReferenceAreToldApart) {
  std::string two = k_study.substr(0, k_study.find("masses =")) + R"(masses = { m1 = 1.0, m2 = 1.0 }
springs = [
  { name = "k1", between = ["ground", "m1"], stiffness = 1.0 },
  { name = "k2", between = ["ground", "m2"], stiffness = 1.0 },
  { name = "kc", between = ["m1", "m2"], stiffness = 0.1 },
]
)";
  for (const auto& [table, name, mean, std] : {std::tuple{"parameter", "k1", 1.0, 0.3},
                                               {"parameter", "k2", 1.0, 0.3},
                                               {"truth.parameter", "k1", 1.26, 0.02},
                                               {"truth.parameter", "k2", 1.0, 0.02}}) {
    two += fmt::format(
        "[[{0}]]\nname = \"{1}\"\ntarget = \"spring:{1}\"\ndistribution = {{ kind = \"normal\", mean = {2:.2f}, std = "
        "{3} }}\n",
        table, name, mean, std);
  }
  two += R"(
[outputs]
frequencies = [1]
shapes = { modes = [1], dofs = ["m1", "m2"], size = "free" }
[test]
file = "drawn/specimens.csv"
repeatability = { "f*" = "0.01 %", "phi*" = 0.002 }
[update]
method = "maximum-likelihood"
samples = 400
[truth]
specimens = 40
noise = { "f*" = "0.01 %", "phi*" = 0.002 }
)";
  StudyFolder folder;
  folder.write("study.toml", two);
  folder.simulate();
  for (const std::string method : {"maximum-likelihood", "deterministic", "mares"}) {
    folder.write("study.toml", edited(two, {{"maximum-likelihood", method}}));
    const nlohmann::json mean = folder.update()["parameters"]["mean"];
    EXPECT_NEAR(mean[0].get<double>(), 1.26, 4.0 * 0.03 / std::sqrt(40.0)) << method;
    EXPECT_NEAR(mean[1].get<double>(), 1.0, 4.0 * 0.03 / std::sqrt(40.0)) << method;
  }
}

TEST(FreeShapes, AreRefusedWithTheLineOfAWrongSize) {
  const StudyFolder folder;
  write_modes(folder, [](int, int) { return 1.0; });
  for (const std::string size : {"\"unknown\"", "3"}) {
    const std::string text = edited(k_study, {{"\"m3\"] }", "\"m3\"], size = " + size + " }"}});
    folder.write("study.toml", text);
    EXPECT_THAT(folder.refusal(), testing::StartsWith(fmt::format("study.toml:{}: outputs.shapes.size",
                                                                  test::line_of(text, "shapes ="))));
  }
  folder.write("study.toml", edited(k_study, {{R"(dofs = ["m1", "m2", "m3"])", R"(dofs = ["m2"])"}}));
  EXPECT_THAT(folder.refusal(), HasSubstr("one component alone"));
}

}  // namespace
}  // namespace mottle::study
