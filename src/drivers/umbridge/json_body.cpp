#include "drivers/umbridge/json_body.hpp"

namespace mottle::drivers {

std::optional<nlohmann::json> parse_body(std::string_view body) {
  constexpr int k_deepest = 64;
  struct TooDeep {};
  const auto look = [](int depth, nlohmann::json::parse_event_t, const nlohmann::json&) {
    if (depth > k_deepest) throw TooDeep();
    return true;
  };
  try {
    return nlohmann::json::parse(body, look);
  } catch (const TooDeep&) {
    return std::nullopt;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

}  // namespace mottle::drivers
