// The first screen of a report in words: one headline, what it rests on, and what to do next.
#pragma once

#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/input/study.hpp"
#include "mottle/study/jobs/could_hide.hpp"
#include "mottle/updating/verdict/verdict.hpp"
#include "study/results/agreement.hpp"

namespace mottle::study {

struct NextStep {
  std::string command;  ///< for a shell in the study's folder; empty: there is nothing to run yet
  std::string reason;
};

struct VerdictSummary {
  std::string headline;
  bool is_reassuring = false;          ///< adequate, and means and scatter are reproduced as well as chance allows
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
};

/// It never sounds better than the verdict, and worse where means or scatter are not reproduced.
VerdictSummary summarise_verdict(const SummarySources& sources);

/// Adds `headline`, `is_reassuring`, `summary` and `next` to `verdict` of result.json.
void add_summary(const VerdictSummary& summary, Json& verdict);

}  // namespace mottle::study
