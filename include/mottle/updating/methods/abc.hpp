// Approximate Bayesian computation: a population of specimens found by distances between simulated and real tests.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// Which distance is taken, and how much is simulated.
struct AbcOptions {
  enum class Distance { energy, sliced_wasserstein };
  enum class Noise { automatic, given, estimated };
  enum class Correlations { automatic, estimated, none };

  Distance distance = Distance::energy;  // bounded influence of a single specimen
  Noise noise = Noise::automatic;
  Correlations correlations = Correlations::automatic;
  int simulations = 10000;     // 1,500 accepted at least: tails of 2.5 % from 37
  int calibration_sets = 400;  // a coverage of 95 % is then known to 1.1 %
};

/// Name, range, default and meaning of each option.
const OptionTable<AbcOptions>& abc_option_table();

/// One stage of sampling.
struct AbcStage {
  Eigen::Index simulations = 0;  ///< sets of tests
  Eigen::Index accepted = 0;
  double tolerance = 0.0;          ///< largest distance of an accepted set's summary, in its standard deviations
  double effective_samples = 0.0;  ///< of those accepted
};

/// What `abc` finds beside the population, which is the estimate.
struct AbcFindings {
  std::string distance;             ///< "energy" | "sliced-wasserstein"
  std::vector<double> distances;    ///< of the cloud from the tests, after each iteration
  double simulated_distance = 0.0;  ///< mean of that of tests simulated from the estimate
  double exceeded = 1.0;            ///< fraction of simulated sets of tests that are at least as far as the tests
  std::vector<AbcStage> stages;
  double fraction = 0.0;  ///< accepted in the last stage, chosen by calibration

  Eigen::Index calibration_sets = 0;
  std::vector<std::string> coordinates;  ///< what is sampled
  Eigen::VectorXd factor;                ///< by which intervals were stretched [coordinate]
  Eigen::VectorXd coverage;              ///< of 95 % intervals before that [coordinate]
  double checked_coverage = 0.0;         ///< after, in sets that did not make the factors
  double checked_standard_error = 0.0;

  Eigen::Index chains = 0;         ///< parts of the last stage's simulations, each by itself
  Eigen::Index draws = 0;          ///< of each
  std::vector<std::string> names;  ///< of means, standard deviations, correlations and levels of noise
  Eigen::MatrixXd values;          ///< stretched draws [chain x draw, name]
  Eigen::VectorXd r_hat;           ///< [name]

  double curvature = 0.0;         ///< largest part of an output's variance that is not linear in the parameters
  double normality_p = 1.0;       ///< that normal tests look as little normal, over all outputs; nan: too few to say
  double width_ratio_mean = 1.0;  ///< of intervals of this method to those of a normal likelihood; nan: not known
  double width_ratio_std = 1.0;
  bool is_likelihood_better = false;
};

/// The normal population on the parameters' scales whose cloud, with noise, is nearest to the tests; its uncertainty by
/// simulated sets of tests that are compared through the gradient of the distance, intervals stretched so that they
/// hold the truth in simulated studies. The model is run for clouds alone; no likelihood and no derivative is needed.
///
/// The theory: docs/theory/abc.md. Source: [Beaumont2002]; [Ruli2016]; [Szekely2013].
class AbcUpdater final : public Updater {
 public:
  explicit AbcUpdater(const AbcOptions& options) : options_(options) {}

  /// Throws InvalidInput: fewer than 2 specimens, too few samples, noise to be estimated from too few outputs.
  UpdatingResult update(const UpdatingProblem& problem, const RunContext& context) const override;
  OptionValues options() const override { return abc_option_table().values(options_); }

 private:
  AbcOptions options_;
};

}  // namespace mottle::updating
