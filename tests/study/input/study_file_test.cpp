// Studies that cannot be read as text or as TOML.
#include <gtest/gtest.h>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::expect_message;
using test::expect_refused;
using test::message_of;
using test::StudyFolder;

std::string repeated(std::string_view text, int times) {
  std::string result;
  for (int i = 0; i < times; ++i) result += text;
  return result;
}

/// Why a file with these bytes is no study.
std::string refusal_of(const std::string& bytes) {
  const StudyFolder folder;
  folder.write("study.toml", bytes);
  return folder.without_path(message_of<InvalidInput>([&] { (void)folder.study(); }));
}

/// The good study with another first line.
std::string begun_with(const std::string& line) {
  return line + test::k_three_masses_study.substr(test::k_three_masses_study.find('\n'));
}

TEST(StudyFile, IsRefusedWithTheLineThatIsNoToml) {
  expect_refused({
      {"not TOML", {{"[outputs]", "[outputs"}}, {"not valid TOML"}, "[outputs"},
      {"a key twice", {{"seed = 7", "seed = 7\nseed = 8"}}, {"not valid TOML", "seed"}, "seed = 8"},
      {"a number beyond 64 bits", {{"samples = 200", "samples = 99999999999999999999"}}, {"TOML"}, "samples = "},
      {"a key of 60,000 parts",
       {{"[test]", "[a" + repeated(".a", 59999) + "]\n[test]"}},
       {"key of more than 1000 parts"}},
  });
  expect_message(refusal_of(""), {"study.toml", "model", "missing"});
  expect_message(refusal_of("a" + repeated(".a", 20000) + " = 1\n" + test::k_three_masses_study), {"study.toml"});
}

TEST(StudyFile, MayBeNestedAsDeepAsItLikesAndIsRefused) {
  expect_message(refusal_of("a = " + repeated("[", 100000)), {"study.toml:1: ", "not valid TOML", "nest"});
  expect_message(refusal_of("a = " + repeated("{b=", 100000)), {"study.toml:1: ", "TOML"});
}

TEST(StudyFile, IsRefusedWithTheByteThatIsNoText) {
  expect_message(refusal_of(begun_with("title = \"caf\xe9\"")), {"study.toml:1: ", "0xE9", "UTF-8"});
  std::string junk;
  for (int byte = 0; byte < 256; ++byte) junk += static_cast<char>(byte);
  expect_message(refusal_of(repeated(junk, 16)), {"study.toml:1: ", "0x00", "plain text"});
}

TEST(StudyFile, IsNamedWhereItIsNone) {
  const StudyFolder folder;
  const auto refusal = [&](const std::string& file) {
    return folder.without_path(message_of<InvalidInput>([&] { (void)folder.study({.study = file}); }));
  };
  expect_message(refusal("nothing.toml"), {"nothing.toml", "no such file"});
  expect_message(refusal("."), {"folder", "file is needed"});
  expect_message(refusal("tests.csv/study.toml"), {"tests.csv/study.toml", "no such file"});
  expect_message(refusal("tests.csv"), {"tests.csv:1: ", "not valid TOML"});
  expect_message(message_of<InvalidInput>([] { (void)read_study("/dev/zero"); }), {"/dev/zero", "regular file"});
  expect_message(message_of<SystemFailure>([] { (void)read_study("/proc/self/mem"); }),
                 {"/proc/self/mem", "reading failed"});
}

}  // namespace
}  // namespace mottle::study
