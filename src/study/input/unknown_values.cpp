#include "study/input/unknown_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"

namespace mottle::study {
namespace {

using LineAndKey = std::pair<int, std::string>;

void find_unknown(const toml::node& node, const std::string& key, std::vector<LineAndKey>& found) {
  const bool is_name = key == "title" || key.ends_with(".name");
  if (!is_name && node.value_exact<std::string>() == "UNKNOWN")
    found.emplace_back(static_cast<int>(node.source().begin.line), key);
  if (const toml::array* list = node.as_array()) {
    for (std::size_t i = 0; i < list->size(); ++i) find_unknown(list->at(i), fmt::format("{}[{}]", key, i), found);
  }
  if (const toml::table* table = node.as_table()) {
    for (const auto& [name, inner] : *table) find_unknown(inner, fmt::format("{}.{}", key, name.str()), found);
  }
}

}  // namespace

void refuse_unknown_values(const toml::table& root, const std::filesystem::path& file) {
  std::vector<LineAndKey> found;
  for (const auto& [name, node] : root) find_unknown(node, std::string(name.str()), found);
  if (found.empty()) return;
  std::sort(found.begin(), found.end());
  std::vector<std::string> others;
  for (std::size_t i = 1; i < found.size(); ++i) {
    others.push_back(fmt::format("{} (line {})", found[i].second, found[i].first));
  }
  const std::string also = others.empty() ? "" : fmt::format("; others: {}", join(others));
  throw FormatError(file.string(), found.front().first,
                    fmt::format("{} still says UNKNOWN; write the value{}", found.front().second, also));
}

}  // namespace mottle::study
