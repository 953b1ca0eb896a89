// Tests that come as modes, a file a specimen: universal files, tables of shapes, MATLAB files.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "mottle/study/jobs/modes.hpp"
#include "support/study_airframe.hpp"
#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::AirframeFolder;
using test::edited;
using test::StudyFolder;
using test::TestsOfModel;
using test::TextChange;
using test::WrittenTable;
using testing::HasSubstr;

const std::string k_shapes =
    R"(shapes = { modes = [7, 9, 11, 14], dofs = ["11:+X", "11:+Z", "111:+X", "111:+Z", "205:+Y"])";
const std::vector<int> k_shape_modes{7, 9, 11, 14};
const std::vector<std::string> k_locations{"11:+X", "11:+Z", "111:+X", "111:+Z", "205:+Y"};
const TextChange k_noise_of_shapes{"\"f*\" = \"0.1 %\"", "\"f*\" = \"0.1 %\"\n\"phi*\" = 0.01"};

/// Shapes as further outputs; `size` is an entry of theirs.
std::vector<TextChange> with_shapes(const std::string& size = "") {
  return {{"frequencies = [7,", k_shapes + size + " }\nfrequencies = [7,"}, k_noise_of_shapes};
}

/// What the aeroplanes were before the files were made of them.
WrittenTable drawn(AirframeFolder& airframe) {
  return airframe.folder.simulate({.study = "05/truth.toml", .out = "truth"});
}

std::vector<std::string> names_of_shape(int mode) {
  std::vector<std::string> names;
  for (const std::string& location : k_locations) names.push_back(fmt::format("phi{}:{}", mode, location));
  return names;
}

TEST(ModeFiles, OfEveryHabitGiveTheFrequenciesAndShapesThatWereDrawn) {
  AirframeFolder airframe;
  const WrittenTable truth = drawn(airframe);
  airframe.change(with_shapes());
  const TestsOfModel used = airframe.tests();
  int compared = 0;
  for (const std::string& name : used.names) {
    const bool is_shape = name.starts_with("phi");
    for (std::size_t specimen = 0; specimen < 10; ++specimen) {
      const double value = used.value(specimen, name);
      const bool is_missing = specimen == 2 && (name == "f9" || name.starts_with("phi9:"));
      if (is_missing || (specimen == 5 && is_shape)) {  // without modal mass
        EXPECT_TRUE(std::isnan(value)) << name;
        continue;
      }
      // Six digits of the largest component. The complex file turns each sensor by 0.03 sin(node) besides the common
      // phase, of which the real part is left.
      const double exact = truth.numbers(name)[specimen];
      EXPECT_NEAR(value, exact, !is_shape ? 1e-5 * exact : specimen == 3 ? 2e-3 : 2e-5) << name << " of " << specimen;
      ++compared;
    }
  }
  EXPECT_EQ(compared, 10 * 29 - 6 - 20);
}

TEST(ModeFiles, OfFreeShapesGiveTheRatiosThatWereDrawn) {
  AirframeFolder airframe;
  const WrittenTable truth = drawn(airframe);
  airframe.change(with_shapes(", size = \"free\""));
  const TestsOfModel used = airframe.tests();
  int compared = 0;
  for (std::size_t specimen = 0; specimen < 10; ++specimen) {
    for (const int mode : k_shape_modes) {
      if (specimen == 2 && mode == 9) continue;  // a mode that was not found
      std::vector<std::string> names = names_of_shape(mode);
      std::erase_if(names, [&](const std::string& name) { return std::ranges::count(used.names, name) == 0; });
      const auto exact = [&](const std::string& name) { return truth.numbers(name)[specimen]; };
      const std::string largest =
          *std::ranges::max_element(names, {}, [&](const std::string& name) { return std::abs(exact(name)); });
      for (const std::string& name : names) {
        // Six digits of the largest component, which is not among these; see above of the complex file.
        EXPECT_NEAR(used.value(specimen, name) / used.value(specimen, largest), exact(name) / exact(largest),
                    specimen == 3 ? 5e-3 : 2e-4)
            << name << " of " << specimen;
        ++compared;
      }
    }
  }
  EXPECT_EQ(compared, 10 * 16 - 4);
}

TEST(ModeFiles, OfTheExampleArePairedWithoutADoubt) {
  const AirframeFolder airframe;
  const TestsOfModel used = airframe.tests();
  const WrittenTable pairing = used.pairing();
  std::map<std::string, int> verdicts;
  std::vector<std::string> fifth;
  for (std::size_t i = 0; i < pairing.rows.size(); ++i) {
    const auto cell = [&](const char* name) { return pairing.rows[i][pairing.index(name)]; };
    ++verdicts[cell("verdict")];
    if (cell("verdict") == "missing") {
      EXPECT_EQ(cell("specimen") + " " + cell("mode"), "3 9");
    }
    if (cell("verdict") == "left out") {
      EXPECT_EQ(cell("mode"), "13");
    }
    if (cell("verdict") != "paired") continue;
    EXPECT_GT(std::stod(cell("mac")), 0.98);
    if (cell("specimen") == "5") fifth.push_back(cell("test_mode"));
  }
  EXPECT_EQ(verdicts, (std::map<std::string, int>{{"paired", 89}, {"missing", 1}, {"left out", 10}}));
  EXPECT_EQ(fifth, (std::vector<std::string>{"6", "1", "7", "2", "8", "3", "4", "10", "5"}));
  EXPECT_THAT(fmt::format("{}", fmt::join(used.tests.notes, " ")),
              HasSubstr("Modes that were not found: specimen 3 mode 9."));
}

TEST(ModeFiles, ThatWereWrittenAreTheModelsModesWhenReadAgain) {
  const AirframeFolder airframe;
  const ModesOutcome modes = find_modes({.model = airframe.folder / "02-airframe/airframe.bdf",
                                         .modes = 16,
                                         .compare = {},
                                         .writes_universal_file = true});
  write_results(modes, airframe.folder / "modes");
  std::vector<TextChange> changes = with_shapes();
  changes.push_back({"file = \"specimens\" ", "file = \"../modes/modes.uff\" "});
  airframe.change(changes);
  const TestsOfModel used = airframe.tests();
  const WrittenTable pairing = used.pairing();
  for (std::size_t i = 0; i < pairing.rows.size(); ++i) {
    const auto cell = [&](const char* name) { return pairing.rows[i][pairing.index(name)]; };
    const int mode = std::stoi(cell("mode"));
    if (mode >= 7 && mode <= 16 && mode != 13) {
      EXPECT_EQ(cell("verdict"), "paired") << mode;
    }
    if (cell("verdict") == "paired") {
      EXPECT_GT(std::stod(cell("mac")), 1.0 - 1e-9) << mode;
    }
  }
  EXPECT_NEAR(used.value(0, "f9") / modes.frequencies()(8), 1.0, 1e-5);
}

TEST(ModeFiles, OfMatlabAreATableOrModes) {
  const StudyFolder folder;
  const auto use = [&](const std::string& name) {
    const auto file = std::filesystem::path(MOTTLE_SOURCE_DIR) / "tests/formats/mat" / name;
    folder.change({{"file = \"tests.csv\"", fmt::format("file = \"{}\"", file.string())}, {"[1, 2, 3]", "[1, 2]"}});
  };
  use("octave-v4.mat");
  EXPECT_THAT(folder.refusal(), HasSubstr("f1 10.62 against 0.2027 Hz, f2 20.25 against"));
  use("scipy-v7.mat");
  const std::string said = folder.check({.set = {"outputs.frequencies=[1]", "update.method=\"maximum-likelihood\""}});
  EXPECT_THAT(said, HasSubstr("tests: 2 specimens of 1 outputs"));
  EXPECT_THAT(said, HasSubstr("Measured components that the model does not have: 2 of specimen 1"));
}

TEST(ModeFiles, AreNamedByListsAndPatterns) {
  const AirframeFolder airframe;
  airframe.change({{"file = \"specimens\" ", "file = [\"specimens/*-0[2].uff\"] "}});
  EXPECT_THAT(airframe.refusal(), HasSubstr("no file fits this pattern"));
  airframe.change({{"file = \"specimens\" ", "file = [\"specimens/*-0?.uff\", \"specimens/aeroplane-10.uff\"] "}});
  EXPECT_THAT(airframe.check(), HasSubstr("tests: 10 specimens of 9 outputs"));
}

TEST(ModeFiles, GiveTheSameShapesInOtherUnits) {
  const AirframeFolder airframe;
  airframe.change(with_shapes());
  const TestsOfModel kilograms = airframe.tests();
  std::vector<TextChange> changes = with_shapes();
  changes.push_back({"units = \"SI\"", "units = \"mm-t-s\""});
  airframe.change(changes);
  const TestsOfModel tonnes = airframe.tests();
  int scaled = 0;
  for (std::size_t specimen = 0; specimen < 10; ++specimen) {
    const double ratio = std::abs(tonnes.value(specimen, "phi9:11:+Z") / kilograms.value(specimen, "phi9:11:+Z"));
    if (std::isnan(ratio) || std::abs(ratio - 1.0) < 1e-9) continue;  // 1: no modal mass, scaled to the model's
    EXPECT_NEAR(ratio, std::sqrt(1000.0), 1e-6);
    ++scaled;
  }
  EXPECT_GT(scaled, 0);
  EXPECT_EQ(kilograms.value(0, "f9"), tonnes.value(0, "f9"));
}

TEST(ModeFiles, MayBeTablesOfShapesWhoseSensorsHungUpsideDown) {
  const AirframeFolder airframe;
  const std::string table = read_file(test::examples() / "02-airframe/shapes-test.csv");
  std::string turned;
  for (const std::string& line : test::lines_of(table)) {
    const std::vector<std::string> cells = test::split(line, ',');
    if (cells[0] != "11:+Z") {
      turned += line + "\n";
      continue;
    }
    turned += "11:-Z";
    for (std::size_t k = 1; k < cells.size(); ++k) turned += fmt::format(",{}", -std::stod(cells[k]));
    turned += "\n";
  }
  airframe.folder.write("05/a.csv", table);
  airframe.folder.write("05/b.csv", turned);
  airframe.change({{"file = \"specimens\" ", "file = [\"a.csv\", \"b.csv\"] "}});
  const TestsOfModel used = airframe.tests();
  EXPECT_EQ(used.value(0, "f7"), 5.99);
  EXPECT_EQ(used.value(1, "f7"), 5.99);
  std::map<std::string, std::vector<std::string>> macs;
  const WrittenTable pairing = used.pairing();
  for (const auto& row : pairing.rows) macs[row[pairing.index("mode")]].push_back(row[pairing.index("mac")]);
  for (const auto& [mode, values] : macs) {
    ASSERT_EQ(values.size(), 2U) << mode;
    EXPECT_EQ(values[0], values[1]) << mode;
  }
}

TEST(ModeFiles, ThatWereCopiedAreNamed) {
  const AirframeFolder airframe;
  airframe.folder.write("05/specimens/aeroplane-2b.uff", airframe.folder.text("05/specimens/aeroplane-02.uff"));
  EXPECT_THAT(airframe.check(), HasSubstr("as copies do: specimen 11 (aeroplane-2b.uff) equals 2 (aeroplane-02.uff)."));
}

TEST(ModeFiles, AreRefusedWithTheLineOfAMistake) {
  const AirframeFolder airframe;
  const std::string name = "05/specimens/aeroplane-01.uff";
  const std::vector<std::string> lines = test::lines_of(airframe.folder.text(name));
  const std::string wrong = edited(airframe.folder.text(name), {{lines[lines.size() - 4], "          what"}});
  airframe.folder.write(name, wrong);
  test::expect_message(airframe.refusal(), {fmt::format("aeroplane-01.uff:{}:", test::line_of(wrong, "what")),
                                            "'what' stands where a number should be"});
}

TEST(ModeFiles, AreRefusedWhereTheirNodesAreNotTheModels) {
  const AirframeFolder airframe;
  const std::filesystem::path specimens = airframe.folder / "05/specimens";
  std::filesystem::remove(specimens / "aeroplane-08.uff");  // dataset 2414: not every number alone on a line is a node
  for (const auto& entry : std::filesystem::directory_iterator(specimens)) {
    std::string shifted;
    for (std::string line : test::lines_of(read_file(entry.path()))) {
      if (line.ends_with('\r')) line.pop_back();
      const std::string word = test::on_one_line(line);
      const bool is_node =
          line.size() == 10 && !word.empty() && word.find_first_not_of("0123456789") == std::string::npos;
      shifted += (is_node ? fmt::format("{:10d}", std::stoi(word) + 500000) : line) + "\n";
    }
    write_file_atomically(entry.path(), shifted);
  }
  EXPECT_THAT(airframe.refusal(), HasSubstr("none of its 22 measured degrees of freedom is in the model"));
}

}  // namespace
}  // namespace mottle::study
