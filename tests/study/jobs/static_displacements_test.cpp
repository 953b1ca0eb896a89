// Static displacements as outputs: numbers by hand, systems of units, predictions, refusals.
#include <gtest/gtest.h>

#include <cmath>

#include "mottle/study/jobs/diagnose.hpp"
#include "support/study_commands.hpp"
#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::edited;
using test::expect_refused;
using test::StudyFolder;
using test::TextChange;
using testing::HasSubstr;

const std::string k_static =
    R"(static = [{ forces = { m3 = 1.0 }, dofs = ["m1", "m3"] }, { forces = { m1 = 1.0, m2 = -0.5 }, dofs = ["m2"] }])";
const TextChange k_static_alone{"frequencies = [1, 2, 3]", k_static};
const TextChange k_static_too{"frequencies = [1, 2, 3]", "frequencies = [1, 2, 3]\n" + k_static};
const std::vector<std::string> k_names{"u1:m1", "u1:m3", "u2:m2"};

/// u of the study's loads at each k1, by hand: K = [k1+4, -1, -3; -1, 3, -1; -3, -1, 5].
std::vector<std::vector<double>> displacements(const std::vector<double>& k1s) {
  std::vector<std::vector<double>> rows;
  for (const double k1 : k1s) {
    const double determinant = 14.0 * (k1 + 4.0) - 38.0;  // by the first row
    const double u13 = 10.0;
    const double u33 = 3.0 * (k1 + 4.0) - 1.0;
    const double u21 = 8.0;
    const double u22 = 5.0 * (k1 + 4.0) - 9.0;
    rows.push_back({u13 / determinant, u33 / determinant, (u21 - 0.5 * u22) / determinant});
  }
  return rows;
}

std::string table(const std::vector<std::vector<double>>& rows) {
  return test::csv_text("u1:m1,u1:m3,u2:m2", rows);
}

/// k1 alone from static displacements alone.
std::string static_study() {
  const std::string& good = test::k_three_masses_study;
  const std::size_t k2 = good.find("[[parameter]]\nname = \"k2\"");
  return test::three_masses({k_static_alone,
                             {good.substr(k2, good.find("[outputs]") - k2), ""},
                             {"method = \"mares\"", "method = \"maximum-likelihood\""},
                             {"file = \"tests.csv\"", "file = \"tests.csv\"\nrepeatability = { \"u*\" = 1e-6 }"}});
}

TEST(StaticDisplacements, AloneGiveTheStiffnessBackWithAnyNumberOfThreads) {
  StudyFolder folder;
  folder.write("study.toml", static_study());
  folder.write("tests.csv", table(displacements({0.8, 0.9, 1.0, 1.1, 1.2})));
  EXPECT_NO_THROW(folder.check());
  const nlohmann::json result = folder.update();
  EXPECT_NEAR(result["parameters"]["mean"][0].get<double>(), 1.0, 2e-3);  // first order in a scatter of 16 %
  EXPECT_NEAR(result["parameters"]["std"][0].get<double>(), 0.15811, 5e-3);
  EXPECT_EQ(test::untimed(folder.update({.out = "again", .threads = 2})), test::untimed(result));
}

TEST(StaticDisplacements, ArePredictedFromModes) {
  StudyFolder folder;
  folder.write("study.toml", test::three_masses({{"\"mares\"", "\"maximum-likelihood\""}}) +
                                 "\n[predict]\ndraws = 1000\n" + k_static + "\n");
  EXPECT_EQ(folder.update()["prediction"]["names"], nlohmann::json(k_names));
  for (const auto& row : folder.table("out/prediction.csv").rows) EXPECT_EQ(row[5], "m");
}

// A cantilever along x of one beam: w(L) = F L^3 / (3 E I), w'(L) = F L^2 / (2 E I), which one element gives exactly.
TEST(StaticDisplacements, OfABeamAreTheClosedFormsInTwoSystemsOfUnits) {
  constexpr double length = 1.2;
  constexpr double arm = 0.3;
  constexpr double inertia = 2e-8;
  constexpr double young = 7e10;
  constexpr double force = 30.0;
  const double moment = -force * arm;  // of the force on the rigid arm about the tip
  const std::vector<double> exact{force * std::pow(length, 3) / (3.0 * young * inertia),
                                  force * std::pow(length, 2) / (2.0 * young * inertia),
                                  moment * length / (young * inertia)};
  StudyFolder folder;
  for (const auto& [units, metre, mass] : {std::tuple{"SI", 1.0, 1.0}, std::tuple{"mm-t-s", 1e3, 1e-3}}) {
    SCOPED_TRACE(units);
    folder.write("beam.bdf",
                 fmt::format("SOL 103\nCEND\nSPC = 1\nMETHOD = 1\nBEGIN BULK\nEIGRL,1,,,3\n"
                             "GRID,1,,0.0,0.0,0.0\nGRID,2,,{0:.1f},0.0,0.0\nGRID,3,,{0:.1f},{1:.1f},0.0\n"
                             "CBAR,1,1,1,2,0.0,1.0,0.0\nRBE2,5,2,123456,3\nPBAR,1,1,{2:.6E},{3:.6E},{3:.6E},{3:.6E}\n"
                             "MAT1,1,{4:.6E},,0.3,{5:.6E}\nSPC1,1,123456,1\nENDDATA\n",
                             length * metre, arm * metre, 4e-4 * metre * metre, inertia * std::pow(metre, 4),
                             young / (metre * metre), 2700.0 * mass / std::pow(metre, 3)));
    folder.write("study.toml",
                 fmt::format("units = \"{}\"\n[model]\nkind = \"nastran\"\nfile = \"beam.bdf\"\n[[parameter]]\n"
                             "name = \"E\"\ntarget = \"MAT1:1:E\"\nrelative = true\n"
                             "distribution = {{ kind = \"normal\", mean = 1.0, std = 0.1 }}\n[outputs]\n"
                             "static = [{{ forces = {{ \"2:+Y\" = {}.0 }}, dofs = [\"2:+Y\", \"2:+RZ\"] }},\n"
                             "          {{ forces = {{ \"3:+X\" = {}.0 }}, dofs = [\"2:+RZ\"] }}]\n",
                             units, force, force));
    const test::WrittenTable cloud = folder.propagate("E\n1.0\n2.0\n");
    const std::vector<double> sizes{metre, 1.0, 1.0};
    const std::vector<std::string> names{"u1:2:+Y", "u1:2:+RZ", "u2:2:+RZ"};
    for (std::size_t k = 0; k < 3; ++k) {
      for (const std::size_t row : {0U, 1U}) {
        const double factor = row == 0 ? 1.0 : 2.0;
        EXPECT_NEAR(cloud.numbers(names[k])[row] / (exact[k] * sizes[k] / factor), 1.0, 1e-9) << names[k];
      }
    }
  }
}

TEST(StaticDisplacements, AreRefusedWithTheLoadThatCannotBe) {
  const auto wrong = [](const std::string& found, const std::string& put, const std::string& says) {
    return test::WrongStudy{
        .what = put,
        .changes = {{"frequencies = [1, 2, 3]", "frequencies = [1, 2, 3]\n" + edited(k_static, {{found, put}})}},
        .says = {says},
        .at = "static ="};
  };
  expect_refused({
      wrong("{ m3 = 1.0 }, dofs", "{ m9 = 1.0 }, dofs", "outputs.static.1.forces: "),
      wrong("{ m3 = 1.0 }, dofs", "{ m3 = 0.0 }, dofs", "outputs.static.1.forces: the load has no force that is not 0"),
      wrong("{ m3 = 1.0 }, dofs", "{ m3 = 1e200 }, dofs", "outputs.static.1.forces.m3"),
      wrong("dofs = [\"m2\"]", "dofs = [\"m9\"]", "outputs.static.2.dofs: "),
      wrong("{ m3 = 1.0 }, dofs", "{ m3 = \"1\" }, dofs", "forces.m3"),
      wrong("dofs = [\"m1\", \"m3\"]", "dofs = [\"m1\", \"m1\"]", "outputs.static.1.dofs: 'm1' is given twice"),
      wrong(", dofs = [\"m2\"]", "", "dofs"),
      wrong(", dofs = [\"m2\"]", ", dofs = [\"m2\"], node = 1", "node"),
      {"the second of two tables",
       {{"frequencies = [1, 2, 3]\n",
         "frequencies = [1, 2, 3]\n\n[[outputs.static]]\nforces = { m3 = 1.0 }\ndofs = [\"m1\", \"m3\"]\n\n"
         "[[outputs.static]]\nforces = { m1 = 1.0 }\ndofs = [\"m7\"]\n"}},
       {"outputs.static.2.dofs: "},
       "dofs = [\"m7\"]"},
  });
}

TEST(StaticDisplacements, AreNotInTestsThatComeAsModes) {
  const std::filesystem::path example = std::filesystem::path(MOTTLE_SOURCE_DIR) / "examples/05-uff-population";
  std::string text = read_file(example / "study.toml");
  const std::size_t outputs = text.find("[outputs]");
  text.replace(outputs, text.find("\n[", outputs) - outputs,
               "[outputs]\nstatic = [{ forces = { \"105:+Z\" = 1.0 }, dofs = [\"105:+Z\"] }]\n");
  text = edited(text, {{"\"../02-airframe/airframe.bdf\"",
                        nlohmann::json((example / "../02-airframe/airframe.bdf").lexically_normal().string()).dump()},
                       {"file = \"specimens\"", "file = " + nlohmann::json((example / "specimens").string()).dump()}});
  const StudyFolder folder;
  folder.write("study.toml", text);
  const std::string message = folder.refusal();
  EXPECT_THAT(message, HasSubstr("test.file: these files hold modes, and no output is of a mode"));
  EXPECT_EQ(folder.without_path(test::message_of<InvalidInput>([&] { (void)diagnose(folder.study(), {}); })), message);
}

TEST(StaticDisplacements, AreRefusedInAnotherUnitThanTheStudys) {
  const StudyFolder folder;
  folder.write("study.toml", static_study());
  const std::string good = table(displacements({0.8, 0.9, 1.0, 1.1}));
  for (const std::string title : {"u1:m1 [m]", "u1:m1_m"}) {
    folder.write("tests.csv", edited(good, {{"u1:m1", title}}));
    EXPECT_NO_THROW(folder.check()) << title;
  }
  for (const std::string title : {"u1:m1 [mm]", "u1:m1 (in)"}) {
    folder.write("tests.csv", edited(good, {{"u1:m1", title}}));
    EXPECT_THAT(folder.refusal(), HasSubstr("u1:m1 is in m")) << title;
  }
}

TEST(StaticDisplacements, AreShownByACheckWithoutModes) {
  const StudyFolder folder;
  folder.write("study.toml", static_study());
  folder.write("tests.csv", table(displacements({0.8, 0.9, 1.0, 1.1})));
  EXPECT_THAT(folder.check_lines(), testing::ContainsRegex("u1:m1 +0.217391 m "));  // 10 / (14 * 6 - 38)
}

TEST(StaticDisplacements, SeeNoMassWhichEveryMethodNames) {
  StudyFolder folder;
  std::vector<std::vector<double>> rows = displacements({0.8, 0.9, 1.0, 1.1, 1.2, 0.95, 1.05});
  for (std::size_t i = 0; i < rows.size(); ++i) {  // else three outputs of one parameter have a singular covariance
    for (std::size_t j = 0; j < 3; ++j)
      rows[i][j] += 1e-3 * std::sin(7.0 * static_cast<double>(i) + 3.0 * static_cast<double>(j));
  }
  folder.write("tests.csv", table(rows));
  const std::string mass =
      "[[parameter]]\nname = \"m\"\ntarget = \"mass:m1\"\ndistribution = { kind = \"normal\", mean = 1.0, std = 0.1 "
      "}\n\n";
  for (const std::string method : {"maximum-likelihood", "inversion", "mares", "perturbation", "moment-matching"}) {
    SCOPED_TRACE(method);
    folder.write("study.toml", edited(static_study(), {{"[outputs]", mass + "[outputs]"},
                                                       {"\"maximum-likelihood\"", "\"" + method + "\""},
                                                       {"\n[update.mares]\nweighting = \"mahalanobis\"\n", ""}}));
    const RunSummary summary = summarise(update(folder.study(), {}), "out");
    EXPECT_THAT(fmt::format("{}", fmt::join(summary.lines, "\n")),
                HasSubstr("m cannot be identified from the outputs"));
  }
}

TEST(StaticDisplacements, NeedAStiffnessThatAProgramDoesNotGive) {
  const StudyFolder folder;
  folder.write("input.txt", "{{k1}} {{k2}}\n");
  folder.write("solver.py", "open('f.txt', 'w').write('1.0\\n2.0\\n')\n");
  const std::string text = edited(test::command_study({"python3", "-S", "-E", "solver.py"}), {k_static_alone});
  folder.write("study.toml", text);
  EXPECT_THAT(folder.refusal(), HasSubstr(fmt::format("study.toml:{}: outputs.static: the model's modes come from runs",
                                                      test::line_of(text, "static ="))));
}

}  // namespace
}  // namespace mottle::study
