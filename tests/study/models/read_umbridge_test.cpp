// [model] of kind "umbridge", where it is wrong.
#include <gtest/gtest.h>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

/// The study of three masses with a server in place of its model.
std::string umbridge_study() {
  const std::string& good = test::k_three_masses_study;
  std::string text = "[model]\nkind = \"umbridge\"\nurls = [\"http://127.0.0.1:4242\"]\n";
  for (const std::string& line : test::lines_of(good.substr(good.find("[[parameter]]")))) {
    if (line.find("target") == std::string::npos) text += line + "\n";
  }
  return text;
}

test::WrongStudy wrong_entry(const std::string& entry, std::vector<std::string> says) {
  return {.what = entry,
          .changes = {{"kind = \"umbridge\"\n", "kind = \"umbridge\"\n" + entry + "\n"}},
          .says = std::move(says),
          .at = entry};
}

test::WrongStudy wrong_urls(const std::string& urls, std::vector<std::string> says) {
  return {.what = urls, .changes = {{"[\"http://127.0.0.1:4242\"]", urls}}, .says = std::move(says), .at = "urls = "};
}

TEST(UmbridgeModel, RefusesServersThatAreNone) {
  test::expect_unread(umbridge_study(), {
                                            wrong_urls("[]", {"model.urls", "text in quotes or a list"}),
                                            wrong_urls("3", {"model.urls", "found 3"}),
                                            wrong_urls("[\"ftp://127.0.0.1\"]", {"model.urls", "ftp://127.0.0.1"}),
                                            wrong_urls("[\"http://a:1\", \"http://a:1\"]",
                                                       {"model.urls", "twice", "name each server once"}),
                                        });
}

TEST(UmbridgeModel, RefusesEntriesThatAreNone) {
  test::expect_unread(
      umbridge_study(),
      {
          wrong_entry("inputs = []", {"model.inputs", "parameters' names and numbers"}),
          wrong_entry("inputs = \"k1\"", {"model.inputs", "parameters' names and numbers"}),
          wrong_entry("inputs = [[\"k1\"], \"k2\"]", {"model.inputs", "a list of such lists"}),
          wrong_entry("inputs = [\"k1\", true]", {"model.inputs", "neither a parameter's name nor a number"}),
          wrong_entry("inputs = [\"k1\", nan]", {"model.inputs", "nan", "neither"}),
          wrong_entry("config = 3", {"model.config", "found 3", "a table"}),
          wrong_entry("config = { level = inf }", {"model.config", "inf", "cannot be said in JSON"}),
          wrong_entry("config = { day = 2026-11-28 }", {"model.config", "2026-11-28", "no dates"}),
          wrong_entry("output = -1", {"model.output", "-1", ">= 0"}),
          wrong_entry("quantity = \"rpm\"", {"model.quantity", "rpm", "\"Hz\" | \"rad/s\" | \"eigenvalue\""}),
          wrong_entry("derivatives = 1", {"model.derivatives", "found 1", "true or false"}),
          wrong_entry("timeout = \"soon\"", {"model.timeout", "soon", "a time > 0"}),
          wrong_entry("retries = 101", {"model.retries", "101", "<= 100"}),
          wrong_entry("parallel = 0", {"model.parallel", "found 0", ">= 1"}),
          wrong_entry("largest_failed_part = -1", {"model.largest_failed_part", "-1", ">= 0"}),
          wrong_entry("difference_step = 2", {"model.difference_step", "found 2", "<= 1"}),
          wrong_entry("url = \"http://a:1\"", {"model.url", "did you mean 'urls'"}),
      });
}

}  // namespace
}  // namespace mottle::study
