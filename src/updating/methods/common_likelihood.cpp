#include "updating/methods/common_likelihood.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/stats/distributions/student_t.hpp"
#include "updating/population/population_report.hpp"

namespace mottle::updating {
namespace {

using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

constexpr double k_hundredth = 0.01;  // of the root mean square: the level on which NoiseModel::base stands

/// Samplers would not come to an end: each stage takes as little of the likelihood as the particles bear.
void require_above_rounding(const UpdatingProblem& problem, const std::string& method) {
  constexpr double k_rounding = 1e-10;
  for (Eigen::Index k = 0; k < problem.tests.values.cols(); ++k) {
    const auto sizes = problem.tests.values.col(k).array().abs();
    const double given = problem.tests.repeatability_std(k), size = sizes.isNaN().select(0.0, sizes).maxCoeff();
    require_of(!(given > 0.0) || given >= k_rounding * size, {Subject::Kind::repeatability},
               "the noise of {} is {:.2g}, {:.1g} of its tested values: below {:.0e} of them rounding decides on the "
               "likelihood; correct it (its unit is that of the output), or set {}.noise = \"estimated\"",
               problem.model.outputs()[static_cast<std::size_t>(k)].name(), given, given / size, k_rounding, method);
  }
}

}  // namespace

NoiseLevels::NoiseLevels(const UpdatingProblem& problem, const BayesOptions& options, const std::string& method)
    : options_(options), method_(method) {
  const Eigen::VectorXd& given = problem.tests.repeatability_std;
  const auto p = static_cast<std::size_t>(given.size());
  model_ = known_noise(given.cwiseAbs2());
  std::vector<bool> is_open(p, options.noise == BayesOptions::Noise::estimated);
  std::vector<std::string> unknown;
  if (options.noise != BayesOptions::Noise::estimated) require_above_rounding(problem, method);
  for (std::size_t k = 0; k < p; ++k) {
    if (given(static_cast<Eigen::Index>(k)) > 0.0) continue;
    is_open[k] = true;
    unknown.push_back(problem.model.outputs()[k].name());
  }
  if (options.noise == BayesOptions::Noise::given) {
    require_of(unknown.empty(), {Subject::Kind::repeatability},
               "the noise of {} is not known, and a likelihood needs it; give it, or set {}.noise = \"estimated\"",
               join(unknown), method);
    return;
  }
  model_ = with_levels(problem, std::move(model_), is_open);
  names_.resize(static_cast<std::size_t>(model_.factors));
  for (std::size_t k = 0; k < p; ++k) {
    if (model_.factor[k] < 0) continue;
    const Quantity& output = problem.model.outputs()[k];
    const std::string stem = traits_of(output.kind).stem;
    const bool is_rotational = output.kind == QuantityKind::rotation || output.kind == QuantityKind::static_rotation;
    names_[static_cast<std::size_t>(model_.factor[k])] =
        fmt::format("noise:{}{}", stem.empty() ? "outputs" : stem, is_rotational ? "-rotation" : "");
    require_of(model_.base(static_cast<Eigen::Index>(k)) > 0.0, {Subject::Kind::repeatability},
               "needed for output {}, whose tested values are all 0", output.name());
  }
}

void NoiseLevels::require_above_zero(const Eigen::Ref<const Eigen::MatrixXd>& scores) const {
  constexpr double k_smallest = 1e-4;  // of the prior's median
  constexpr double k_usual = 0.01;     // or of what a test usually has, where the prior allows for far more
  for (Eigen::Index k = 0; k < count(); ++k) {
    require_of(level(scores.col(k).mean()) > k_smallest * std::min(level(0.0), k_usual), {Subject::Kind::repeatability},
               "the level {} has no posterior: the tests are met exactly, or specimens are the same to the last digit, "
               "so that the likelihood grows without end as the noise goes to zero; give repeatability, or set "
               "{}.noise_prior = \"inverse-gamma\"",
               names_[static_cast<std::size_t>(k)], method_);
  }
}

double NoiseLevels::level(double score) const {
  const double nu = options_.noise_degrees_of_freedom;
  if (options_.noise_prior == BayesOptions::NoisePrior::half_t)
    return options_.noise_scale * half_t_of_score(score, nu);
  const boost::math::chi_squared_distribution<double, Policy> chi_squared(
      nu);  // level^2 = scale^2 nu / chi^2: large where chi^2 is small
  const double below = standard_normal_cdf(-score);
  const double value =
      score > 0.0 ? quantile(chi_squared, below) : quantile(complement(chi_squared, standard_normal_cdf(score)));
  return options_.noise_scale * std::sqrt(nu / value);
}

Eigen::VectorXd NoiseLevels::variances(const Eigen::Ref<const Eigen::VectorXd>& levels) const {
  Eigen::VectorXd variances = model_.base;
  for (Eigen::Index k = 0; k < variances.size(); ++k) {
    const int factor = model_.factor[static_cast<std::size_t>(k)];
    if (factor < 0) continue;
    const double ratio = levels(factor) / k_hundredth;
    variances(k) *= ratio * ratio;
  }
  return variances;
}

Eigen::VectorXd NoiseLevels::by_scores(const Eigen::Ref<const Eigen::VectorXd>& by_variances,
                                       const Eigen::Ref<const Eigen::VectorXd>& scores) const {
  constexpr double k_step = 1e-5;  // of a central difference of the smooth level(): 10 digits are left
  Eigen::VectorXd levels(scores.size());
  for (Eigen::Index k = 0; k < scores.size(); ++k) levels(k) = level(scores(k));
  const Eigen::VectorXd values = variances(levels);
  Eigen::VectorXd by_levels = Eigen::VectorXd::Zero(scores.size());
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const int factor = model_.factor[static_cast<std::size_t>(k)];
    if (factor >= 0) by_levels(factor) += by_variances(k) * 2.0 * values(k) / levels(factor);
  }
  for (Eigen::Index k = 0; k < scores.size(); ++k) {
    by_levels(k) *= (level(scores(k) + k_step) - level(scores(k) - k_step)) / (2.0 * k_step);
  }
  return by_levels;
}

CommonLikelihood::CommonLikelihood(const TestData& tests) : model_error_(tests.model_error_variance()) {
  const Eigen::Index p = tests.values.cols();
  count_.resize(p);
  mean_.resize(p);
  scatter_.resize(p);
  for (Eigen::Index k = 0; k < p; ++k) {
    const Eigen::ArrayXd values = tests.values.col(k).array();
    const auto is_missing = values.isNaN();
    count_(k) = static_cast<double>(values.size() - is_missing.count());
    mean_(k) = is_missing.select(0.0, values).sum() / std::max(count_(k), 1.0);
    scatter_(k) = is_missing.select(0.0, (values - mean_(k)).square()).sum();
  }
}

Eigen::VectorXd CommonLikelihood::variance_of_mean(const Eigen::Ref<const Eigen::VectorXd>& variances) const {
  return variances.cwiseQuotient(count_) + model_error_;
}

double CommonLikelihood::log_value(const Eigen::Ref<const Eigen::VectorXd>& outputs,
                                   const Eigen::Ref<const Eigen::VectorXd>& variances) const {
  double sum = 0.0;
  for (Eigen::Index k = 0; k < outputs.size(); ++k) {
    if (count_(k) == 0.0) continue;  // of an output that no specimen has
    if (!std::isfinite(outputs(k))) return -std::numeric_limits<double>::infinity();
    const double n = count_(k);
    const double r = variances(k);
    const double all = r + n * model_error_(k);
    const double apart = mean_(k) - outputs(k);
    sum += n * std::log(2.0 * std::numbers::pi) + (n - 1.0) * std::log(r) + std::log(all) + scatter_(k) / r +
           n * apart * apart / all;
  }
  return -0.5 * sum;
}

CommonLikelihood::Slopes CommonLikelihood::slopes(const Eigen::Ref<const Eigen::VectorXd>& outputs,
                                                  const Eigen::Ref<const Eigen::VectorXd>& variances) const {
  const Eigen::ArrayXd n = count_;
  const Eigen::ArrayXd r = variances;
  const Eigen::ArrayXd all = r + n * model_error_.array();
  const Eigen::ArrayXd apart = mean_ - outputs;
  const Eigen::ArrayXd by_variances =
      -0.5 * ((n - 1.0) / r + all.inverse() - scatter_.array() / r.square() - n * (apart / all).square());
  return {n * apart / all, (n == 0.0).select(0.0, by_variances)};
}

}  // namespace mottle::updating
