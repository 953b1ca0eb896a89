// [model] of kind "command", where it is wrong: the command line, its files, and where the modes stand.
#include <gtest/gtest.h>

#include "support/study_commands.hpp"
#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

TEST(CommandModel, RefusesPatternsThatAreNone) {
  std::string endless;
  for (int i = 0; i < 2000; ++i) endless += "(a{1000}){1000}";
  struct WrongPattern {
    std::string pattern;  ///< as in the study
    std::vector<std::string> says;
  };
  const test::StudyFolder folder;
  for (const auto& [pattern, says] : std::vector<WrongPattern>{
           {R"("f = (+")", {"no regular expression", "+"}},
           {R"('(a)\1')", {"no regular expression", R"(\1)"}},
           {"'(?=a)(b)'", {"no regular expression", "(?="}},
           {R"("f = .*")", {"no group", "parentheses"}},
           {"'" + endless + "'", {"no regular expression"}},
       }) {
    SCOPED_TRACE(pattern.substr(0, 80));
    const std::string text = test::edited(test::command_study({"true"}),
                                          {{"format = \"column\"", "format = \"regex\"\npattern = " + pattern}});
    folder.write("study.toml", text);
    const std::string message = folder.without_path(test::message_of<InvalidInput>([&] { (void)folder.study(); }));
    test::expect_message(message, says);
    EXPECT_THAT(message, testing::StartsWith(fmt::format("study.toml:{}: ", test::line_of(text, "pattern = "))));
  }
}

/// A further entry of [model], and what is said of it.
test::WrongStudy wrong_entry(const std::string& entry, std::vector<std::string> says) {
  return {.what = entry,
          .changes = {{"retries = 0\n", "retries = 0\n" + entry + "\n"}},
          .says = std::move(says),
          .at = entry.substr(0, entry.find('\n'))};
}

/// Other text in place of one; the message names its last line.
test::WrongStudy wrong_in_place(const std::string& found, const std::string& put, std::vector<std::string> says) {
  return {.what = put, .changes = {{found, put}}, .says = std::move(says), .at = test::lines_of(put).back()};
}

TEST(CommandModel, RefusesCommandsAndFilesThatAreNone) {
  test::expect_unread(
      test::command_study({"true"}),
      {
          wrong_in_place("command = [\"true\"]", "command = []", {"model.command", "text in quotes or a list"}),
          wrong_in_place("command = [\"true\"]", "command = \"\"", {"model.command", "a program and its arguments"}),
          wrong_in_place("files = [\"solver.py\"]", "files = [\"a/x.py\", \"../x.py\", \"../b/x.py\"]",
                         {"model.files", "two files would be called 'x.py'"}),
          wrong_in_place("templates = [\"input.txt\"]", "templates = [\"stdout.txt.in\"]",
                         {"model.templates", "two files would be called 'stdout.txt'"}),
          wrong_in_place("retries = 0", "retries = -1", {"model.retries", "-1", ">= 0"}),
          wrong_entry("retry_command = [\"again\"]", {"model.retry_command", "is never used with retries = 0"}),
          wrong_entry("timeout = \"soon\"", {"model.timeout", "soon", "\"30 s\", \"10 min\" or \"2 h\""}),
          wrong_entry("timeout = \"3 days\"", {"model.timeout", "3 days", "a time > 0"}),
          wrong_entry("timeout = 0", {"model.timeout", "found 0", "a time > 0"}),
          wrong_entry("parallel = 0", {"model.parallel", "found 0", ">= 1"}),
          wrong_entry("keep = \"some\"", {"model.keep", "some", "\"failed\" | \"none\" | \"all\""}),
          wrong_entry("largest_failed_part = 1.5", {"model.largest_failed_part", "1.5", "<= 1"}),
          wrong_entry("difference_step = 0", {"model.difference_step", "found 0", ">= 1e-06"}),
          wrong_entry("environment = { OMP = 3 }", {"model.environment.OMP", "found 3", "text"}),
          wrong_entry("launch = \"slrum\"", {"model.launch", "slrum", "did you mean \"slurm\""}),
          wrong_entry("scheduler = { cores = 2 }", {"model.scheduler", "is for model.launch = \"slurm\""}),
          wrong_entry("timeuot = 3", {"model.timeuot", "did you mean 'timeout'"}),
      });
}

TEST(CommandModel, RefusesOptionsOfASchedulerThatAreNone) {
  const auto wrong = [](const std::string& options, std::vector<std::string> says) {
    test::WrongStudy entry = wrong_entry("launch = \"slurm\"\nscheduler = { " + options + " }", std::move(says));
    entry.at = "scheduler = ";
    return entry;
  };
  test::expect_unread(test::command_study({"true"}),
                      {
                          wrong("cores = 0", {"model.scheduler.cores", "found 0", ">= 1"}),
                          wrong("tries = 0", {"model.scheduler.tries", "found 0", ">= 1"}),
                          wrong("runs_at_once = -1", {"model.scheduler.runs_at_once", "-1", ">= 0"}),
                          wrong("time = \"long\"", {"model.scheduler.time", "long", "a time > 0"}),
                          wrong("licences = \"ansys:few\"", {"model.scheduler.licences", "\"ansys:1\""}),
                          wrong("licences = \":2\"", {"model.scheduler.licences", "\"ansys:1\""}),
                          wrong("partition = \"a\\nb\"", {"model.scheduler.partition", "holds a line break"}),
                          wrong("extra = [\"--array=1-3\"]", {"model.scheduler.extra", "arrays of jobs are Mottle's"}),
                          wrong("extra = [\"--job-name=x\"]", {"model.scheduler.extra", "names and arrays"}),
                          wrong("core = 1", {"model.scheduler.core", "did you mean 'cores'"}),
                      });
  test::expect_unread(test::command_study({"true"}),
                      {{"runs of this machine",
                        {{"retries = 0\n", "retries = 0\nlaunch = \"pbs\"\nparallel = 2\n"}},
                        {"model.parallel", "say scheduler.runs_at_once in its place"},
                        "parallel = 2"}});
}

TEST(CommandModel, RefusesOutputFilesThatARunDoesNotLeave) {
  const std::string format = "format = \"column\"";
  test::expect_unread(
      test::command_study({"true"}),
      {
          wrong_in_place("file = \"f.txt\"", "file = \"../f.txt\"",
                         {"model.frequencies.file", "that each run leaves in its own folder"}),
          wrong_in_place("file = \"f.txt\"", "file = \"/f.txt\"", {"model.frequencies.file", "in its own folder"}),
          wrong_in_place(format, "format = \"colum\"", {"model.frequencies.format", "did you mean \"column\""}),
          wrong_in_place(format, format + "\nline = 0", {"model.frequencies.line", "found 0", ">= 1"}),
          wrong_in_place(format, format + "\nquantity = \"rpm\"", {"model.frequencies.quantity", "\"rad/s\""}),
          {"a table without its column",
           {{format, "format = \"csv\""}},
           {"model.frequencies.column", "missing"},
           "[model.frequencies]"},
          {"no pattern",
           {{format, "format = \"regex\""}},
           {"model.frequencies.pattern", "missing"},
           "[model.frequencies]"},
          wrong_in_place(format, "format = \"f06\"\nquantity = \"Hz\"", {"model.frequencies.quantity", "not known"}),
          wrong_in_place(format, format + "\npattern = \"f\"", {"model.frequencies.pattern", "not known here"}),
          {"no text before a table",
           {{format, format + "\n[model.shapes]\nfile = \"s.txt\"\nformat = \"column\""}},
           {"model.shapes.after", "missing"},
           "[model.shapes]"},
          wrong_in_place(format, format + "\n[model.shapes]\nfile = \"s.txt\"\nformat = \"json\"",
                         {"model.shapes.format", "json", "\"csv\""}),
          {"no rule",
           {{"[model.frequencies]\nfile = \"f.txt\"\n" + format + "\n", ""}},
           {"model.frequencies", "missing"}},
          wrong_in_place("frequencies = [1, 2, 3]", "frequencies = [1, 2, 3]\ntracking = \"mac\"",
                         {"outputs.tracking", "say in [model.shapes] where they stand"}),
      });
}

}  // namespace
}  // namespace mottle::study
