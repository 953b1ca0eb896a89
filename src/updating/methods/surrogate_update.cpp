#include "mottle/updating/methods/surrogate_update.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"
#include "mottle/stats/sampling/sampling.hpp"

namespace mottle::updating {
namespace {

constexpr Eigen::Index k_min_check = 10;

/// x drawn in to where the parameter's scale is finite: a surrogate is fitted on the scales.
double within_scale(const ParameterSpace& space, Eigen::Index parameter, double x) {
  constexpr double k_reach = 10.0;  // on the scale: beyond it a logit is at its bound but for 5e-5 of its width
  const ParameterTransform scale = space.parameters()[static_cast<std::size_t>(parameter)].transform;
  if (scale.kind == ParameterTransform::Kind::identity) return x;
  const bool is_log = scale.kind == ParameterTransform::Kind::log;
  const double middle = is_log ? scale.from_variable(space.prior().mean()(parameter)) : 0.0;
  const double upper = is_log ? std::numeric_limits<double>::infinity() : scale.to_variable(k_reach);
  return std::clamp(x, scale.to_variable(middle - k_reach), upper);
}

/// The design's ends on the standard normal axis of one parameter, drawn in to what is physically possible and to where
/// its scale is finite.
double possible_end(const ParameterSpace& space, Eigen::Index parameter, double end) {
  const Distribution& marginal = space.prior().marginals()[static_cast<std::size_t>(parameter)];
  Eigen::VectorXd x = space.prior().mean();
  for (; std::abs(end) > 1e-3; end *= 0.9) {
    x(parameter) = marginal.from_standard_normal(end);
    if (space.is_possible(x.transpose()) && within_scale(space, parameter, x(parameter)) == x(parameter)) break;
  }
  return end;
}

double spread_of(const Eigen::Ref<const Eigen::VectorXd>& values) {
  const Eigen::Index n = values.size();
  return n < 2 ? 0.0 : std::sqrt((values.array() - values.mean()).square().sum() / static_cast<double>(n - 1));
}

/// Standard deviation of each output as the surrogate has it over that of the model, less 1. Points are the same, so
/// that few of them tell it. 0 where the model's scatter is less than a tenth of the tests': what it is matters little.
Eigen::VectorXd scatter_errors(const Eigen::MatrixXd& surrogate, const Eigen::MatrixXd& model,
                               const Eigen::VectorXd& scatter) {
  constexpr double k_small = 0.1;
  return Eigen::VectorXd::NullaryExpr(model.cols(), [&](Eigen::Index k) {
    const double own = spread_of(model.col(k));
    return own > k_small * scatter(k) ? spread_of(surrogate.col(k)) / own - 1.0 : 0.0;
  });
}

Eigen::VectorXd root_mean_square(const Eigen::Ref<const Eigen::MatrixXd>& residuals) {
  return (residuals.colwise().squaredNorm() / static_cast<double>(residuals.rows())).cwiseSqrt().transpose();
}

}  // namespace

SurrogateUpdate::SurrogateUpdate(const UpdatingProblem& problem, const SurrogateSettings& settings)
    : given_(problem),
      settings_(settings),
      model_(problem.model, problem.space),
      problem_(problem.with_model(model_, nullptr)) {}

void SurrogateUpdate::add_runs(const Eigen::MatrixXd& samples, const RunContext& context) {
  context.phase({.name = "runs for the surrogate"});
  const Cloud cloud = evaluate_points(given_.model, samples, given_.cloud.max_failed, context);
  evaluations_ += samples.rows();
  if (!cloud.failures.empty()) {
    context.warning(fmt::format("{} of {} runs for the surrogate failed and are left out; the first: {}",
                                cloud.failures.size(), samples.rows(), cloud.failures.front().reason));
  }
  const Cloud::Valid valid = cloud.valid();
  const Eigen::Index before = samples_.rows();
  samples_.conservativeResize(before + valid.samples.rows(), samples.cols());
  samples_.bottomRows(valid.samples.rows()) = valid.samples;
  outputs_.conservativeResize(before + valid.outputs.rows(), valid.outputs.cols());
  outputs_.bottomRows(valid.outputs.rows()) = valid.outputs;
}

void SurrogateUpdate::run_design(const RunContext& context) {
  const ParameterSpace& space = given_.space;
  const Eigen::Index q = space.count();
  const Eigen::Index least = Surrogate::min_runs(settings_.kind, q);
  require_of(settings_.runs == 0 || settings_.runs >= least, {Subject::Kind::surrogate_runs},
             "{} are too few for {} parameters, at least {} are needed", settings_.runs, q, least);
  const Eigen::Index runs = settings_.runs > 0 ? settings_.runs : std::max<Eigen::Index>(10 * q, least + least / 2);
  const StreamKey key{.seed = context.seed, .purpose = StreamPurpose::surrogate_runs};
  Eigen::MatrixXd samples = uniform_design(SamplingDesign::latin_hypercube, runs, q, key);
  for (Eigen::Index i = 0; i < q; ++i) {
    const double lower = possible_end(space, i, -settings_.spread);
    const double upper = possible_end(space, i, settings_.spread);
    const Distribution& marginal = space.prior().marginals()[static_cast<std::size_t>(i)];
    samples.col(i) =
        samples.col(i).unaryExpr([&](double u) { return marginal.from_standard_normal(lower + u * (upper - lower)); });
  }
  add_runs(samples, context);
  first_near_ = samples_.rows();
}

void SurrogateUpdate::fit() {
  model_.train(settings_.kind, samples_, outputs_);
  const Eigen::MatrixXd& residuals = model_.surrogate().left_out_residuals();
  const bool has_near = samples_.rows() - first_near_ >= k_min_check;
  Eigen::VectorXd error =
      root_mean_square(residuals.bottomRows(has_near ? residuals.rows() - first_near_ : residuals.rows()));
  // Both were seen at runs that took no part, by fits to fewer runs than this one.
  if (has_near) error = error.cwiseMin(rounds_.back().error_at_estimate);
  rounds_.push_back({samples_.rows(), error, {}, {}});
  const bool may_be_estimated = error.size() > given_.space.count();
  for (Eigen::Index k = 0; k < error.size(); ++k) {
    const double known = given_.tests.repeatability_std(k);
    if (known > 0.0 || !may_be_estimated) problem_.tests.repeatability_std(k) = std::hypot(known, error(k));
  }
}

/// Standard deviations of the tests; of the runs where there are no two tests.
Eigen::VectorXd SurrogateUpdate::scatter() const {
  Eigen::VectorXd standard_deviation(outputs_.cols());
  for (Eigen::Index k = 0; k < standard_deviation.size(); ++k) {
    std::vector<Eigen::Index> rows;
    for (Eigen::Index s = 0; s < given_.tests.values.rows(); ++s) {
      if (!std::isnan(given_.tests.values(s, k))) rows.push_back(s);
    }
    standard_deviation(k) = spread_of(given_.tests.values(rows, k));
    if (!(standard_deviation(k) > 0.0)) standard_deviation(k) = spread_of(outputs_.col(k));
  }
  return standard_deviation;
}

void SurrogateUpdate::check(const UpdatingResult& result, const RunContext& context) {
  constexpr double k_min_spread = 0.05;  // of the prior's: an estimate may have no scatter at all
  Eigen::MatrixXd covariance = result.covariance;
  covariance.diagonal() += k_min_spread * k_min_spread * given_.space.prior().covariance().diagonal();
  const auto round = static_cast<std::uint32_t>(rounds_.size());
  const Eigen::Index points = std::max<Eigen::Index>(k_min_check, 2 * result.mean.size());
  const ParameterDraw draw = given_.space.draw(
      JointDistribution::multivariate_normal(result.mean, covariance), SamplingDesign::latin_hypercube, points,
      {.seed = context.seed, .purpose = StreamPurpose::surrogate_runs, .iteration = round});
  Eigen::MatrixXd samples = draw.samples;
  for (Eigen::Index i = 0; i < samples.cols(); ++i) {
    samples.col(i) = samples.col(i).unaryExpr([&](double x) { return within_scale(given_.space, i, x); });
  }
  const Eigen::Index before = samples_.rows();
  add_runs(samples, context);
  const Eigen::Index added = samples_.rows() - before;
  const Eigen::MatrixXd said = model_.evaluate(samples_.bottomRows(added), context).outputs;
  SurrogateRound& last = rounds_.back();
  last.error_at_estimate = root_mean_square(said - outputs_.bottomRows(added));
  const Eigen::VectorXd of_tests = scatter();
  last.scatter_error_at_estimate = scatter_errors(said, outputs_.bottomRows(added), of_tests);
  const double worst = last.error_at_estimate.cwiseQuotient(of_tests).maxCoeff();
  const double worst_scatter = last.scatter_error_at_estimate.cwiseAbs().maxCoeff();
  is_good_ = worst <= settings_.tolerance && worst_scatter <= settings_.tolerance;
  context.note(
      fmt::format("surrogate of {} runs: at the estimate off by up to {:.2g} of the tests' scatter, its standard "
                  "deviations by up to {:.2g} % ({} new runs)",
                  last.runs, worst, 100.0 * worst_scatter, added));
}

UpdatingResult SurrogateUpdate::run(const Updater& method, const RunContext& context) {
  run_design(context);
  for (int round = 0;; ++round) {
    fit();
    UpdatingResult result = method.update(problem_, context);
    if (result.status == UpdatingStatus::stopped) return result;
    check(result, context);
    result.model_evaluations = evaluations_;
    // The first round carries the error of the whole design, far from the estimate: too much noise, too little scatter.
    if ((!is_good_ || round == 0) && round < settings_.rounds) continue;
    result.notes.push_back(
        fmt::format("A surrogate fitted to {} model runs stood in for the model; its error is counted as noise of "
                    "the tests.",
                    rounds_.back().runs));
    if (!is_good_) {
      const std::string text = fmt::format(
          "The surrogate is still off by more than {:.2g} of the tests' scatter after {} refinements, or its standard "
          "deviation of an output by more than {:.2g} %: give more runs, another kind or a narrower prior.",
          settings_.tolerance, settings_.rounds, 100.0 * settings_.tolerance);
      result.notes.push_back(text);
      context.warning(text);
    }
    return result;
  }
}

}  // namespace mottle::updating
