// A structure behind a command: two masses in a row whose modes awk computes, lambda = (3 +- sqrt 5) / 2 k, shapes
// known.
#include "mottle/drivers/command/external_solver.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "core/temporary_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/drivers/command/run_folders.hpp"
#include "mottle/model/structure_model.hpp"

namespace {

using mottle::InvalidInput;
using mottle::SystemFailure;
using mottle::drivers::ExternalSolver;
using mottle::drivers::SolverCommand;
using mottle::model::Evaluation;
using mottle::model::OutputSelection;
using mottle::model::StructureModel;
using testing::HasSubstr;
using testing::ThrowsMessage;

// For k from 50 on something goes wrong: it crashes, hangs, prints garbage, loses a mode, turns the modes around.
constexpr const char* k_solver = R"(k=$(echo $(cat input))
echo $k >> "$LOG"
case ${k%.*} in
  50) kill -SEGV $$ ;;
  51) exec sleep 1000 ;;
  52) echo "****" > out; exit 0 ;;
  53) one=1 ;;
  54) exit 3 ;;
  55) [ "$1" = again ] || exit 1 ;;
  56) [ -e "$LOG.full" ] || { touch "$LOG.full"; mkdir -p a; echo "forrtl: No space left on device" > a/log; exit 1; } ;;
  57) [ -e "$LOG.lost" ] || { touch "$LOG.lost"; kill -KILL $PPID; sleep 1000; } ;;
  58) kill -KILL $PPID; sleep 1000 ;;
esac
awk -v k="$k" -v one="$one" 'BEGIN { print k * (3 - sqrt(5)) / 2; if (!one) print k * (3 + sqrt(5)) / 2 }' > out
printf 'dof,a,b\n1:+X,-%s,1\n2:+X,-1,-%s\n' 0.618033988749895 0.618033988749895 > shapes.csv
)";

class External : public testing::Test {
 protected:
  External() {
    mottle::write_file_atomically(folder_ / "input.in", "{{k:%10.6f}}\n");
    mottle::write_file_atomically(folder_ / "solve.sh", k_solver);
    command_.templates = {{folder_ / "input.in", "input"}};
    command_.files = {{folder_ / "solve.sh", "solve.sh"}};
    command_.command.arguments = {"sh", "solve.sh"};
    command_.timeout = std::chrono::seconds(20);
    command_.environment = {{"LOG", (folder_ / "log").string()}};
    command_.frequencies = {
        .file = "out", .quantity = mottle::drivers::FrequencyRule::Quantity::eigenvalue, .column = "1"};
    command_.max_failed_fraction = 1.0;
  }

  std::unique_ptr<ExternalSolver> make(bool is_resumed = false, double mean = 4.0) {
    return std::make_unique<ExternalSolver>(command_, std::vector<std::string>{"k"}, Eigen::VectorXd::Constant(1, mean),
                                            Eigen::VectorXd::Constant(1, 0.4),
                                            mottle::drivers::RunStorage{folder_ / "results", is_resumed}, nullptr);
  }
  Evaluation evaluate(const std::vector<double>& k, bool is_resumed = false,
                      OutputSelection outputs = {.frequencies = {1, 2}}) {
    const StructureModel model(make(is_resumed), std::move(outputs), Eigen::VectorXd::Constant(1, 4.0));
    return model.evaluate(Eigen::Map<const Eigen::VectorXd>(k.data(), static_cast<Eigen::Index>(k.size())), {});
  }
  /// How often the solver ran so far.
  std::ptrdiff_t runs() {
    const std::string log = mottle::read_file(folder_ / "log");
    return std::count(log.begin(), log.end(), '\n');
  }

  mottle::test::TemporaryFolder folder_;
  SolverCommand command_;
};

double frequency(double k, double sign) {
  return std::sqrt(k * (3.0 + sign * std::sqrt(5.0)) / 2.0) / (2.0 * std::numbers::pi);
}

TEST_F(External, GivesTheSolversFrequencies) {
  const Evaluation found = evaluate({1.0, 9.0});
  EXPECT_TRUE(found.failures.empty());
  EXPECT_NEAR(found.outputs(0, 0), frequency(1.0, -1.0), 1e-6);
  EXPECT_NEAR(found.outputs(1, 1), frequency(9.0, 1.0), 1e-6);
}

TEST_F(External, ShapesAreOutputsAndTheirSignIsTheReferences) {
  command_.shapes = mottle::drivers::ShapeRule{.file = "shapes.csv"};
  const Evaluation found = evaluate({1.0}, false,
                                    {.frequencies = {1},
                                     .shape_modes = {2},
                                     .shape_degrees_of_freedom = {"2:+X", "1:+X"},
                                     .tracking = mottle::model::ModeTracking::mac});
  EXPECT_EQ(found.outputs(0, 1), -0.618033988749895);
  EXPECT_EQ(found.outputs(0, 2), 1.0);
}

TEST_F(External, ARunThatFoundTheDiskFullForAMomentIsDoneAgain) {
  EXPECT_THROW(evaluate({1.0, 56.0}), mottle::drivers::NoRoom);
  const Evaluation found = evaluate({1.0, 56.0}, true);
  EXPECT_TRUE(found.failures.empty());
  EXPECT_NEAR(found.outputs(1, 0), frequency(56.0, -1.0), 1e-6);
}

TEST_F(External, ARunWhoseGuardWasKilledIsDoneAgain) {
  const Evaluation found = evaluate({57.0});
  EXPECT_TRUE(found.failures.empty()) << found.failures.front().reason;
  EXPECT_EQ(runs(), 3) << "the means, and twice";
}

TEST_F(External, ARunWhoseGuardIsKilledEachTimeIsNotKeptAsAFailure) {
  EXPECT_THAT(evaluate({58.0}).failures.at(0).reason, HasSubstr("its guard was killed from outside (3 tries"));
  const std::ptrdiff_t before = runs();
  EXPECT_EQ(evaluate({58.0}, true).failures.size(), 1U);
  EXPECT_EQ(runs(), before + 3) << "a resumed job asks again";
}

TEST_F(External, ARunThatFailsCostsItsSampleAlone) {
  command_.timeout = std::chrono::milliseconds(1500);
  const Evaluation found = evaluate({1.0, 50.0, 51.0, 52.0, 53.0, 54.0, 9.0});
  ASSERT_EQ(found.failures.size(), 5U);
  EXPECT_THAT(found.failures[0].reason, HasSubstr("killed by signal 11"));
  EXPECT_THAT(found.failures[1].reason, HasSubstr("no end within 1.5 s"));
  EXPECT_THAT(found.failures[2].reason, HasSubstr("out:1: '****' is not a number"));
  EXPECT_THAT(found.failures[3].reason, HasSubstr("1 modes are there, 2 are needed"));
  EXPECT_THAT(found.failures[4].reason, HasSubstr("exit status 3"));
  EXPECT_TRUE(std::isnan(found.outputs(2, 0)));
  EXPECT_NEAR(found.outputs(6, 0), frequency(9.0, -1.0), 1e-6);
  int kept = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "results" / "failed-runs")) {
    EXPECT_THAT(mottle::read_file(entry.path() / "input"), HasSubstr("5")) << "the input is kept";
    EXPECT_TRUE(std::filesystem::exists(entry.path() / "solve.sh")) << "links lead to the user's files";
    const std::string name = entry.path().filename().string();
    kept += std::any_of(found.failures.begin(), found.failures.end(),
                        [&](const auto& failure) { return failure.reason.find(name) != std::string::npos; });
  }
  EXPECT_EQ(kept, 5);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "results" / "runs")) << "private folders go";
}

TEST_F(External, AFailedRunIsTriedAgainWithTheOtherCommand) {
  command_.retries = 2;
  command_.retry_command = mottle::drivers::CommandLine{.arguments = {"sh", "solve.sh", "again"}};
  const Evaluation found = evaluate({55.0, 54.0});
  ASSERT_EQ(found.failures.size(), 1U);
  EXPECT_THAT(found.failures[0].reason, HasSubstr("exit status 3 (3 tries, run "));
  EXPECT_NEAR(found.outputs(0, 0), frequency(55.0, -1.0), 1e-6);
  EXPECT_EQ(runs(), 1 + 2 + 3);
}

TEST_F(External, TooManyFailuresStopIt) {
  command_.max_failed_fraction = 0.25;
  std::vector<double> half;
  for (int i = 0; i < 30; ++i) half.push_back(i % 2 == 0 ? 54.0 + 0.001 * i : 1.0 + 0.1 * i);
  EXPECT_THAT([&] { evaluate(half); }, ThrowsMessage<SystemFailure>(HasSubstr("at most 25 % may")));
}

TEST_F(External, FinishedRunsAreNotRepeatedAndFailedOnesOnlyWithoutResume) {
  const Evaluation first = evaluate({1.0, 2.0, 54.0});
  EXPECT_EQ(runs(), 4) << "the means and three samples";
  const Evaluation resumed = evaluate({1.0, 2.0, 54.0}, true);
  EXPECT_EQ(runs(), 4);
  EXPECT_EQ(resumed.outputs.topRows(2), first.outputs.topRows(2));
  EXPECT_EQ(resumed.failures[0].reason, first.failures[0].reason);
  evaluate({2.0, 1.0, 54.0});
  EXPECT_EQ(runs(), 5) << "what failed may do so by chance";
}

TEST_F(External, ARunOfAnotherInputIsNeverUsed) {
  evaluate({1.0});
  const auto changes = [&](const char* what) {
    const auto before = runs();
    evaluate({1.0});
    EXPECT_EQ(runs(), before + 2) << what;
  };
  mottle::write_file_atomically(folder_ / "input.in", "{{k:%10.6f}} \n");
  changes("template");
  mottle::write_file_atomically(folder_ / "solve.sh", std::string(k_solver) + "\n");
  changes("file");
  command_.command.arguments.emplace_back("more");
  changes("command");
  command_.environment["MORE"] = "1";
  changes("environment");
  command_.frequencies.line = 2;
  command_.frequencies.after = "";
  EXPECT_THROW(evaluate({1.0}, false, {.frequencies = {1, 2}}), InvalidInput) << "one mode is left by that rule";
}

TEST_F(External, SeveralAtOnceGiveTheSame) {
  std::vector<double> k;
  for (int i = 0; i < 24; ++i) k.push_back(1.0 + 0.25 * i);
  const Evaluation one = evaluate(k);
  std::filesystem::remove_all(folder_ / "results");
  command_.parallel = 5;
  EXPECT_EQ(evaluate(k).outputs, one.outputs);
}

TEST_F(External, AFailureAtTheMeansSaysWhatTheSolverSaid) {
  command_.command = {.arguments = {"echo working; echo 'licence expired' >&2; exit 9"}, .is_shell = true};
  EXPECT_THAT([&] { make(); },
              ThrowsMessage<SystemFailure>(testing::AllOf(HasSubstr("exit status 9"), HasSubstr("licence expired"))));
}

TEST_F(External, FaultsOfTheStudyAreFoundBeforeAnythingRuns) {
  const auto refuse = [&](const std::string& part) {
    EXPECT_THAT([&] { make(); }, ThrowsMessage<InvalidInput>(HasSubstr(part)));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "log"));
  };
  mottle::write_file_atomically(folder_ / "input.in", "{{q}}\n");
  refuse("input.in:1: parameter 'q' is not known here");
  mottle::write_file_atomically(folder_ / "input.in", "nothing\n");
  refuse("parameter 'k': acts on nothing: {{k}} stands in no template");
  mottle::write_file_atomically(folder_ / "input.in", "{{k:%3.1e}}\n");
  refuse("input.in:1: k = 4 becomes '4.0e+00'");
  mottle::write_file_atomically(folder_ / "input.in", "{{k}}\n");
  command_.command.arguments = {"no-such-solver"};
  refuse("there is no program 'no-such-solver' on PATH");
  command_.files = {{folder_ / "lost.inc", "lost.inc"}};
  command_.command.arguments = {"sh", "solve.sh"};
  refuse("lost.inc: no such file");
}

TEST_F(External, AValueInTheCommandIsAPlaceToo) {
  command_.templates.clear();
  command_.command.arguments = {"sh", "-c", "echo $1 > input; sh solve.sh", "sh", "{{k:%.6f}}"};
  EXPECT_NEAR(evaluate({2.0}).outputs(0, 0), frequency(2.0, -1.0), 1e-6);
}

TEST_F(External, WithoutAFolderOfResultsNothingStays) {
  const ExternalSolver solver(command_, {"k"}, Eigen::VectorXd::Constant(1, 4.0), Eigen::VectorXd::Constant(1, 0.4), {},
                              nullptr);
  EXPECT_EQ(solver.structure().mode_count(), 2);
  EXPECT_TRUE(solver.notes().empty());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "results"));
}

TEST_F(External, CoarsePlacesAreNoted) {
  mottle::write_file_atomically(folder_ / "input.in", "{{k:%6.2f}}\n");
  const auto structure = make(false, 4.004);
  ASSERT_EQ(structure->notes().size(), 0U) << "a step of 0.02 is kept exactly";
  mottle::write_file_atomically(folder_ / "input.in", "{{k:%6.1f}}\n");
  ASSERT_EQ(make()->notes().size(), 1U);
  EXPECT_THAT(make()->notes()[0], HasSubstr("input.in:1: k as %6.1f has too few digits"));
}

}  // namespace
