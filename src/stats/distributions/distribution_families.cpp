#include "stats/distributions/distribution_families.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "stats/distributions/incomplete_functions.hpp"
#include "stats/distributions/truncated_moments.hpp"

namespace mottle::stats {

double Distribution::Implementation::cdf(double value) const {
  if (value <= lower()) return 0.0;
  return value >= upper() ? 1.0 : cdf_inside(value);
}

double Distribution::Implementation::pdf(double value) const {
  return lower() < value && value <= upper() ? pdf_inside(value) : 0.0;
}

double Distribution::Implementation::from_standard_normal(double z) const {
  return z <= 0.0 ? lower_tail_quantile(standard_normal_cdf(z)) : upper_tail_quantile(standard_normal_cdf(-z));
}

namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();

class NormalFamily : public Distribution::Implementation {
 public:
  explicit NormalFamily(const DistributionSpec& spec)
      : Implementation({spec.mean, spec.std, -k_infinity, k_infinity}) {}
  double lower_tail_quantile(double probability) const override {
    return from_standard_normal(standard_normal_quantile(probability));
  }
  double upper_tail_quantile(double probability) const override {
    return from_standard_normal(-standard_normal_quantile(probability));
  }
  double from_standard_normal(double z) const override { return mean() + standard_deviation() * z; }

 private:
  double score(double value) const { return (value - mean()) / standard_deviation(); }
  double cdf_inside(double value) const override { return standard_normal_cdf(score(value)); }
  double pdf_inside(double value) const override {
    // As OpenTURNS rounds it, so that results keep their bits: standard_normal_pdf() divides by the root.
    constexpr double k_peak = 0.39894228040143267794;  // 1 / sqrt(2 pi)
    const double z = score(value);
    return k_peak * std::exp(-0.5 * z * z) / standard_deviation();
  }
};

/// X = exp(N(log_mean, log_std)), log_std^2 = log(1 + (std / mean)^2), log_mean = log(mean) - log_std^2 / 2.
class LognormalFamily : public Distribution::Implementation {
 public:
  explicit LognormalFamily(const DistributionSpec& spec)
      : LognormalFamily(spec, std::log1p(spec.std / spec.mean * (spec.std / spec.mean))) {}
  double lower_tail_quantile(double probability) const override {
    return from_standard_normal(standard_normal_quantile(probability));
  }
  double upper_tail_quantile(double probability) const override {
    return from_standard_normal(-standard_normal_quantile(probability));
  }
  double from_standard_normal(double z) const override { return std::exp(log_mean_ + log_std_ * z); }

 private:
  LognormalFamily(const DistributionSpec& spec, double log_variance)
      : Implementation({spec.mean, spec.std, 0.0, k_infinity}),
        log_mean_(std::log(spec.mean) - 0.5 * log_variance),
        log_std_(std::sqrt(log_variance)) {}
  double score(double value) const { return (std::log(value) - log_mean_) / log_std_; }
  double cdf_inside(double value) const override { return standard_normal_cdf(score(value)); }
  double pdf_inside(double value) const override { return standard_normal_pdf(score(value)) / (log_std_ * value); }
  double log_mean_;
  double log_std_;
};

class UniformFamily : public Distribution::Implementation {
 public:
  explicit UniformFamily(const DistributionSpec& spec)
      : Implementation(
            {0.5 * spec.lower + 0.5 * spec.upper, (spec.upper - spec.lower) / std::sqrt(12.0), spec.lower, spec.upper}),
        width_(spec.upper - spec.lower) {}
  double lower_tail_quantile(double probability) const override { return lower() + width_ * probability; }
  double upper_tail_quantile(double probability) const override { return upper() - width_ * probability; }

 private:
  double cdf_inside(double value) const override { return (value - lower()) / width_; }
  double pdf_inside(double /*value*/) const override { return 1.0 / width_; }
  double width_;
};

/// Parent normal cut at both ends; both tails of the parent are kept so that no probability near 1 is ever formed.
class TruncatedNormalFamily : public Distribution::Implementation {
 public:
  explicit TruncatedNormalFamily(const DistributionSpec& spec)
      : TruncatedNormalFamily(spec, truncated_moments(spec.mean, spec.std, spec.lower, spec.upper)) {}
  double lower_tail_quantile(double probability) const override {
    return at(below_lower_ + probability * mass(), above_lower_ - probability * mass());
  }
  double upper_tail_quantile(double probability) const override {
    return at(below_upper_ - probability * mass(), above_upper_ + probability * mass());
  }

 private:
  TruncatedNormalFamily(const DistributionSpec& spec, const TruncatedMoments& moments)
      : Implementation({moments.mean, moments.standard_deviation, spec.lower, spec.upper}),
        spec_(spec),
        below_lower_(standard_normal_cdf(score(spec.lower))),
        above_lower_(standard_normal_cdf(-score(spec.lower))),
        below_upper_(standard_normal_cdf(score(spec.upper))),
        above_upper_(standard_normal_cdf(-score(spec.upper))) {}
  double score(double value) const { return (value - spec_.mean) / spec_.std; }
  double mass() const { return below_lower_ < 0.5 ? below_upper_ - below_lower_ : above_lower_ - above_upper_; }
  double at(double below, double above) const {
    const double z = below < 0.5 ? standard_normal_quantile(below) : -standard_normal_quantile(above);
    return std::clamp(spec_.mean + spec_.std * z, spec_.lower, spec_.upper);
  }
  double cdf_inside(double value) const override {
    const double z = score(value);
    return (z < 0.0 ? standard_normal_cdf(z) - below_lower_ : above_lower_ - standard_normal_cdf(-z)) / mass();
  }
  double pdf_inside(double value) const override { return standard_normal_pdf(score(value)) / (spec_.std * mass()); }
  DistributionSpec spec_;
  double below_lower_;
  double above_lower_;
  double below_upper_;
  double above_upper_;
};

/// Two shape parameters on [lower, upper] by moments: with m the scaled mean and v the scaled variance,
/// concentration = m (1 - m) / v - 1, first = m concentration, second = (1 - m) concentration.
class BetaFamily : public Distribution::Implementation {
 public:
  explicit BetaFamily(const DistributionSpec& spec) : BetaFamily(spec, concentration(spec)) {}
  double lower_tail_quantile(double probability) const override {
    return lower() + width() * standard_beta_quantile(first_, second_, probability);
  }
  double upper_tail_quantile(double probability) const override {
    // Counted from the upper end, where the beta with exchanged shapes has its lower tail: no digit is lost there.
    return upper() - width() * standard_beta_quantile(second_, first_, probability);
  }

 private:
  static double concentration(const DistributionSpec& spec) {
    return (spec.mean - spec.lower) / spec.std * ((spec.upper - spec.mean) / spec.std) - 1.0;
  }
  BetaFamily(const DistributionSpec& spec, double concentration)
      : Implementation({spec.mean, spec.std, spec.lower, spec.upper}),
        first_(concentration * (spec.mean - spec.lower) / (spec.upper - spec.lower)),
        second_(concentration * (spec.upper - spec.mean) / (spec.upper - spec.lower)) {}
  double width() const { return upper() - lower(); }
  double cdf_inside(double value) const override {
    return standard_beta_cdf(first_, second_, (value - lower()) / width(), (upper() - value) / width());
  }
  double pdf_inside(double value) const override {
    if (value == upper()) return 0.0;  // its limit is 0, or infinite
    return standard_beta_pdf(first_, second_, (value - lower()) / width(), (upper() - value) / width()) / width();
  }
  double first_;
  double second_;
};

/// shape = (mean / std)^2, rate = mean / std^2.
class GammaFamily : public Distribution::Implementation {
 public:
  explicit GammaFamily(const DistributionSpec& spec)
      : Implementation({spec.mean, spec.std, 0.0, k_infinity}),
        shape_(spec.mean / spec.std * (spec.mean / spec.std)),
        rate_(spec.mean / spec.std / spec.std) {}
  double lower_tail_quantile(double probability) const override {
    return standard_gamma_quantile(shape_, probability) / rate_;
  }
  double upper_tail_quantile(double probability) const override {
    return standard_gamma_upper_quantile(shape_, probability) / rate_;
  }

 private:
  double cdf_inside(double value) const override { return standard_gamma_cdf(shape_, rate_ * value); }
  double pdf_inside(double value) const override { return rate_ * standard_gamma_pdf(shape_, rate_ * value); }
  double shape_;
  double rate_;
};

/// Squares and logarithms of what lies beyond are no numbers.
void require_sizes(const DistributionSpec& spec) {
  constexpr double k_max = 1e150;
  const bool is_between = spec.kind == DistributionKind::uniform || spec.kind == DistributionKind::beta;
  const double not_used = std::nan("");
  const std::array<std::pair<const char*, double>, 4> sizes{{{"mean", spec.mean},
                                                             {"std", spec.std},
                                                             {"lower", is_between ? spec.lower : not_used},
                                                             {"upper", is_between ? spec.upper : not_used}}};
  for (const auto& [key, value] : sizes) {
    const double size = std::abs(value);
    require(!std::isfinite(value) || value == 0.0 || (size <= k_max && size >= 1.0 / k_max),
            "{}: {} is not 0 and not within 1e-150 and 1e150 in size; give the model other units", key, value);
  }
}

void require_lognormal_exists(const DistributionSpec& spec) {
  require(spec.mean > 0.0, "mean: {} of a lognormal distribution must be positive", spec.mean);
  require(spec.std <= 1e3 * spec.mean, "std: {} of a lognormal distribution must be at most 1e3 times the mean, {}",
          spec.std, spec.mean);
}

void require_truncation_leaves_mass(const DistributionSpec& spec) {
  const double from = (spec.lower - spec.mean) / spec.std;
  const double to = (spec.upper - spec.mean) / spec.std;
  const double mass = from > 0.0 ? standard_normal_cdf(-from) - standard_normal_cdf(-to)
                                 : standard_normal_cdf(to) - standard_normal_cdf(from);
  require(mass >= 1e-10,
          "lower, upper: [{}, {}] holds only {:.3g} of the normal with mean {} and std {}; move the bounds or the mean",
          spec.lower, spec.upper, mass, spec.mean, spec.std);
}

void require_beta_exists(const DistributionSpec& spec) {
  require(spec.lower < spec.mean && spec.mean < spec.upper, "mean: {} is outside ({}, {})", spec.mean, spec.lower,
          spec.upper);
  const double concentration = (spec.mean - spec.lower) / spec.std * ((spec.upper - spec.mean) / spec.std) - 1.0;
  require(concentration > 1e-6,
          "std: {} is too large for a beta distribution with mean {} on [{}, {}]; must be below {:.6g}", spec.std,
          spec.mean, spec.lower, spec.upper, std::sqrt(spec.mean - spec.lower) * std::sqrt(spec.upper - spec.mean));
  require(concentration < 1e8,
          "std: {} is too small for a beta distribution with mean {} on [{}, {}]; use truncated-normal", spec.std,
          spec.mean, spec.lower, spec.upper);
}

void require_gamma_exists(const DistributionSpec& spec) {
  require(spec.mean > 0.0, "mean: {} of a gamma distribution must be positive", spec.mean);
  require(1e-4 * spec.mean <= spec.std && spec.std <= 1e3 * spec.mean,
          "std: {} of a gamma distribution must be within 1e-4 and 1e3 of the mean, {}; below, use normal", spec.std,
          spec.mean);
}

}  // namespace

std::shared_ptr<const Distribution::Implementation> make_distribution_family(const DistributionSpec& spec) {
  require_sizes(spec);
  switch (spec.kind) {
    case DistributionKind::normal:
      return std::make_shared<NormalFamily>(spec);
    case DistributionKind::lognormal:
      require_lognormal_exists(spec);
      return std::make_shared<LognormalFamily>(spec);
    case DistributionKind::uniform:
      return std::make_shared<UniformFamily>(spec);
    case DistributionKind::truncated_normal:
      require_truncation_leaves_mass(spec);
      return std::make_shared<TruncatedNormalFamily>(spec);
    case DistributionKind::beta:
      require_beta_exists(spec);
      return std::make_shared<BetaFamily>(spec);
    case DistributionKind::gamma:
      require_gamma_exists(spec);
      return std::make_shared<GammaFamily>(spec);
  }
  throw InvalidInput("kind: not a distribution");
}

}  // namespace mottle::stats
