#include "mottle/study/jobs/init.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"
#include "mottle/drivers/command/template_file.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "study/input/first_few.hpp"
#include "study/jobs/init_model.hpp"
#include "study/jobs/proposed_modes.hpp"
#include "study/jobs/proposed_parameters.hpp"
#include "study/results/init_text.hpp"
#include "study/tests/unit_errors.hpp"

namespace mottle::study {
namespace {

constexpr int k_fewest_modes = 20;
constexpr int k_fewest_of_runs = 30;  // where more would be runs of a program again
constexpr int k_more_modes = 8;       // than the tests have, which may have missed some

/// Modes of the tests, at most.
int tested_modes(const TestContents& contents) {
  if (contents.table) {
    return static_cast<int>(std::ranges::count_if(contents.table->header, [](const std::string& title) {
      return title.size() > 1 && title.front() == 'f' && title[1] >= '0' && title[1] <= '9';
    }));
  }
  Eigen::Index most = 0;
  for (const MeasuredModes& specimen : contents.specimens) most = std::max(most, specimen.frequencies.size());
  return static_cast<int>(most);
}

/// Scale of each output's logarithm: the tests' scatter, or what a first study would call near without tests.
Eigen::VectorXd scales_of(const std::vector<InitMode>& outputs) {
  constexpr double k_least = 0.001;
  constexpr double k_untested = 0.01;
  Eigen::VectorXd scales(static_cast<Eigen::Index>(outputs.size()));
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const double scatter = outputs[k].robust_std / outputs[k].test_mean;
    scales(static_cast<Eigen::Index>(k)) = std::isnan(scatter) ? k_untested : std::max(scatter, k_least);
  }
  return scales;
}

/// The lowest modes that are beyond doubt: high ones cost more than they tell of a first study's parameters. With
/// `wanted` those, whatever is in doubt.
void choose_outputs(const std::optional<std::vector<int>>& wanted, std::vector<InitMode>& modes) {
  constexpr int k_most = 14;
  if (wanted) {
    for (const int number : *wanted) {
      require(std::ranges::find(modes, number, &InitMode::mode) != modes.end(),
              "mode {} cannot be an output: it is a rigid-body mode or beyond the {} modes that were solved", number,
              modes.empty() ? 0 : modes.back().mode);
    }
    for (InitMode& mode : modes) {
      const bool is_wanted = std::ranges::count(*wanted, mode.mode) > 0;
      if (is_wanted && mode.doubt != "not tested") mode.doubt.clear();
      if (!is_wanted && mode.doubt.empty()) mode.doubt = "not wanted";
    }
    return;
  }
  int count = 0;
  for (InitMode& mode : modes) {
    if (mode.doubt.empty() && ++count > k_most)
      mode.doubt = fmt::format("the lowest {} are enough to begin with", k_most);
  }
}

std::vector<InitMode> outputs_of(const InitOutcome& outcome) {
  std::vector<InitMode> outputs;
  for (const InitMode& mode : outcome.modes) {
    if (mode.doubt.empty()) outputs.push_back(mode);
  }
  return outputs;
}

/// " (f1: +9.5 % apart, ...)": why the tested modes are no outputs; empty: none was tested.
std::string doubts_text(const std::vector<InitMode>& modes) {
  std::vector<std::string> doubts;
  for (const InitMode& mode : modes) {
    if (mode.specimens > 0 && !mode.doubt.empty()) doubts.push_back(fmt::format("f{}: {}", mode.mode, mode.doubt));
  }
  return doubts.empty() ? "" : fmt::format(" ({})", first_few(doubts));
}

/// Which outputs have one frequency, and what is not known of them; empty: none.
std::string one_frequency_note(const ProposedOutputs& outputs) {
  std::vector<std::string> lists;
  for (const ModeGroup& group : outputs.groups) {
    std::vector<std::string> names;
    for (const int mode : outputs.modes) {
      if (group.contains(mode - 1)) names.push_back(fmt::format("f{}", mode));
    }
    if (names.size() > 1) lists.push_back(join(names));
  }
  if (lists.empty()) return {};
  return fmt::format(
      "Outputs of one frequency in the model, of which any combination is a mode: {}. A number's % per % are those of "
      "the frequencies into which they split, in ascending order. Which combination it changes is not known here, so "
      "numbers are not left out for being alike in these modes.",
      join(lists, "; "));
}

/// What `check` would refuse is said now.
void try_study(InitOutcome& outcome) {
  try {
    const Study study = read_study_text(outcome.text, outcome.settings.study);
    const StudyModel made = make_model(study, study.parameters, {.cache = outcome.settings.cache});
    if (!study.test) return;
    const StudyTests tests = read_tests(study, *made.model);
    require_repeated_outputs(tests.data, made.model->outputs());
    refuse_unit_errors(study, made, tests);
    for (const TestDoubt& doubt : tests.doubts) outcome.notes.push_back(doubt.sentence);
  } catch (const InvalidInput& error) {
    outcome.notes.push_back(fmt::format("The study does not run yet: {}", error.what()));
  }
}

std::vector<int> numbers_of(const std::vector<InitMode>& outputs) {
  std::vector<int> numbers;
  for (const InitMode& mode : outputs) numbers.push_back(mode.mode);
  return numbers;
}

/// A study whose outputs are all elastic modes, for reading and pairing tests.
Study draft_study(const InitOutcome& outcome, const InitModel& model) {
  InitOutcome draft = outcome;
  draft.pairing = "frequency";
  draft.modes = elastic_modes(model.frequencies);
  draft.parameters = {{.target = model.targets.front().name, .name = "any number", .spread = 0.1}};
  return read_study_text(study_text_of(draft), outcome.settings.study);
}

void propose_outputs(InitOutcome& outcome, InitModel& model) {
  const InitSettings& settings = outcome.settings;
  const bool has_tests = !settings.tests.empty();
  TestContents contents;
  if (has_tests) {
    contents = read_test_files(draft_study(outcome, model));
    const int there = std::max(static_cast<int>(model.mode_count) / 2, k_fewest_modes);
    const int wanted = std::min(tested_modes(contents) + k_more_modes, there);
    const bool has_more = model.frequencies.size() < model.mode_count;
    if (wanted > model.frequencies.size() && has_more) model = solve_for_proposal(outcome, wanted);
    PairedTests paired = pair_for_proposal(draft_study(outcome, model), std::move(contents), model.frequencies,
                                           {.cache = settings.cache});
    outcome.pairing = paired.pairing;
    outcome.specimens = paired.specimens;
    outcome.modes = std::move(paired.modes);
    outcome.shapes = std::move(paired.shapes);
    outcome.notes = std::move(paired.notes);
  } else {
    outcome.modes = elastic_modes(model.frequencies);
  }
  outcome.notes.insert(outcome.notes.end(), model.notes.begin(), model.notes.end());
  choose_outputs(settings.modes, outcome.modes);
  std::erase_if(outcome.shapes.modes, [&](int number) {
    const auto mode = std::ranges::find(outcome.modes, number, &InitMode::mode);
    return mode == outcome.modes.end() || !mode->doubt.empty();
  });
}

/// The study of a solver by command, which is not run: its outputs are the tests' modes.
InitOutcome propose_template(InitOutcome outcome) {
  InitSettings& settings = outcome.settings;
  require(!settings.targets && settings.ignore_cards.empty(),
          "{}: its placeholders are the parameters; --targets and --ignore-cards are for decks",
          settings.model.string());
  if (!settings.units) {
    settings.units = "SI";
    outcome.units_reason = "UNKNOWN: SI, mm-t-s, mm-kg-ms or in-lbf-s";
  }
  for (const std::string& name : placeholder_names(read_file(settings.model), settings.model.string())) {
    outcome.parameters.push_back({.name = name});
  }
  int count = static_cast<int>(outcome.parameters.size());  // outputs of an unknown number, enough for them
  if (!settings.tests.empty()) {
    Study reader;
    reader.file = settings.study;
    reader.units = *settings.units;
    reader.test.emplace();
    reader.test->pairing = TestPairing::frequency;
    for (const std::string& file : settings.tests) reader.test->files.emplace_back(file);
    const TestContents contents = read_test_files(reader);
    count = tested_modes(contents);
    outcome.specimens = static_cast<int>(contents.table ? contents.table->rows.size() : contents.specimens.size());
  }
  std::vector<int> numbers(static_cast<std::size_t>(count));
  std::iota(numbers.begin(), numbers.end(), 1);
  for (const int number : settings.modes.value_or(numbers)) outcome.modes.push_back({.mode = number});
  outcome.text = study_text_of(outcome);
  outcome.notes.push_back("The solver was not run. Fill in what is marked UNKNOWN; `mottle check` does the first run.");
  return outcome;
}

}  // namespace

InitOutcome propose_study(const InitSettings& settings) {
  InitOutcome outcome{.settings = settings, .kind = model_kind_of(settings.model)};
  if (outcome.kind == "command") return propose_template(std::move(outcome));
  InitModel model = solve_for_proposal(outcome, outcome.kind == "nastran" ? k_fewest_modes : k_fewest_of_runs);
  propose_outputs(outcome, model);
  const std::vector<InitMode> outputs = outputs_of(outcome);
  require(
      !outputs.empty(),
      "{0}: no mode of the model is found in the tests beyond doubt{1}; see `mottle modes {0}` for the model's modes, "
      "and name the outputs with --outputs",
      settings.model.string(), doubts_text(outcome.modes));
  const ProposedOutputs seen{numbers_of(outputs), scales_of(outputs), modes_of_one_frequency(model.frequencies)};
  ProposedParameters proposed = propose_parameters(outcome, model.targets, seen);
  outcome.parameters = std::move(proposed.list);
  outcome.notes.insert(outcome.notes.end(), proposed.notes.begin(), proposed.notes.end());
  if (std::string note = one_frequency_note(seen); !note.empty()) outcome.notes.push_back(std::move(note));
  require(outcome.parameters.front().left_out.empty(),
          "{0}: no number of the deck moves the outputs by more than the tests scatter; see `mottle targets {0}`, and "
          "name the parameters with --targets",
          settings.model.string());
  outcome.text = study_text_of(outcome);
  try_study(outcome);
  return outcome;
}

}  // namespace mottle::study
