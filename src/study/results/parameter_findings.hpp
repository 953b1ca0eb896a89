// What an update can say of each parameter, in one word, with the interval that it is known to.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "mottle/updating/verdict/verdict.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {

struct ParameterFinding {
  enum class Mark {
    found,      ///< the tests determine mean and scatter, if the model is right
    mean_only,  ///< the method estimates no scatter of specimens
    at_bound,   ///< the bound, not the tests, stopped it
    not_seen,   ///< what is known of it comes from the prior
    doubtful,   ///< a test refused the model, or the update did not converge
  };

  Mark mark = Mark::found;
  Eigen::Vector2d interval = {};        ///< 95 %, of the mean; nan: not determined
  Eigen::Vector2d prior_interval = {};  ///< 95 % of the prior
  std::string reason;                   ///< a sentence
};

/// "found", "mean-only", "at-bound", "not-seen", "doubtful".
std::string mark_text(ParameterFinding::Mark mark);

/// A parameter is not seen where more than a hundredth of its prior variance lies in combinations that no output sees,
/// where its interval is not determined although others' are, or where that interval is at least 0.9 times as wide as
/// the prior's. Being on a bound counts first, then not being seen, then the verdict. Of a box: unseen combinations
/// count first, then an end on a bound, and its width is no sign.
///
/// @param seen  what the outputs determine; null: not known
std::vector<ParameterFinding> find_parameters(const UpdatingProblem& problem, const UpdatingResult& result,
                                              Conclusion conclusion, const Identifiability* seen);

/// `parameters.findings` of result.json.
Json findings_json(const std::vector<ParameterFinding>& findings);

}  // namespace mottle::study
