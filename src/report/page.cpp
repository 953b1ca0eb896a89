#include "report/page.hpp"

#include <algorithm>
#include <cassert>

#include "mottle_page.hpp"

namespace mottle::report {

std::string render_page(std::string_view data_json) {
  constexpr std::string_view k_placeholder = "/*MOTTLE_DATA*/";
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

}  // namespace mottle::report
