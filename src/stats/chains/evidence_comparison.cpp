#include "mottle/stats/chains/evidence_comparison.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "mottle/core/error.hpp"

namespace mottle::stats {
namespace {

/// Reach of the 95 % interval of a sum of estimates with these variances, in its standard errors.
class Reach {
 public:
  void add(double variance, double degrees_of_freedom) {
    sum_ += variance;
    squares_ += variance * variance / degrees_of_freedom;
  }
  double value() const {
    constexpr double k_tail = 0.025;
    if (!(sum_ > 0.0)) return 0.0;
    const boost::math::students_t t(sum_ * sum_ / squares_);
    return std::sqrt(sum_) * boost::math::quantile(boost::math::complement(t, k_tail));
  }

 private:
  double sum_ = 0.0;
  double squares_ = 0.0;
};

double logistic(double logit) {
  return 1.0 / (1.0 + std::exp(-logit));
}

/// Probability of a model among all, with its interval.
void add_probability(const std::vector<EstimatedEvidence>& evidences, std::size_t i, ModelProbability& found) {
  double largest = -HUGE_VAL;
  for (std::size_t j = 0; j < evidences.size(); ++j) {
    if (j != i) largest = std::max(largest, evidences[j].log_evidence);
  }
  double others = 0.0;
  for (std::size_t j = 0; j < evidences.size(); ++j) {
    if (j != i) others += std::exp(evidences[j].log_evidence - largest);
  }
  Reach reach;
  for (std::size_t j = 0; j < evidences.size(); ++j) {
    const double weight = j == i ? 1.0 : std::exp(evidences[j].log_evidence - largest) / others;
    reach.add(std::pow(weight * evidences[j].standard_error, 2), evidences[j].degrees_of_freedom);
  }
  const double logit = evidences[i].log_evidence - largest - std::log(others);
  found.probability = logistic(logit);
  found.lower = logistic(logit - reach.value());
  found.upper = logistic(logit + reach.value());
  found.rest = logistic(-logit);
  found.rest_of_lower = logistic(reach.value() - logit);
  found.rest_of_upper = logistic(-logit - reach.value());
}

}  // namespace

std::vector<ModelProbability> compare_evidences(const std::vector<EstimatedEvidence>& evidences) {
  require(evidences.size() >= 2, "evidences: {}, a comparison needs two", evidences.size());
  for (const EstimatedEvidence& one : evidences) {
    require(std::isfinite(one.log_evidence) && one.standard_error >= 0.0 && one.degrees_of_freedom >= 1.0,
            "evidence: {} with standard error {} and {} degrees of freedom; need a finite one, an error >= 0 and "
            "degrees of freedom >= 1",
            one.log_evidence, one.standard_error, one.degrees_of_freedom);
  }
  const auto best = std::max_element(
      evidences.begin(), evidences.end(),
      [](const EstimatedEvidence& a, const EstimatedEvidence& b) { return a.log_evidence < b.log_evidence; });
  std::vector<ModelProbability> found(evidences.size());
  for (std::size_t i = 0; i < evidences.size(); ++i) {
    found[i].log_bayes_factor = best->log_evidence - evidences[i].log_evidence;
    if (&evidences[i] != &*best)
      found[i].standard_error = std::hypot(best->standard_error, evidences[i].standard_error);
    add_probability(evidences, i, found[i]);
  }
  return found;
}

const char* evidence_strength(double log_bayes_factor) {
  const double twice = 2.0 * log_bayes_factor;
  if (twice < 2.0) return "not worth more than a bare mention";
  if (twice < 6.0) return "positive";
  return twice <= 10.0 ? "strong" : "very strong";
}

}  // namespace mottle::stats
