#include "report/page.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

namespace mottle::report {
namespace {

using nlohmann::json;

constexpr std::string_view k_data_start = R"(<script type="application/json" id="mottle-data">)";

/// What a browser takes as the content of the data element: everything up to the next end tag of a script.
std::string data_as_browser_sees_it(const std::string& html) {
  const std::size_t start = html.find(k_data_start) + k_data_start.size();
  return html.substr(start, html.find("</script", start) - start);
}

std::size_t occurrences(const std::string& text, std::string_view part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

TEST(Page, IsOneCompleteHtmlDocument) {
  const std::string html = render_page("{}");
  EXPECT_EQ(html.rfind("<!doctype html>", 0), 0U);
  EXPECT_NE(html.find("</html>"), std::string::npos);
  EXPECT_EQ(occurrences(html, k_data_start), 1U);
}

TEST(Page, HoldsTheDataWhereThePlaceWas) {
  const std::string html = render_page(R"({"result":{"title":"Three masses"}})");
  EXPECT_EQ(html.find("MOTTLE_DATA"), std::string::npos);
  EXPECT_EQ(json::parse(data_as_browser_sees_it(html))["result"]["title"], "Three masses");
}

TEST(Page, KeepsATitleThatLooksLikeMarkupInsideTheData) {
  for (const std::string title :
       {"</script><b>x", "<!-- <script>", "</SCRIPT >", "a < b", "/*MOTTLE_DATA*/", "$& \\"}) {
    const std::string html = render_page(json{{"result", {{"title", title}}}}.dump());
    EXPECT_EQ(json::parse(data_as_browser_sees_it(html))["result"]["title"], title);
    EXPECT_EQ(occurrences(html, "</script>"), occurrences(render_page("{}"), "</script>"));
  }
}

TEST(Page, AsksForNothingFromTheNetwork) {
  const std::string html = render_page("{}");
  EXPECT_EQ(occurrences(html, "default-src 'none'"), 1U);
  for (const std::string_view loader : {"<script src", "<link", "<iframe", "@import", "@font-face", "url(http"}) {
    EXPECT_EQ(occurrences(html, loader), 0U) << loader;
  }
}

}  // namespace
}  // namespace mottle::report
