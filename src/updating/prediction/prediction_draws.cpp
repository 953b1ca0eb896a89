#include "updating/prediction/prediction_draws.hpp"

#include "mottle/core/error.hpp"
#include "updating/estimate/normal_draws.hpp"

namespace mottle::updating {

PredictiveDraws::PredictiveDraws(const Model& model, const ParameterSpace& space, const Estimate& estimate,
                                 const PredictionSettings& settings, const RunContext& context)
    : model_(model), space_(space), estimate_(estimate), settings_(settings), context_(context) {
  if (!settings.model_error) return;
  const ModelError& error = settings.model_error->estimate;
  error_root_ = scaled_root(error.covariance, (error.std.array() > 0.0).select(error.std, 1.0));
}

/// The error of the tested outputs in one draw; its estimate where estimates are taken as exact.
Eigen::VectorXd PredictiveDraws::shared_error(Kind kind, Eigen::Index draw) const {
  const ModelError& error = settings_.model_error->estimate;
  if (kind == Kind::population) return error.shift;
  const StreamKey key{
      .seed = context_.seed, .purpose = StreamPurpose::prediction, .iteration = 8 + static_cast<std::uint32_t>(kind)};
  RandomStream stream(key, static_cast<std::uint32_t>(draw));
  return error.shift + error_root_ * standard_normals(stream, error.shift.size());
}

/// @param draws  of each row of the outputs
void PredictiveDraws::add_model_error(Kind kind, const std::vector<Eigen::Index>& draws,
                                      Eigen::MatrixXd& outputs) const {
  const PredictedError& error = *settings_.model_error;
  const StreamKey key{.seed = context_.seed,
                      .purpose = StreamPurpose::prediction_noise,
                      .iteration = 8 + static_cast<std::uint32_t>(kind)};
  for (Eigen::Index row = 0; row < outputs.rows(); ++row) {
    const Eigen::Index draw = draws[static_cast<std::size_t>(row)];
    const Eigen::VectorXd shared = shared_error(kind, draw);
    for (std::size_t k = 0; k < error.tested.size(); ++k) {
      if (error.tested[k] >= 0) outputs(row, static_cast<Eigen::Index>(k)) += shared(error.tested[k]);
    }
    if (kind == Kind::population) continue;
    RandomStream stream(key, static_cast<std::uint32_t>(draw));
    outputs.row(row) += standard_normals(stream, outputs.cols()).cwiseProduct(error.own_std).transpose();
  }
}

Eigen::MatrixXd PredictiveDraws::points(Kind kind) const {
  SpecimenDrawing drawing{.kind = kind,
                          .draws = settings_.draws,
                          .seed = context_.seed,
                          .has_model_error = settings_.model_error.has_value()};
  if (settings_.model_error && kind != Kind::population && estimate_.population() != nullptr) {
    const ModelError& error = settings_.model_error->estimate;
    drawing.mean_shift.resize(settings_.draws, estimate_.parameter_count());
    for (Eigen::Index s = 0; s < settings_.draws; ++s) {
      drawing.mean_shift.row(s) = (error.gain * (shared_error(kind, s) - error.shift)).transpose();
    }
  }
  return estimate_.draw_specimens(drawing);
}

Eigen::MatrixXd PredictiveDraws::draw(Kind kind, Prediction& prediction) const {
  const Eigen::MatrixXd x = points(kind);
  std::vector<Eigen::Index> possible;
  for (Eigen::Index s = 0; s < x.rows(); ++s) {
    if (x.row(s).allFinite() && space_.is_possible(x.row(s))) possible.push_back(s);
  }
  Eigen::MatrixXd outputs = model_.evaluate(x(possible, Eigen::all), context_).outputs;
  prediction.model_evaluations += outputs.rows();
  if (settings_.model_error) add_model_error(kind, possible, outputs);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index s = 0; s < outputs.rows(); ++s) {
    if (outputs.row(s).allFinite()) kept.push_back(s);
  }
  prediction.impossible += settings_.draws - static_cast<Eigen::Index>(kept.size());
  if (2 * static_cast<Eigen::Index>(kept.size()) < settings_.draws) {
    throw ModelFailure(
        fmt::format("predict: {} of {} draws of new specimens are physically impossible or fail in the "
                    "model; the population is too wide",
                    settings_.draws - static_cast<Eigen::Index>(kept.size()), settings_.draws));
  }
  outputs = outputs(kept, Eigen::all).eval();
  if (kind == Kind::population) return outputs;
  const StreamKey key{
      .seed = context_.seed, .purpose = StreamPurpose::prediction_noise, .iteration = static_cast<std::uint32_t>(kind)};
  for (Eigen::Index s = 0; s < outputs.rows(); ++s) {
    RandomStream stream(key, static_cast<std::uint32_t>(s));
    outputs.row(s) += standard_normals(stream, outputs.cols()).cwiseProduct(settings_.noise_std).transpose();
  }
  return outputs;
}

}  // namespace mottle::updating
