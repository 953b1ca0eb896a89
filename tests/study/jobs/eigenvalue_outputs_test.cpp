// Eigenvalues and ratios of shape components as outputs of every kind of model and table of tests.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/study_commands.hpp"
#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::csv_text;
using test::edited;
using test::StudyCall;
using test::StudyFolder;
using test::TextChange;
using test::three_masses;
using test::WrittenTable;
using testing::HasSubstr;

using Rows = std::vector<std::vector<double>>;

constexpr double k_two_pi = 2.0 * std::numbers::pi;
const std::vector<std::string> k_names{"lambda1", "lambda2", "lambda3", "ratio1:m2/m1", "ratio2:m1/m2"};
const std::string k_header = "lambda1,lambda2,lambda3,ratio1:m2/m1,ratio2:m1/m2";
const TextChange k_outputs{"frequencies = [1, 2, 3]",
                           "eigenvalues = [1, 2, 3]\n"
                           R"(shape_ratios = [{ mode = 1, dofs = ["m2", "m1"] }, { mode = 2, dofs = ["m1", "m2"] }])"};
const std::string k_truth = R"(
[truth]
specimens = 30
noise = { "lambda*" = "0.1 %", "ratio*" = 0.002 }
[[truth.parameter]]
name = "k1"
target = "spring:k1"
distribution = { kind = "normal", mean = 1.6, std = 0.1 }
[[truth.parameter]]
name = "k2"
target = "spring:k2"
distribution = { kind = "normal", mean = 2.3, std = 0.2 }
)";

std::string study_of_outputs() {
  return three_masses({k_outputs}) + k_truth;
}

/// Specimens of the truth.
const Rows& drawn() {
  static const Rows rows = [] {
    StudyFolder folder;
    folder.write("study.toml", study_of_outputs());
    folder.simulate();
    return test::numbers_of(folder.text("drawn/specimens.csv"));
  }();
  return rows;
}

/// The first `count` numbers of each row, each changed.
Rows first_numbers(std::size_t count, const std::function<double(double)>& change) {
  Rows rows = drawn();
  for (auto& row : rows) {
    row.resize(count);
    for (double& value : row) value = change(value);
  }
  return rows;
}

double frequency(double eigenvalue) {
  return std::sqrt(eigenvalue) / k_two_pi;
}

StudyCall quick(const std::string& out = "out", std::vector<std::string> set = {}) {
  set.insert(set.end(), {"update.method=\"maximum-likelihood\"", "update.samples=100"});
  return {.out = out, .set = std::move(set)};
}

StudyFolder& with_tests(StudyFolder& folder, const std::string& header, const Rows& rows) {
  folder.write("study.toml", study_of_outputs());
  folder.write("tests.csv", csv_text(header, rows));
  return folder;
}

TEST(EigenvalueOutputs, LetAnUpdateFindThePopulation) {
  StudyFolder folder;
  const nlohmann::json result = with_tests(folder, k_header, drawn()).update(quick());
  EXPECT_EQ(result["outputs"]["names"], nlohmann::json(k_names));
  EXPECT_EQ(result["outputs"]["units"], nlohmann::json({"(rad/s)^2", "(rad/s)^2", "(rad/s)^2", "-", "-"}));
  const std::vector<double> means{1.6, 2.3};
  const std::vector<double> deviations{0.1, 0.2};
  for (std::size_t i = 0; i < 2; ++i) {
    // Thirty specimens: four standard errors of the mean, and of a deviation, std / sqrt(2 * 29).
    EXPECT_NEAR(result["parameters"]["mean"][i].get<double>(), means[i], 4.0 * deviations[i] / std::sqrt(30.0));
    EXPECT_NEAR(result["parameters"]["std"][i].get<double>(), deviations[i], 0.55 * deviations[i]);
  }
}

TEST(EigenvalueOutputs, TellTheSameAsTheFrequencies) {
  StudyFolder folder;
  folder.write("tests.csv", csv_text("lambda1,lambda2,lambda3", first_numbers(3, [](double value) { return value; })));
  folder.change({{"frequencies = [1, 2, 3]", "eigenvalues = [1, 2, 3]"}});
  const nlohmann::json by_eigenvalue = folder.update(quick())["parameters"]["mean"];
  folder.change({});
  folder.write("tests.csv", csv_text("f1,f2,f3", first_numbers(3, frequency)));
  const nlohmann::json by_frequency = folder.update(quick())["parameters"]["mean"];
  // The same data on a curved scale: half a per cent of noise and scatter of 3 % differ by their squares.
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(by_eigenvalue[i].get<double>(), by_frequency[i].get<double>(), 0.01);
  }
}

TEST(EigenvalueOutputs, MayStateTheirUnitAndNoOther) {
  StudyFolder folder;
  const std::string others = k_header.substr(k_header.find(','));
  for (const std::string title :
       {"lambda1 [(rad/s)^2]", "lambda1 [rad^2/s^2]", "lambda1_(rad/s)^2", "lambda1 ((rad/s)^2)"}) {
    EXPECT_NO_THROW(with_tests(folder, title + others, drawn()).check()) << title;
  }
  EXPECT_THAT(with_tests(folder, "lambda1 [Hz^2]" + others, drawn()).refusal(), HasSubstr("multiply it by 4 pi^2"));
}

TEST(EigenvalueOutputs, AreRefusedInAnotherUnit) {
  Rows rows = drawn();
  for (auto& row : rows) {
    for (std::size_t k = 0; k < 3; ++k) row[k] /= k_two_pi * k_two_pi;  // Hz^2
  }
  StudyFolder folder;
  EXPECT_THAT(with_tests(folder, k_header, rows).refusal(), HasSubstr("factor is near 1/(2 pi)"));
}

TEST(EigenvalueOutputs, MoveWithTheirModesWhereColumnsArePairedByFrequency) {
  StudyFolder folder;
  const std::vector<std::string> by_frequency{"test.pairing=\"frequency\""};
  const nlohmann::json expected =
      with_tests(folder, k_header, drawn()).update(quick("out", by_frequency))["parameters"]["mean"];
  with_tests(folder, "lambda7,lambda8,lambda9,ratio7:m2/m1,ratio8:m1/m2", drawn());
  EXPECT_EQ(folder.update(quick("again", by_frequency))["parameters"]["mean"], expected);
}

TEST(EigenvalueOutputs, OfTestsAsModesHaveWhateverSizeAndSignShapesHave) {
  StudyFolder folder;
  const std::vector<double> size{0.3, -2.0, 11.0};
  for (std::size_t i = 0; i < 6; ++i) {
    const std::vector<double>& row = drawn()[i];
    const double a = size[i % 3];
    const double b = size[(i + 1) % 3];
    folder.write(fmt::format("modes-{}.csv", i),
                 fmt::format("dof,{} Hz,{} Hz,{} Hz\nm1,{},{},1\nm2,{},{},0\nm3,{},{},-1\n", frequency(row[0]),
                             frequency(row[1]), frequency(row[2]), a, b * row[4], a * row[3], b, a, -b));
  }
  folder.write("study.toml", edited(study_of_outputs(), {{"file = \"tests.csv\"", "file = \"modes-*.csv\""}}));
  folder.update({.set = {"update.samples=50"}});
  const WrittenTable used = folder.table("out/tests.csv");
  std::vector<std::string> header = k_names;
  header.emplace_back("specimen");
  EXPECT_EQ(used.header, header);
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(used.numbers(k_names[k])[i] / drawn()[i][k], 1.0, 1e-12);
  }
}

// Two masses of 1 on springs k1 and k2, tied by 1: eigenvalues and shapes by the quadratic.
TEST(EigenvalueOutputs, AreGivenByASolverOfTheUsersOwn) {
  StudyFolder folder;
  folder.write("input.txt", "{{k1}} {{k2}}");
  folder.write("solver.py",
               "import math\nk1, k2 = map(float, open('input.txt').read().split())\n"
               "m, h = 1 + (k1 + k2) / 2, math.hypot((k1 - k2) / 2, 1)\n"
               "l = [m - h, m + h]\n"
               "open('f.txt', 'w').write(''.join(f'{x!r}\\n' for x in l))\n"
               "open('s.csv', 'w').write('dof,1,2\\na,1,1\\nb,%r,%r\\n' % tuple(k1 + 1 - x for x in l))\n");
  folder.write("study.toml",
               edited(test::command_study({"python3", "-S", "-E", "solver.py"}),
                      {{"format = \"column\"\n",
                        "format = \"column\"\nquantity = \"eigenvalue\"\n[model.shapes]\nfile = \"s.csv\"\n"
                        "format = \"csv\"\n"},
                       {"frequencies = [1, 2, 3]",
                        "eigenvalues = [1, 2]\nshape_ratios = [{ mode = 1, dofs = [\"b\", \"a\"] }]"}}));
  folder.write("tests.csv", "lambda1,lambda2,ratio1:b/a\n2,4,0.5\n3,5,0.6\n");
  const WrittenTable cloud = folder.propagate("k1,k2\n2,2\n2,3.5\n");
  for (std::size_t i = 0; i < 2; ++i) {
    const double k1 = cloud.numbers("k1")[i];
    const double k2 = cloud.numbers("k2")[i];
    const double low = 1.0 + (k1 + k2) / 2.0 - std::hypot((k1 - k2) / 2.0, 1.0);
    EXPECT_NEAR(cloud.numbers("lambda1")[i], low, 1e-12);
    EXPECT_NEAR(cloud.numbers("ratio1:b/a")[i], k1 + 1.0 - low, 1e-12);
  }
}

TEST(EigenvalueOutputs, CanBePredicted) {
  StudyFolder folder;
  with_tests(folder, k_header, drawn());
  folder.write(
      "study.toml",
      study_of_outputs() + "\n[predict]\neigenvalues = [1]\nshape_ratios = [{ mode = 1, dofs = [\"m3\", \"m1\"] }]\n");
  EXPECT_EQ(folder.update(quick())["prediction"]["names"], nlohmann::json({"lambda1", "ratio1:m3/m1"}));
}

TEST(EigenvalueOutputs, AreRefusedWithTheirLine) {
  const auto wrong = [](const std::string& entry, const std::string& says) {
    return test::WrongStudy{
        .what = entry, .changes = {{"frequencies = [1, 2, 3]", entry}}, .says = {says}, .at = entry};
  };
  test::expect_refused({
      wrong("eigenvalues = [1, 9]", "mode 9 is not there"),
      wrong("shape_ratios = [{ mode = 1, dofs = [\"m1\"] }]", "two different"),
      wrong("shape_ratios = [{ dofs = [\"m1\", \"m2\"] }]", "mode: is missing"),
      wrong("shape_ratios = [{ mode = 1, dofs = [\"m1\", \"m7\"] }]", "m7"),
  });
}

}  // namespace
}  // namespace mottle::study
