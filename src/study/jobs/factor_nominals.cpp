#include "study/jobs/factor_nominals.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "mottle/study/models/model_source.hpp"

namespace mottle::study {
namespace {

std::optional<FactorNominal> nominal_of(const ModelSource& model, const std::vector<ModelNumber>& numbers,
                                        const StudyParameter& parameter, const UnitNames& units) {
  std::set<std::pair<double, std::string>> found;
  for (const std::string& target : parameter.targets) {
    const auto number = std::ranges::find(numbers, model.target_key(target), &ModelNumber::target);
    if (number == numbers.end() || !number->is_single) return std::nullopt;
    found.emplace(number->value, model.target_unit(target, units));
  }
  if (found.size() != 1 || found.begin()->second.empty()) return std::nullopt;
  return FactorNominal{found.begin()->first, found.begin()->second};
}

}  // namespace

std::vector<std::optional<FactorNominal>> factor_nominals(const Study& study) {
  const std::vector<StudyParameter>& parameters = study.parameters.list;
  std::vector<std::optional<FactorNominal>> nominals(parameters.size());
  if (std::ranges::none_of(parameters, &StudyParameter::is_factor)) return nominals;
  const std::vector<ModelNumber> numbers = study.model->numbers();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].is_factor)
      nominals[i] = nominal_of(*study.model, numbers, parameters[i], unit_names(study.units));
  }
  return nominals;
}

}  // namespace mottle::study
