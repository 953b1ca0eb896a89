#include "study/results/could_hide_json.hpp"

namespace mottle::study {
namespace {

Json error_json(const NamedError& error, const std::vector<std::string>& parameters, bool is_level_known) {
  Json moves = Json::array();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    moves.push_back({{"parameter", parameters[i]},
                     {"half_widths", number_json(error.error.would_move(static_cast<Eigen::Index>(i)))},
                     {"prior_deviations", number_json(error.error.prior_deviations(static_cast<Eigen::Index>(i)))}});
  }
  return {{"name", error.name},
          {"nominal", error.nominal},
          {"relative_change", error.nominal == 0.0 ? Json(nullptr) : number_json(error.error.relative_change)},
          {"change", number_json(error.change())},
          {"is_detected", error.error.is_detected},
          {"assumes_estimated_noise", error.error.is_detected && !is_level_known},
          {"is_beyond_first_order", error.error.is_beyond_first_order()},
          {"would_move", moves}};
}

}  // namespace

Json could_hide_json(const CouldHide& hidden, const std::vector<std::string>& parameters) {
  Json list = Json::array();
  for (const NamedError& error : hidden.errors) list.push_back(error_json(error, parameters, hidden.is_level_known));
  return list;
}

}  // namespace mottle::study
