#include "study/jobs/further_outputs.hpp"

#include <algorithm>

#include "mottle/core/text.hpp"
#include "mottle/study/models/model_source.hpp"

namespace mottle::study {
namespace {

constexpr int k_modes_above = 3;
constexpr int k_max_frequencies = 4;
constexpr std::size_t k_max_shapes = 4;

bool holds(const std::vector<int>& list, int value) {
  return std::find(list.begin(), list.end(), value) != list.end();
}

std::vector<int> used_modes(const OutputSelection& outputs) {
  std::vector<int> modes = outputs.frequencies;
  modes.insert(modes.end(), outputs.shape_modes.begin(), outputs.shape_modes.end());
  std::sort(modes.begin(), modes.end());
  modes.erase(std::unique(modes.begin(), modes.end()), modes.end());
  return modes;
}

std::vector<int> further_frequencies(const OutputSelection& outputs, Eigen::Index mode_count) {
  const std::vector<int> used = used_modes(outputs);
  const int highest = used.empty() ? 0 : used.back();
  std::vector<int> modes;
  // Those above come first: a mode below that nobody uses is seldom measured well.
  for (int mode = highest + 1; mode <= highest + k_modes_above && mode <= mode_count; ++mode) modes.push_back(mode);
  for (int mode = highest; mode >= 1 && modes.size() < k_max_frequencies; --mode) {
    if (!holds(outputs.frequencies, mode)) modes.push_back(mode);
  }
  std::sort(modes.begin(), modes.end());
  return modes;
}

std::vector<int> further_shapes(const OutputSelection& outputs) {
  std::vector<int> modes;
  for (const int mode : used_modes(outputs)) {
    if (!holds(outputs.shape_modes, mode) && modes.size() < k_max_shapes) modes.push_back(mode);
  }
  return modes;
}

std::vector<std::string> shape_locations(const Study& study) {
  if (!study.outputs.shape_degrees_of_freedom.empty()) return study.outputs.shape_degrees_of_freedom;
  return study.model->shape_locations();
}

}  // namespace

std::vector<FurtherOutputs> further_outputs(const Study& study, Eigen::Index mode_count) {
  std::vector<FurtherOutputs> further;
  for (const int mode : further_frequencies(study.outputs, mode_count)) {
    const std::string name = natural_frequency(mode, "").name();
    further.push_back({name, {name}, false});
  }
  const std::vector<std::string> locations = shape_locations(study);
  if (locations.empty()) return further;
  for (const int mode : further_shapes(study.outputs)) {
    FurtherOutputs shape{fmt::format("the shape of mode {} at {}", mode, join(locations)), {}, true};
    for (const std::string& location : locations) {
      shape.names.push_back(shape_component(mode, location, QuantityKind::displacement, "").name());
    }
    further.push_back(std::move(shape));
  }
  return further;
}

OutputSelection wider_outputs(const Study& study, Eigen::Index mode_count) {
  OutputSelection outputs = study.outputs;
  for (const int mode : further_frequencies(study.outputs, mode_count)) outputs.frequencies.push_back(mode);
  const std::vector<std::string> locations = shape_locations(study);
  if (locations.empty()) return outputs;
  for (const int mode : further_shapes(study.outputs)) outputs.shape_modes.push_back(mode);
  if (!outputs.shape_modes.empty()) outputs.shape_degrees_of_freedom = locations;
  return outputs;
}

}  // namespace mottle::study
