#include "mottle/updating/methods/cloud.hpp"

#include "mottle/core/error.hpp"

namespace mottle::updating {
namespace {

void require_enough_runs(const Cloud& cloud, double max_failed) {
  const auto failed = static_cast<double>(cloud.failures.size());
  const auto total = static_cast<double>(cloud.samples.rows());
  if (cloud.failures.empty() || (failed <= max_failed * total && failed < total)) return;
  throw ModelFailure(
      fmt::format("{} of {} model runs failed, at most {:.3g} % may (max_failed); the first, sample {}: {}", failed,
                  total, 100.0 * max_failed, cloud.failures.front().sample, cloud.failures.front().reason));
}

}  // namespace

Cloud::Valid Cloud::valid() const {
  if (failures.empty()) return {samples, outputs};
  Valid valid;
  const Eigen::Index rows = samples.rows() - static_cast<Eigen::Index>(failures.size());
  valid.samples.resize(rows, samples.cols());
  valid.outputs.resize(rows, outputs.cols());
  auto failure = failures.begin();
  for (Eigen::Index s = 0, row = 0; s < samples.rows(); ++s) {
    if (failure != failures.end() && failure->sample == s) {
      ++failure;
      continue;
    }
    valid.samples.row(row) = samples.row(s);
    valid.outputs.row(row++) = outputs.row(s);
  }
  return valid;
}

Cloud evaluate_cloud(const Model& model, const ParameterSpace& space, const JointDistribution& distribution,
                     const CloudSettings& settings, const StreamKey& key, const RunContext& context) {
  return evaluate_cloud(
      model, space,
      [&](const Eigen::Ref<const Eigen::MatrixXd>& uniforms) { return distribution.from_uniform(uniforms); }, settings,
      key, context);
}

Cloud evaluate_cloud(const Model& model, const ParameterSpace& space, const SampleTransform& from_uniform,
                     const CloudSettings& settings, const StreamKey& key, const RunContext& context) {
  ParameterDraw draw = space.draw(from_uniform, settings.design, settings.samples, key);
  Cloud cloud = evaluate_points(model, draw.samples, settings.max_failed, context);
  cloud.rejected = draw.rejected;
  return cloud;
}

Cloud evaluate_points(const Model& model, const Eigen::Ref<const Eigen::MatrixXd>& points, double max_failed,
                      const RunContext& context) {
  require(points.cols() == model.parameter_count(), "{} columns of parameters given, the model has {}", points.cols(),
          model.parameter_count());
  Evaluation evaluation = model.evaluate(points, context);
  Cloud cloud{points, std::move(evaluation.outputs), std::move(evaluation.failures), std::move(evaluation.notes), 0};
  require_enough_runs(cloud, max_failed);
  return cloud;
}

}  // namespace mottle::updating
