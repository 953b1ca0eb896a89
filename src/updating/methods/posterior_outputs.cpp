#include "updating/methods/posterior_outputs.hpp"

#include <cmath>
#include <numbers>

#include "mottle/core/random.hpp"
#include "mottle/core/text.hpp"
#include "updating/estimate/normal_draws.hpp"

namespace mottle::updating {
namespace {

/// Variances of the noise at each draw [draw x output].
Eigen::MatrixXd noise_at(const NoiseLevels& noise, const SampledPosterior& posterior) {
  Eigen::MatrixXd variances(posterior.values.rows(), posterior.outputs.cols());
  for (Eigen::Index s = 0; s < variances.rows(); ++s) {
    variances.row(s) = noise.variances(posterior.values.row(s).tail(noise.count()).transpose()).transpose();
  }
  return variances;
}

/// Given a draw and the tests, d is normal, independently for each output: precision 1 / D + n / r.
Eigen::MatrixXd further_tests(const CommonLikelihood& likelihood, const Eigen::VectorXd& model_error,
                              const Eigen::MatrixXd& variances, const Eigen::MatrixXd& outputs, std::uint64_t seed) {
  constexpr std::uint32_t k_further_tests = 16;  // beyond what the prediction of new specimens uses
  const StreamKey key{.seed = seed, .purpose = StreamPurpose::prediction_noise, .iteration = k_further_tests};
  Eigen::MatrixXd tests(outputs.rows(), outputs.cols());
  for (Eigen::Index s = 0; s < outputs.rows(); ++s) {
    RandomStream stream(key, static_cast<std::uint32_t>(s));
    const Eigen::VectorXd errors = standard_normals(stream, outputs.cols());
    const Eigen::VectorXd noise = standard_normals(stream, outputs.cols());
    for (Eigen::Index k = 0; k < outputs.cols(); ++k) {
      const double f = outputs(s, k);
      const double gain = model_error(k) / (model_error(k) + variances(s, k) / likelihood.count()(k));
      const double shift = gain * (likelihood.mean()(k) - f);
      const double spread = std::sqrt(std::max(model_error(k) * (1.0 - gain), 0.0));
      tests(s, k) = f + shift + spread * errors(k) + std::sqrt(variances(s, k)) * noise(k);
    }
  }
  return tests;
}

/// sum_k ln N(z_sk; f_k, r_k) over the measured outputs [draw x specimen].
Eigen::MatrixXd specimen_likelihoods(const Eigen::MatrixXd& tests, const Eigen::MatrixXd& variances,
                                     const Eigen::MatrixXd& outputs) {
  Eigen::MatrixXd logs = Eigen::MatrixXd::Zero(outputs.rows(), tests.rows());
  for (Eigen::Index i = 0; i < tests.rows(); ++i) {
    for (Eigen::Index k = 0; k < tests.cols(); ++k) {
      if (std::isnan(tests(i, k))) continue;
      const auto r = variances.col(k).array();
      const auto apart = outputs.col(k).array() - tests(i, k);
      logs.col(i).array() -= 0.5 * ((2.0 * std::numbers::pi * r).log() + apart.square() / r);
    }
  }
  return logs;
}

std::string why_not_left_out(const TestData& tests, const Eigen::MatrixXd& outputs) {
  if (tests.values.rows() < 2) {
    return "Leave-one-out needs two specimens; there is one.";
  }
  if (tests.has_model_error()) {
    return "There is no leave-one-out: the model's error ([test] model_error) is shared by all specimens, which are "
           "therefore not independent given the parameters.";
  }
  if (!outputs.allFinite()) {
    return "There is no leave-one-out: the model failed at a draw of the posterior when it was run there again.";
  }
  return {};
}

}  // namespace

std::int64_t add_outputs(const UpdatingProblem& problem, const NoiseLevels& noise, const CommonLikelihood& likelihood,
                         const RunContext& context, SampledPosterior& posterior) {
  posterior.outputs = problem.model.evaluate(posterior.values.leftCols(problem.space.count()), context).outputs;
  const Eigen::MatrixXd variances = noise_at(noise, posterior);
  posterior.replicates =
      further_tests(likelihood, problem.tests.model_error_variance(), variances, posterior.outputs, context.seed);
  posterior.not_left_out = why_not_left_out(problem.tests, posterior.outputs);
  if (posterior.not_left_out.empty()) {
    add_specimens(specimen_likelihoods(problem.tests.values, variances, posterior.outputs), posterior);
  }
  return posterior.outputs.rows();
}

void note_specimens(const TestData& tests, const SampledPosterior& posterior, UpdatingResult& result) {
  if (!posterior.leave_one_out) return;
  std::vector<std::string> doubtful;
  for (Eigen::Index i = 0; i < tests.values.rows(); ++i) {
    const double k = posterior.leave_one_out->pareto_k(i);
    if (k > k_unreliable_pareto_k) doubtful.push_back(fmt::format("{} ({:.2f})", tests.number_of(i), k));
  }
  if (doubtful.empty()) return;
  result.notes.push_back(fmt::format(
      "Leave-one-out and WAIC are not to be relied on: the posterior without a specimen differs too much from "
      "that with it to be had by re-weighting. Specimens with a Pareto k above {}: {}.",
      k_unreliable_pareto_k, join(doubtful)));
}

}  // namespace mottle::updating
