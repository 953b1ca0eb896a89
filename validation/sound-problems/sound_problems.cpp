// Updates sound problems drawn at random by every method that estimates a population: none may fail.
//
//   mottle_sound_problems FIRST COUNT [METHOD [KEY=VALUE]]
//
// Prints one JSON object: how each method ended, and every failure with the problem's number and what it was.
#include <fmt/format.h>

#include <cstdlib>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "mottle/core/parallel.hpp"
#include "support/random_problem.hpp"
#include "support/soundness.hpp"

namespace {

using namespace mottle;
using namespace mottle::updating;

/// How one method ended on one problem: a status, "refused: ..." or "FAILED: ...".
std::string outcome_of(const test::RandomProblem& drawn, const Updater& method) {
  const UpdatingProblem problem = drawn.problem();
  try {
    const UpdatingResult result = method.update(problem, {.seed = 1});
    const std::string fault = test::fault_of(problem, result, {.seed = 1});
    return fault.empty() ? status_text(result.status) : "FAILED: " + fault;
  } catch (const InvalidInput& error) {
    return std::string("refused: ") + error.what();
  } catch (const std::exception& error) {
    return std::string("FAILED: ") + error.what();
  }
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') result += '\\';
    result += letter == '\n' ? ' ' : letter;
  }
  return result + "\"";
}

std::string row(const std::string& method, const std::vector<std::string>& outcomes, std::uint32_t first) {
  std::map<std::string, int> counts;
  std::string odd;
  for (std::size_t k = 0; k < outcomes.size(); ++k) {
    const bool is_status = outcomes[k].find(": ") == std::string::npos;
    ++counts[is_status ? outcomes[k] : outcomes[k].substr(0, outcomes[k].find(':'))];
    if (is_status) continue;
    const std::uint32_t number = first + static_cast<std::uint32_t>(k);
    odd += fmt::format("{}\n    [{}, {}, {}]", odd.empty() ? "" : ",", number, quoted(outcomes[k]),
                       quoted(test::RandomProblem(number).description()));
  }
  std::string text;
  for (const auto& [name, count] : counts)
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", quoted(name), count);
  return fmt::format("  {}: {{\"endings\": {{{}}}, \"odd\": [{}]}}", quoted(method), text, odd);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::cerr << "usage: FIRST COUNT [METHOD [KEY=VALUE]]\n";
    return 2;
  }
  const auto first = static_cast<std::uint32_t>(std::stoul(argv[1]));
  const auto count = static_cast<std::int64_t>(std::stoul(argv[2]));
  OptionValues options;
  if (argc > 4) {
    const std::string text = argv[4];
    options[text.substr(0, text.find('='))] = text.substr(text.find('=') + 1);
    if (options.contains("intervals")) options["bootstrap_samples"] = std::int64_t{100};
  }
  std::vector<std::string> methods;
  for (const MethodEntry& entry : updating_methods()) {
    if (entry.estimates_population && (argc < 4 || entry.name == argv[3])) methods.push_back(entry.name);
  }
  std::string text;
  for (const std::string& name : methods) {
    const std::unique_ptr<Updater> method = find_method(name).make(options, "options");
    std::vector<std::string> outcomes(static_cast<std::size_t>(count));
    parallel_for(count, 1, available_threads(), [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t k = begin; k < end; ++k) {
        outcomes[static_cast<std::size_t>(k)] =
            outcome_of(test::RandomProblem(first + static_cast<std::uint32_t>(k)), *method);
      }
    });
    text += (text.empty() ? "" : ",\n") + row(name, outcomes, first);
  }
  fmt::print("{{\n{}\n}}\n", text);
  return 0;
}
