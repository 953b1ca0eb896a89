#include <memory>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/updating/methods/abc.hpp"
#include "mottle/updating/methods/bayes.hpp"
#include "mottle/updating/methods/deterministic.hpp"
#include "mottle/updating/methods/hierarchical.hpp"
#include "mottle/updating/methods/interval.hpp"
#include "mottle/updating/methods/maximum_likelihood.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "updating/methods/covariance_adjustment.hpp"
#include "updating/methods/inversion.hpp"
#include "updating/methods/mares.hpp"
#include "updating/methods/mixture.hpp"
#include "updating/methods/moment_matching.hpp"
#include "updating/methods/perturbation.hpp"

namespace mottle::updating {
namespace {

template <typename Method, const auto& table>
std::unique_ptr<Updater> make(const OptionValues& values, const std::string& where) {
  return std::make_unique<Method>(table().read(values, where));
}

}  // namespace

const std::vector<MethodEntry>& updating_methods() {
  static const std::vector<MethodEntry> methods = {
      {"maximum-likelihood",
       "The population of the specimens: mean and covariance by (restricted) maximum likelihood, with confidence "
       "intervals.",
       maximum_likelihood_option_table().describe(), make<MaximumLikelihoodUpdater, maximum_likelihood_option_table>},
      {"mares",
       "Regression on Monte-Carlo clouds, mean and covariance by Eqs. 11 and 12 of Mares, Mottershead and Friswell "
       "(2006).",
       mares_option_table().describe(), make<MaresUpdater, mares_option_table>, true, false},
      {"deterministic",
       "One structure, or the mean of many: weighted least squares with Tikhonov or Bayesian regularisation.",
       deterministic_option_table().describe(), make<DeterministicUpdater, deterministic_option_table>, false, false},
      {"bayes",
       "The posterior of one structure's parameters, or of parameters that all specimens have in common, with its "
       "evidence: sequential Monte Carlo.",
       bayes_option_table().describe(), make<BayesUpdater, bayes_option_table>, false, false},
      {"hierarchical",
       "The posterior of the population's mean and covariance, of every specimen and of a new one, with its evidence: "
       "for few specimens.",
       hierarchical_option_table().describe(), make<HierarchicalUpdater, hierarchical_option_table>},
      {"interval",
       "Bounds of the parameters whose image covers the tests' bounds, widened for few specimens, by proven ranges of "
       "eigenvalues.",
       interval_option_table().describe(), make<IntervalUpdater, interval_option_table>, false, false},
      {"mixture",
       "Several batches in one population, with outliers: their number by a bootstrap of the likelihood ratio, each "
       "specimen assigned with a probability.",
       mixture_option_table().describe(), make<MixtureUpdater, mixture_option_table>},
      {"abc",
       "The population whose cloud is nearest to the tests, for what has no likelihood: distances between samples, "
       "intervals that cover in simulated studies.",
       abc_option_table().describe(), make<AbcUpdater, abc_option_table>, true},
      {"inversion", "The population's mean and covariance from parameters that are solved for each specimen alone.",
       inversion_option_table().describe(), make<InversionUpdater, inversion_option_table>},
      {"perturbation", "The population to first order, after Khodaparast, Mottershead and Friswell (2008).",
       perturbation_option_table().describe(), make<PerturbationUpdater, perturbation_option_table>},
      {"covariance-adjustment",
       "The population whose cloud has the tests' mean and covariance, after Govers and Link (2010).",
       covariance_adjustment_option_table().describe(),
       make<CovarianceAdjustmentUpdater, covariance_adjustment_option_table>, true},
      {"moment-matching", "The population whose outputs have the tests' mean and covariance, by quadrature.",
       moment_matching_option_table().describe(), make<MomentMatchingUpdater, moment_matching_option_table>},
  };
  return methods;
}

const MethodEntry& find_method(const std::string& name) {
  std::vector<std::string> names;
  for (const MethodEntry& method : updating_methods()) {
    if (method.name == name) return method;
    names.push_back(method.name);
  }
  throw InvalidInput(unknown_name_message("method", name, names));
}

void UpdatingResult::set_estimate(std::shared_ptr<const Estimate> found) {
  estimate = std::move(found);
  mean = estimate->mean();
  covariance = estimate->covariance();
  is_population = estimate->kind() == EstimateKind::population;
}

std::string status_text(UpdatingStatus status) {
  switch (status) {
    case UpdatingStatus::converged:
      return "converged";
    case UpdatingStatus::max_iterations:
      return "max-iterations";
    case UpdatingStatus::stalled:
      return "stalled";
    case UpdatingStatus::stopped:
      return "stopped";
    case UpdatingStatus::failed:
      return "failed";
  }
  return "failed";
}

}  // namespace mottle::updating
