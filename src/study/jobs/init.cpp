#include "mottle/study/jobs/init.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "study/jobs/deck_targets.hpp"
#include "study/jobs/proposed_modes.hpp"
#include "study/jobs/proposed_parameters.hpp"
#include "study/jobs/proposed_units.hpp"
#include "study/results/init_text.hpp"
#include "study/tests/unit_errors.hpp"

namespace mottle::study {
namespace {

constexpr int k_fewest_modes = 20;
constexpr int k_more_modes = 8;  // than the tests have, which may have missed some

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
    const double scatter = outputs[k].test_std / outputs[k].test_mean;
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

/// What `check` would refuse is said now.
void try_study(InitOutcome& outcome) {
  try {
    const Study study = read_study_text(outcome.text, outcome.settings.study);
    const StudyModel made = make_model(study, study.parameters);
    if (!study.test) return;
    const StudyTests tests = read_tests(study, *made.model);
    refuse_unit_errors(study, made, tests);
  } catch (const InvalidInput& error) {
    outcome.notes.push_back(fmt::format("The study does not run yet: {}", error.what()));
  }
}

/// Deck, modes and targets, with as many modes as the tests could show.
struct Deck {
  SolvedDeck solved;
  TargetsOutcome targets;
};

/// Units that are not known yet are proposed.
Deck solve(InitOutcome& outcome, int modes) {
  InitSettings& settings = outcome.settings;
  SolvedDeck solved = solve_deck(settings.model, {.ignore_cards = settings.ignore_cards}, modes);
  if (!settings.units) {
    const ProposedUnits units = propose_units(solved.structure->model());
    settings.units = units.units;
    outcome.units_reason = units.reason;
  }
  TargetsOutcome targets = targets_of(solved, {.model = settings.model, .units = *settings.units});
  require(!targets.targets.empty(), "{}: no number of the deck changes its lowest {} modes", settings.model.string(),
          modes);
  return {std::move(solved), std::move(targets)};
}

std::vector<int> numbers_of(const std::vector<InitMode>& outputs) {
  std::vector<int> numbers;
  for (const InitMode& mode : outputs) numbers.push_back(mode.mode);
  return numbers;
}

/// A study whose outputs are all elastic modes, for reading and pairing tests.
Study draft_study(const InitOutcome& outcome, const Deck& deck) {
  InitOutcome draft = outcome;
  draft.pairing = "frequency";
  draft.modes = elastic_modes(deck.solved.frequencies);
  draft.parameters = {{.target = deck.targets.targets.front().name, .name = "any number", .spread = 0.1}};
  return read_study_text(study_text_of(draft), outcome.settings.study);
}

void propose_outputs(InitOutcome& outcome, Deck& deck) {
  const InitSettings& settings = outcome.settings;
  const bool has_tests = !settings.tests.empty();
  TestContents contents;
  if (has_tests) {
    contents = read_test_files(draft_study(outcome, deck));
    const int there = std::max(static_cast<int>(deck.solved.structure->mode_count()) / 2, k_fewest_modes);
    const int wanted = std::min(tested_modes(contents) + k_more_modes, there);
    if (wanted > deck.solved.frequencies.size()) deck = solve(outcome, wanted);
    PairedTests paired = pair_for_proposal(draft_study(outcome, deck), std::move(contents), deck.solved.frequencies);
    outcome.pairing = paired.pairing;
    outcome.specimens = paired.specimens;
    outcome.modes = std::move(paired.modes);
    outcome.notes = std::move(paired.notes);
  } else {
    outcome.modes = elastic_modes(deck.solved.frequencies);
  }
  choose_outputs(settings.modes, outcome.modes);
}

}  // namespace

InitOutcome propose_study(const InitSettings& settings) {
  InitOutcome outcome{.settings = settings};
  Deck deck = solve(outcome, k_fewest_modes);
  propose_outputs(outcome, deck);
  const std::vector<InitMode> outputs = outputs_of(outcome);
  require(!outputs.empty(),
          "{0}: no mode of the model is found in the tests beyond doubt; see `mottle modes {0}` for the model's modes, "
          "and name the outputs with --outputs",
          settings.model.string());
  outcome.parameters = propose_parameters(deck.targets.targets, numbers_of(outputs), scales_of(outputs),
                                          settings.targets.value_or(std::vector<std::string>{}));
  require(outcome.parameters.front().left_out.empty(),
          "{0}: no number of the deck moves the outputs by more than the tests scatter; see `mottle targets {0}`, and "
          "name the parameters with --targets",
          settings.model.string());
  outcome.text = study_text_of(outcome);
  try_study(outcome);
  return outcome;
}

}  // namespace mottle::study
