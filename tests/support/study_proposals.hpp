// Studies that are proposed of a deck and its tests.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mottle/study/jobs/init.hpp"
#include "support/study_folder.hpp"

namespace mottle::test {

/// A cantilever in mm, t, s.
inline const std::string k_cantilever_deck =
    "SOL 103\nCEND\nSPC = 1\nBEGIN BULK\nGRID,1\nGRID,2,,500.\nGRID,3,,1000.\nGRID,4,,1500.\nSPC1,1,123456,1\n"
    "CBAR,1,1,1,2,0.,0.,1.\nCBAR,2,1,2,3,0.,0.,1.\nCBAR,3,1,3,4,0.,0.,1.\nPBARL,1,1,,BAR\n,20.,30.\n"
    "MAT1,1,70000.,,.3,2.7-9\nENDDATA\n";

/// A folder with decks, and what is proposed of them.
class ProposalFolder {
 public:
  study::InitOutcome propose(const std::string& model, const std::vector<std::string>& tests = {},
                             study::InitSettings settings = {}) const {
    settings.model = folder / model;
    for (const std::string& file : tests) settings.tests.push_back((folder / file).string());
    settings.study = folder / "s.toml";
    study::InitOutcome outcome = study::propose_study(settings);
    folder.write("s.toml", outcome.text);
    return outcome;
  }
  std::string refusal(const std::string& model, const std::vector<std::string>& tests = {},
                      const study::InitSettings& settings = {}) const {
    return message_of<InvalidInput>([&] { (void)propose(model, tests, settings); });
  }
  std::string check() const { return folder.check({.study = "s.toml"}); }

  StudyFolder folder;
};

/// The modes that are outputs.
inline std::vector<int> proposed_outputs(const study::InitOutcome& outcome) {
  std::vector<int> modes;
  for (const study::InitMode& mode : outcome.modes) {
    if (mode.doubt.empty()) modes.push_back(mode.mode);
  }
  return modes;
}

/// The targets of the parameters.
inline std::vector<std::string> proposed_targets(const study::InitOutcome& outcome) {
  std::vector<std::string> targets;
  for (const study::InitParameter& parameter : outcome.parameters) {
    if (parameter.left_out.empty()) targets.push_back(parameter.target);
  }
  return targets;
}

/// Why a number of the deck is no parameter.
inline std::string reason_against(const study::InitOutcome& outcome, const std::string& target) {
  for (const study::InitParameter& parameter : outcome.parameters) {
    if (parameter.target == target) return parameter.left_out;
  }
  throw std::logic_error("nothing is said of " + target);
}

inline std::string notes_of(const study::InitOutcome& outcome) {
  return fmt::format("{}", fmt::join(outcome.notes, " "));
}

}  // namespace mottle::test
