// Whether the updated model can be right, in tests, reasons and plain words.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// adequate: it was tested and stands; inadequate: a test refuses it; undecided: nothing, or not enough, could be
/// tested.
enum class Conclusion { adequate, inadequate, undecided };

/// "adequate", "inadequate", "undecided".
std::string conclusion_text(Conclusion conclusion);

/// The answer to "is the model right?".
struct Verdict {
  Conclusion conclusion = Conclusion::undecided;
  double level = 0.05;  ///< false-alarm rate of the tests together
  std::vector<VerdictTest> tests;
  std::vector<std::string> reasons;     ///< sentences; also where adequate
  std::vector<std::string> not_tested;  ///< sentences: what no test could see, and what would show it
  bool lacks_outputs = false;           ///< UpdatingResult::lacks_outputs
};

/// Inadequate where a test failed; adequate where the update converged, every aspect (the means and, of several
/// specimens, the scatter) was tested with some power and no test failed; else undecided. An update that did not
/// converge is no evidence: it is undecided, unless a test failed where its last step moved no parameter by more than a
/// tenth of a prior deviation. See docs/theory/verdict.md.
Verdict judge(const UpdatingProblem& problem, const UpdatingResult& result);

/// What the outputs can tell of the parameters.
struct Identifiability {
  int rank = 0;
  Eigen::VectorXd singular_values;                 ///< of the scaled sensitivity, descending
  std::vector<Eigen::VectorXd> unseen_directions;  ///< unit vectors over scaled parameters that no output sees
};

/// Singular values of diag(1/output_scale) G diag(parameter_scale): how many output deviations one prior deviation of
/// a parameter combination moves. A value below 1e-6 of the largest counts as unseen.
Identifiability identify(const Eigen::Ref<const Eigen::MatrixXd>& sensitivity,
                         const Eigen::Ref<const Eigen::VectorXd>& output_scale,
                         const Eigen::Ref<const Eigen::VectorXd>& parameter_scale);

/// The same of a finished update: the method's own sensitivity, else the regression of the last cloud, against the
/// deviation of the tests (their mean where they have none) and of the prior. Nothing where neither is to be had.
std::optional<Identifiability> identify(const UpdatingProblem& problem, const UpdatingResult& result);

/// "0.71 K171 - 0.70 K172 + ...": a direction over scaled parameters, the largest weights first, small ones left out.
std::string direction_text(const Eigen::Ref<const Eigen::VectorXd>& direction, const std::vector<std::string>& names);

/// The same as a sentence without a full stop: "k1 and k2 can only be seen together: k1 + 0.9 k2, in prior deviations".
std::string unseen_text(const Eigen::Ref<const Eigen::VectorXd>& direction, const std::vector<std::string>& names);

/// Number of samples for `samples = "auto"`: the larger of what brings Hotelling's critical T within 1 % of its limit
/// and 100 specimens' worth, so that the Monte-Carlo error of a mean is a tenth of the tests' standard error.
int automatic_samples(int specimens, int outputs, double alpha);

}  // namespace mottle::updating
