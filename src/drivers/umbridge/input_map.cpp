#include "drivers/umbridge/input_map.hpp"

#include <algorithm>
#include <numeric>

#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"

namespace mottle::drivers {
namespace {

std::string sizes_text(const std::vector<std::size_t>& sizes) {
  return fmt::format("[{}]", fmt::join(sizes, ", "));
}

/// The parameters in their order over the model's input vectors.
std::vector<std::vector<InputEntry>> in_order(const std::vector<std::size_t>& sizes,
                                              const std::vector<std::string>& names) {
  const std::size_t sum = std::accumulate(sizes.begin(), sizes.end(), std::size_t{0});
  require_fit(sum == names.size(), "inputs",
              "is missing; the model's inputs have the sizes {}, {} numbers in all, and there are {} parameters; say "
              "which number is what, like inputs = [[\"{}\", 1.0]]",
              sizes_text(sizes), sum, names.size(), names.front());
  std::vector<std::vector<InputEntry>> entries;
  auto next = names.begin();
  for (const std::size_t size : sizes) {
    entries.emplace_back();
    for (std::size_t i = 0; i < size; ++i) entries.back().push_back({.parameter = *next++});
  }
  return entries;
}

}  // namespace

InputMap::InputMap(std::vector<std::vector<InputEntry>> entries, const std::vector<std::size_t>& sizes,
                   const std::vector<std::string>& names) {
  if (entries.empty()) entries = in_order(sizes, names);
  std::vector<std::size_t> given;
  for (const std::vector<InputEntry>& vector : entries) given.push_back(vector.size());
  require_fit(given == sizes, "inputs", "has the sizes {}, the model's inputs have {}", sizes_text(given),
              sizes_text(sizes));
  std::vector<bool> is_used(names.size());
  for (const std::vector<InputEntry>& vector : entries) {
    parameter_at_.emplace_back();
    constants_.emplace_back();
    for (const InputEntry& entry : vector) {
      const auto found = std::find(names.begin(), names.end(), entry.parameter);
      if (!entry.parameter.empty() && found == names.end()) {
        throw UmbridgeFault("inputs", unknown_name_message("parameter", entry.parameter, names));
      }
      const Eigen::Index index = entry.parameter.empty() ? -1 : std::distance(names.begin(), found);
      if (index >= 0) is_used[static_cast<std::size_t>(index)] = true;
      parameter_at_.back().push_back(index);
      constants_.back().push_back(entry.constant);
    }
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    require_of(is_used[i], subject_parameter(names[i]), "acts on nothing: it is not in model.inputs");
  }
}

std::vector<std::vector<double>> InputMap::input_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  std::vector<std::vector<double>> input = constants_;
  for (std::size_t v = 0; v < input.size(); ++v) {
    for (std::size_t i = 0; i < input[v].size(); ++i) {
      if (parameter_at_[v][i] >= 0) input[v][i] = parameters(parameter_at_[v][i]);
    }
  }
  return input;
}

bool InputMap::acts(Eigen::Index parameter, std::size_t vector) const {
  const std::vector<Eigen::Index>& here = parameter_at_[vector];
  return std::find(here.begin(), here.end(), parameter) != here.end();
}

bool InputMap::moves(std::size_t vector) const {
  const std::vector<Eigen::Index>& here = parameter_at_[vector];
  return std::any_of(here.begin(), here.end(), [](Eigen::Index parameter) { return parameter >= 0; });
}

std::vector<double> InputMap::direction(Eigen::Index parameter, std::size_t vector) const {
  std::vector<double> direction;
  for (const Eigen::Index here : parameter_at_[vector]) direction.push_back(here == parameter ? 1.0 : 0.0);
  return direction;
}

void InputMap::add_gradient(const std::vector<double>& gradient, std::size_t vector,
                            Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>> row) const {
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    if (parameter_at_[vector][i] >= 0) row(parameter_at_[vector][i]) += gradient[i];
  }
}

}  // namespace mottle::drivers
