// The study that `mottle init` proposes, as text with its reasons.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mottle/core/text.hpp"
#include "mottle/layers.hpp"
#include "mottle/study/jobs/init.hpp"

namespace mottle::study {

/// TOML with comments: what was found, what was guessed, what is not known.
std::string study_text_of(const InitOutcome& outcome);

/// The same of a solver by command: what runs it, what it leaves and what values are usual is marked as unknown.
std::string template_study_text(const InitOutcome& outcome);

/// A basic string of TOML.
std::string toml_string(const std::string& text);

/// A file as a study names it: relative to the study's folder.
std::string relative_path(const std::filesystem::path& file, const std::filesystem::path& study);

/// The value of test.file.
std::string test_files_text(const InitSettings& settings);

/// "a, b, c" of any list.
template <typename List, typename Text>
std::string listed(const List& list, const Text& text) {
  std::vector<std::string> parts;
  for (const auto& entry : list) parts.push_back(text(entry));
  return join(parts);
}

}  // namespace mottle::study
