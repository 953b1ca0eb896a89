// The study of three masses with a solver of the user's own in place of its model.
#pragma once

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/study_texts.hpp"

namespace mottle::test {

/// A study whose solver.py is given the parameters in input.txt and leaves frequencies in f.txt.
inline std::string command_study(const std::vector<std::string>& command) {
  std::string text = fmt::format("[model]\nkind = \"command\"\ncommand = {}\n", nlohmann::json(command).dump()) +
                     "templates = [\"input.txt\"]\nfiles = [\"solver.py\"]\nretries = 0\n"
                     "[model.frequencies]\nfile = \"f.txt\"\nformat = \"column\"\n";
  for (const std::string& line : lines_of(k_three_masses_study.substr(k_three_masses_study.find("[[parameter]]")))) {
    if (line.find("target") == std::string::npos) text += line + "\n";
  }
  return text;
}

}  // namespace mottle::test
