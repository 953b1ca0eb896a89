// Ranks exchange what they have, once it is certain that they compute the same.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mottle/core/ranks.hpp"

namespace mottle {

/// A digest that all ranks are to have alike, and of what it is.
struct AlikeDigest {
  Digest digest = {};
  const char* what = nullptr;
};

/// What each rank gives, by rank, once all have the same digests; else as require_same_digests(). All ranks call it.
std::vector<std::string> gather_alike(Ranks& ranks, const std::vector<AlikeDigest>& digests,
                                      std::string_view bytes = {});

}  // namespace mottle
