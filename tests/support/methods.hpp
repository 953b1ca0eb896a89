// The registry of methods as parameters of tests, and what a result says.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "mottle/updating/methods/updater.hpp"

namespace mottle::test {

using namespace updating;  // of which these are the tests

inline std::vector<std::string> method_names(bool of_populations) {
  std::vector<std::string> names;
  for (const MethodEntry& method : updating_methods()) {
    if (method.estimates_population || !of_populations) names.push_back(method.name);
  }
  return names;
}

/// Methods that estimate one population by its likelihood or its moments: a posterior is wider where specimens are few,
/// and has its prior where outputs say nothing.
inline std::vector<std::string> population_estimators() {
  std::vector<std::string> names = method_names(true);
  std::erase(names, "hierarchical");
  return names;
}

/// The method of that name as the tests of every method take it: as a study does that states no options, but for
/// a sampler of populations, whose fewer particles are quick.
inline std::unique_ptr<Updater> tested_method(const std::string& name) {
  return find_method(name).make(
      name == "hierarchical" ? OptionValues{{"particles", std::int64_t{200}}} : OptionValues{}, "test");
}

/// Names of tests hold no dash.
inline std::string instance_name(const testing::TestParamInfo<std::string>& instance) {
  std::string name = instance.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

/// Whether a note of the result holds these words.
inline bool says(const UpdatingResult& result, const std::string& words) {
  return std::any_of(result.notes.begin(), result.notes.end(),
                     [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

}  // namespace mottle::test
