#include "formats/nastran/lists.hpp"

#include <algorithm>

namespace mottle::formats::nastran {
namespace {

constexpr std::int64_t k_max_listed_points = 200'000'000;

/// Nodes first..last (indices, last excluded) of the range that starts at field n.
std::pair<int, int> range_at(const ModelBuilder& builder, const Card& card, int n) {
  const int low = card.id(n, "the start of a range");
  const int high = card.id(n + 2, "the end of a THRU range");
  if (high < low) card.fail(fmt::format("{} THRU {}: the range runs backwards", low, high));
  const auto& ids = builder.node_ids;
  const auto begin = std::lower_bound(ids.begin(), ids.end(), low);
  const auto end = std::upper_bound(begin, ids.end(), high);
  if (begin == end) card.fail(fmt::format("{} THRU {}: no point in that range exists", low, high));
  return {static_cast<int>(begin - ids.begin()), static_cast<int>(end - ids.begin())};
}

}  // namespace

void for_each_listed_node(ModelBuilder& builder, const Card& card, int first, int last,
                          const std::function<void(int)>& use) {
  for (int n = first; n <= last; ++n) {
    if (card.is_blank(n)) continue;
    if (n + 1 > last || card.at(n + 1) != "THRU") {
      use(builder.node(card, n, "G"));
      continue;
    }
    const auto [begin, end] = range_at(builder, card, n);
    builder.listed_points += end - begin;
    if (builder.listed_points > k_max_listed_points) {
      card.fail(fmt::format("THRU ranges name more than {} points in all", k_max_listed_points));
    }
    for (int node = begin; node < end; ++node) use(node);
    n += 2;
    if (n + 1 <= last && card.at(n + 1) == "BY") card.fail("BY in a THRU range is not supported; list the points");
  }
}

}  // namespace mottle::formats::nastran
