#include "mottle/stats/distributions/distribution.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "stats/distributions/distribution_families.hpp"

namespace mottle::stats {

const std::vector<DistributionKindInfo>& distribution_kinds() {
  static const std::vector<DistributionKindInfo> k_kinds = {
      {"normal", DistributionKind::normal, {"mean", "std"}, "Gaussian; takes negative values too."},
      {"lognormal",
       DistributionKind::lognormal,
       {"mean", "std"},
       "Exponential of a Gaussian, always positive; mean and std are of the variable itself, not of its logarithm."},
      {"uniform", DistributionKind::uniform, {"lower", "upper"}, "Every value between the bounds is equally likely."},
      {"truncated-normal",
       DistributionKind::truncated_normal,
       {"mean", "std", "lower", "upper"},
       "Gaussian cut at the bounds; mean and std are those before the cut."},
      {"beta",
       DistributionKind::beta,
       {"mean", "std", "lower", "upper"},
       "Bounded and smooth at the bounds; mean and std are of the variable itself."},
      {"gamma",
       DistributionKind::gamma,
       {"mean", "std"},
       "Always positive, with a lighter upper tail than lognormal; mean and std are of the variable itself."}};
  return k_kinds;
}

const DistributionKindInfo& distribution_kind_info(DistributionKind kind) {
  const auto& kinds = distribution_kinds();
  const auto found = std::find_if(kinds.begin(), kinds.end(), [kind](const auto& info) { return info.kind == kind; });
  assert(found != kinds.end());
  return *found;
}

namespace {

void require_values_of_kind(const DistributionSpec& spec) {
  const DistributionKindInfo& info = distribution_kind_info(spec.kind);
  const std::pair<const char*, double> values[] = {
      {"mean", spec.mean}, {"std", spec.std}, {"lower", spec.lower}, {"upper", spec.upper}};
  for (const auto& [name, value] : values) {
    const bool is_needed = std::find(info.required.begin(), info.required.end(), name) != info.required.end();
    require(is_needed || std::isnan(value), "{}: {} was given, but a {} distribution takes {} only", name, value,
            info.name, join(info.required));
    require(!is_needed || !std::isnan(value), "{}: missing; a {} distribution needs {}", name, info.name,
            join(info.required));
    require(!is_needed || std::isfinite(value), "{}: {} must be finite", name, value);
  }
  require(std::isnan(spec.std) || spec.std > 0.0, "std: {} must be positive", spec.std);
  require(std::isnan(spec.lower) || spec.lower < spec.upper, "lower: {} must be below upper, {}", spec.lower,
          spec.upper);
}

}  // namespace

Distribution::Distribution(const DistributionSpec& spec) : spec_(spec) {
  require_values_of_kind(spec);
  implementation_ = make_distribution_family(spec);
}

const DistributionSpec& Distribution::spec() const {
  return spec_;
}

double Distribution::mean() const {
  return implementation_->mean();
}

double Distribution::standard_deviation() const {
  return implementation_->standard_deviation();
}

double Distribution::lower() const {
  return implementation_->lower();
}

double Distribution::upper() const {
  return implementation_->upper();
}

double Distribution::cdf(double value) const {
  return implementation_->cdf(value);
}

double Distribution::pdf(double value) const {
  return implementation_->pdf(value);
}

double Distribution::quantile(double probability) const {
  require(0.0 <= probability && probability <= 1.0, "probability: {} is outside [0, 1]", probability);
  if (probability == 0.0) return lower();
  if (probability == 1.0) return upper();
  // 1 - probability is exact for a double above one half.
  return probability <= 0.5 ? implementation_->lower_tail_quantile(probability)
                            : implementation_->upper_tail_quantile(1.0 - probability);
}

double Distribution::upper_quantile(double probability) const {
  require(0.0 <= probability && probability <= 1.0, "probability: {} is outside [0, 1]", probability);
  if (probability == 0.0) return upper();
  if (probability == 1.0) return lower();
  return probability <= 0.5 ? implementation_->upper_tail_quantile(probability)
                            : implementation_->lower_tail_quantile(1.0 - probability);
}

double Distribution::from_standard_normal(double z) const {
  return implementation_->from_standard_normal(z);
}

}  // namespace mottle::stats
