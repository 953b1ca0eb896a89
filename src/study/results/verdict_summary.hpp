// The first screen of a report in words: one headline, what it rests on, and what to do next.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/input/study.hpp"
#include "mottle/study/jobs/could_hide.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "mottle/updating/verdict/verdict.hpp"
#include "study/results/agreement.hpp"

namespace mottle::study {

struct NextStep {
  std::string command;  ///< for a shell in the study's folder; empty: there is nothing to run yet
  std::string reason;
};

/// One thing that a verdict comes from.
struct VerdictCause {
  std::string kind = {};  ///< docs/howto/report.md lists them
  std::string sentence = {};
  std::vector<int> specimens = {};        ///< numbers of those that it is seen in
  std::vector<std::string> outputs = {};  ///< the same
  NextStep next = {};
};

struct VerdictSummary {
  std::string headline;
  std::string answer = {};             ///< of the method itself, see method_answer(); empty: the headline is all
  bool is_reassuring = false;          ///< adequate, means and scatter are reproduced, and no cause tells of a doubt
  std::vector<VerdictCause> causes;    ///< the most useful first
  std::vector<std::string> sentences;  ///< means, scatter, assumptions
  std::vector<NextStep> next;          ///< the first is the most useful
};

/// What the sentences are made of.
struct SummarySources {
  const Study& study;
  const UpdatingProblem& problem;
  const UpdatingResult& result;
  const Verdict& verdict;
  const Agreement& agreement;
  const CouldHide& could_hide;
  const std::vector<TestDoubt>& doubts;         ///< of the tests
  const std::optional<std::string>& numbering;  ///< a doubt whether modes numbered by rank are the same modes
};

/// `verdict.causes` of result.json.
Json causes_json(const std::vector<VerdictCause>& causes);

/// It never sounds better than the verdict, and worse where means or scatter are not reproduced.
VerdictSummary summarise_verdict(const SummarySources& sources);

/// Adds `headline`, `answer`, `is_reassuring`, `causes`, `summary` and `next` to `verdict` of result.json.
void add_summary(const VerdictSummary& summary, Json& verdict);

}  // namespace mottle::study
