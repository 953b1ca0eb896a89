// Tables of wrong inputs of a study and of what their messages hold.
#pragma once

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "mottle/core/utf8.hpp"
#include "support/study_folder.hpp"

namespace mottle::test {

/// One wrong input.
struct WrongStudy {
  std::string what;
  std::vector<TextChange> changes = {};  ///< of the good study
  std::vector<std::string> says = {};    ///< parts of the message
  std::string at = {};                   ///< text on the line of the study that the message names; empty: not looked at
  std::string tests = k_three_masses_tests;
};

/// A message is one line for a person and holds its parts.
inline void expect_message(const std::string& message, const std::vector<std::string>& says) {
  EXPECT_LT(message.size(), 600U) << message;
  EXPECT_EQ(message, printable(message));
  for (const std::string& part : says) EXPECT_THAT(message, testing::HasSubstr(part));
}

/// Each is refused with its message by `check` and `update` alike, and leaves no files.
inline void expect_refused(const std::vector<WrongStudy>& table) {
  const StudyFolder folder;
  const std::vector<std::string> files = folder.files();
  for (const WrongStudy& wrong : table) {
    SCOPED_TRACE(wrong.what);
    const std::string text = three_masses(wrong.changes);
    folder.write("study.toml", text);
    folder.write("tests.csv", wrong.tests);
    const std::string message = folder.refusal();
    expect_message(message, wrong.says);
    if (!wrong.at.empty()) {
      EXPECT_THAT(message, testing::StartsWith(fmt::format("study.toml:{}: ", line_of(text, wrong.at))));
    }
    EXPECT_EQ(folder.files(), files);
  }
}

/// Each change of a good text is refused by the reader alone; tests and files of the model are not looked at.
inline void expect_unread(const std::string& good, const std::vector<WrongStudy>& table) {
  EXPECT_NO_THROW((void)study::read_study_text(good, "study.toml"));
  for (const WrongStudy& wrong : table) {
    SCOPED_TRACE(wrong.what);
    const std::string text = edited(good, wrong.changes);
    const std::string message = message_of<InvalidInput>([&] { (void)study::read_study_text(text, "study.toml"); });
    expect_message(message, wrong.says);
    if (!wrong.at.empty()) {
      EXPECT_THAT(message, testing::StartsWith(fmt::format("study.toml:{}: ", line_of(text, wrong.at))));
    }
  }
}

}  // namespace mottle::test
