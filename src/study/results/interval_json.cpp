#include "study/results/interval_json.hpp"

#include <algorithm>

#include "mottle/core/text.hpp"

namespace mottle::study {
namespace {

Json ends_json(double lower, double upper) {
  return Json::array({number_json(lower), number_json(upper)});
}

Json box_json(const ParameterBox& box) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < box.lower.size(); ++i) list.push_back(ends_json(box.lower(i), box.upper(i)));
  return list;
}

Json image_json(const UpdatingProblem& problem, const IntervalResult& interval) {
  Json list = Json::array();
  for (std::size_t k = 0; k < interval.image.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const OutputRange& range = interval.image[k];
    list.push_back({{"output", problem.model.outputs()[k].name()},
                    {"observed", to_json(interval.tests.observed.row(row).transpose())},
                    {"bounds", to_json(interval.tests.limits.row(row).transpose())},
                    {"asked", to_json(interval.asked.row(row).transpose())},
                    {"specimens", interval.tests.count(row)},
                    {"factor", number_json(interval.tests.factor(row))},
                    {"content", number_json(interval.tests.content(row))},
                    {"confidence", number_json(interval.tests.confidence(row))},
                    {"expected_between_observed", number_json(interval.tests.expected_inside(row))},
                    {"image", ends_json(range.lower, range.upper)},
                    {"proven", ends_json(range.proven_lower, range.proven_upper)},
                    {"certified", range.is_certified},
                    {"at_lower", to_json(range.at_lower)},
                    {"at_upper", to_json(range.at_upper)},
                    {"excess", to_json(interval.excess.row(row).transpose())},
                    {"covered", interval.excess.row(row).minCoeff() >= 0.0}});
  }
  return list;
}

}  // namespace

void add_interval(const UpdatingProblem& problem, const IntervalResult* interval, Json& result) {
  result["interval"] = nullptr;
  result["parameters"]["box"] = nullptr;
  if (interval == nullptr) return;
  result["parameters"]["box"] = box_json(interval->box);
  result["interval"] = {{"image", image_json(problem, *interval)},
                        {"certified", std::ranges::all_of(interval->image, &OutputRange::is_certified)},
                        {"covered", interval->excess.minCoeff() >= 0.0},
                        {"measure", number_json(interval->measure)},
                        {"trends", interval->trends},
                        {"obstacle", interval->obstacle.empty() ? Json(nullptr) : Json(interval->obstacle)},
                        {"hull", box_json(interval->hull)},
                        {"outside", interval->outside},
                        {"undetermined", interval->undetermined}};
}

std::vector<std::string> interval_sentences(const UpdatingProblem& problem, const IntervalResult& interval) {
  std::vector<std::string> proven;
  double widest = 0.0;
  std::string widest_name;
  for (std::size_t k = 0; k < interval.image.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const OutputRange& range = interval.image[k];
    const std::string name = problem.model.outputs()[k].name();
    if (range.is_certified) proven.push_back(name);
    const double asked = interval.tests.limits(row, 1) - interval.tests.limits(row, 0);
    if (!(asked > 0.0) || (range.upper - range.lower) / asked <= widest) continue;
    widest = (range.upper - range.lower) / asked;
    widest_name = name;
  }
  std::vector<std::string> sentences;
  if (!widest_name.empty()) {
    sentences.push_back(fmt::format(
        "The image of the box is at most {:.3g} times as wide as the bounds to be covered ({}).", widest, widest_name));
  }
  sentences.push_back(
      proven.size() == interval.image.size() ? "That no parameters in the box give outputs beyond the image is proven."
      : proven.empty()                       ? "The image was searched for and is not proven."
                       : "The image is proven for " + join(proven) + ", and searched for of the others.");
  return sentences;
}

}  // namespace mottle::study
