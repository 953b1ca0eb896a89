#include "report/page.hpp"

#include <algorithm>
#include <cassert>

#include "mottle/core/files.hpp"
#include "mottle_page.hpp"

namespace mottle::report {

namespace {

/// Where the data goes.
constexpr std::string_view k_placeholder = "/*MOTTLE_DATA*/";

}  // namespace

std::string render_page(std::string_view data_json) {
  constexpr std::string_view k_escaped_less_than = "\\u003c";
  const std::string_view page = detail::mottle_page_template();
  const std::size_t position = page.find(k_placeholder);
  assert(position != std::string_view::npos);

  const auto less_thans = static_cast<std::size_t>(std::count(data_json.begin(), data_json.end(), '<'));
  std::string html;
  html.reserve(page.size() + data_json.size() + less_thans * k_escaped_less_than.size());
  html += page.substr(0, position);
  for (const char c : data_json) {
    if (c == '<') {
      html += k_escaped_less_than;
    } else {
      html += c;
    }
  }
  html += page.substr(position + k_placeholder.size());
  return html;
}

bool is_page_of(const std::filesystem::path& file, const std::string& kind) {
  const std::string_view page = detail::mottle_page_template();
  const std::string_view before = page.substr(0, page.find(k_placeholder));
  const std::string start = std::string(before.substr(before.rfind('<'))) + "{\"kind\":\"" + kind + '"';
  std::error_code ignored;
  return std::filesystem::is_regular_file(file, ignored) && read_file(file).find(start) != std::string::npos;
}

}  // namespace mottle::report
