// [model] of kind "calculix": a deck that CalculiX reads and assembles, and solves where the parameters are not
// separable.
#include <algorithm>
#include <cctype>
#include <map>

#include "mottle/drivers/calculix/calculix.hpp"
#include "mottle/drivers/calculix/separable_fit.hpp"
#include "mottle/model/units.hpp"
#include "study/input/durations.hpp"
#include "study/models/model_parts.hpp"
#include "study/models/registry.hpp"

namespace mottle::study {
namespace {

/// By its matrices, or where they have no separable form by a run for each sample.
ModelParts make_calculix(const CalculixDeck& deck, const std::vector<ParameterTargets>& targets,
                         const JointDistribution& prior, const CalculixSettings& calculix,
                         const RunSettings& settings) {
  std::string reason;
  try {
    return parts_of(calculix_model(deck, targets, prior.mean(), calculix), deck.files);
  } catch (const NotSeparable& error) {
    reason = error.what();
  }
  std::vector<std::string> names;
  for (const ParameterTargets& target : targets) names.push_back(target.parameter);
  ModelParts parts = make_external(calculix_command(deck, targets, calculix), names, prior, settings);
  parts.limits.assign(targets.size(), {});
  parts.files = deck.files;
  parts.notes.insert(parts.notes.begin(), fmt::format("CalculiX: each sample is a run, since {}", reason));
  return parts;
}

class CalculixSource final : public ModelSource {
 public:
  CalculixSource(TomlReader& reader, const std::filesystem::path& folder)
      : deck_(folder / reader.text("file")),
        program_(reader.text_or("program", "ccx")),
        timeout_(read_duration(reader, "timeout", std::chrono::hours(1))),
        parallel_(static_cast<int>(reader.integer_or("parallel", 1, {.lower = 1.0, .upper = 1000.0}))),
        reduction_error_(read_reduction(reader)) {}

  ModelParts make(const std::vector<ParameterTargets>& parameters, const JointDistribution& prior,
                  const RunSettings& settings) const override {
    const CalculixDeck deck = read_calculix_deck(deck_);
    ModelParts parts = make_calculix(deck, parameters, prior,
                                     {.program = program_,
                                      .timeout = timeout_,
                                      .cache = settings.cache,
                                      .parallel = parallel_,
                                      .stop = settings.stop},
                                     settings);
    if (std::string note = left_out_steps(deck); !note.empty()) parts.notes.push_back(std::move(note));
    for (std::string& note : element_notes(deck)) parts.notes.push_back(std::move(note));
    return parts;
  }

  std::optional<double> reduction_error() const override { return reduction_error_; }
  std::vector<NamedFile> files() const override { return {{"model.file", "file", deck_.string(), deck_}}; }
  std::vector<std::string> programs() const override { return {"model.program: " + program_}; }

  std::vector<ModelNumber> numbers() const override {
    const CalculixDeck deck = read_calculix_deck(deck_);
    std::vector<ModelNumber> found;
    for (const std::string& target : list_calculix_targets(deck)) {
      const std::string field = calculix_field(target);
      const std::vector<CalculixNumber> values = find_calculix_numbers(deck, target);
      const bool is_single =
          std::ranges::all_of(values, [&](const CalculixNumber& one) { return one.value == values.front().value; });
      // With a thickness each sample may be a run. Errors of numbers are not looked for behind a verdict: each costs
      // runs.
      found.push_back({.target = target,
                       .kind = fmt::format("{}:{}", target.substr(0, target.find(':')), field),
                       .value = values.front().value,
                       .is_usual = field != "T",
                       .is_doubtful = false,
                       .is_single = is_single});
    }
    return found;
  }

  std::optional<ExportedModel> export_at(const std::vector<ParameterTargets>& parameters,
                                         const Eigen::VectorXd& values) const override {
    const CalculixDeck deck = read_calculix_deck(deck_);
    std::vector<CalculixReplacement> replacements;
    ExportedModel exported;
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      const double value = values(static_cast<Eigen::Index>(p));
      for (const std::string& target : parameters[p].targets) {
        for (const CalculixNumber& number : find_calculix_numbers(deck, target)) {
          const double wanted = parameters[p].is_factor ? value * number.value : value;
          replacements.push_back(
              {number, with_decimal_point(fmt::format("{:.12g}", wanted))});  // 20 characters are read
        }
      }
    }
    for (CalculixFile& file : deck_files_with_replacements(deck, replacements)) {
      exported.files.push_back({std::move(file.name), std::move(file.bytes)});
    }
    exported.rounding = 5e-12;
    return exported;
  }

  std::string target_key(const std::string& target) const override {
    return target.starts_with('*') ? capitals(target) : target;  // {{name}} is written as it is
  }
  std::string target_unit(const std::string& target, const UnitNames& units) const override {
    static const std::map<std::string, const char* UnitNames::*> k_units = {{"*ELASTIC", &UnitNames::pressure},
                                                                            {"*DENSITY", &UnitNames::density},
                                                                            {"*SPRING", &UnitNames::stiffness},
                                                                            {"*MASS", &UnitNames::mass},
                                                                            {"*SHELL SECTION", &UnitNames::length}};
    std::string keyword = target.substr(0, target.find(':'));
    std::transform(keyword.begin(), keyword.end(), keyword.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
    if (calculix_field(target).starts_with("NU")) return "-";
    const auto found = k_units.find(keyword);
    return found == k_units.end() ? "" : units.*(found->second);
  }

 private:
  std::filesystem::path deck_;
  std::string program_;
  std::chrono::milliseconds timeout_;  // of one run
  int parallel_;                       // runs of samples at once
  std::optional<double> reduction_error_;
};

}  // namespace

std::shared_ptr<const ModelSource> read_calculix_source(TomlReader& reader, const std::filesystem::path& folder) {
  auto source = std::make_shared<CalculixSource>(reader, folder);
  reader.finish();
  return source;
}

}  // namespace mottle::study
