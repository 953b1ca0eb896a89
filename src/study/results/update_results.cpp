#include "study/results/update_results.hpp"

#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/study/input/text_file.hpp"

namespace mottle::study {

Json read_update_result(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "result.json";
  require(std::filesystem::is_regular_file(file), "{}: holds no result.json; name the folder of an update's results",
          folder.string());
  const std::string bytes = read_text_file(file);
  Json result = nests_deeper_than(bytes, k_deepest_json) ? Json() : Json::parse(bytes, nullptr, false);
  const bool is_update = result.is_object() && result.contains("command") && result["command"] == "update" &&
                         result.contains("parameters") && result.contains("outputs");
  require(is_update, "{}: is no result of an update", file.string());
  return result;
}

Eigen::VectorXd numbers_of(const Json& list) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(list.size()));
  for (std::size_t i = 0; i < list.size(); ++i) {
    values(static_cast<Eigen::Index>(i)) = list[i].is_number() ? list[i].get<double>() : std::nan("");
  }
  return values;
}

}  // namespace mottle::study
