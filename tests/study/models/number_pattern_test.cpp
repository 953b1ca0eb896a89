// Patterns of a model by command that find no number in what its program wrote.
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

}  // namespace
}  // namespace mottle::study
