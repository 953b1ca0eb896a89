#include "mottle/updating/estimate/population_posterior.hpp"

#include "mottle/core/error.hpp"
#include "updating/estimate/normal_draws.hpp"

namespace mottle::updating {

PopulationPosterior::PopulationPosterior(std::vector<ParameterTransform> scales, PopulationOnScales typical,
                                         PopulationDraws draws, double log_evidence)
    : scales_(std::move(scales)),
      typical_(scales_, std::move(typical), 0),
      draws_(std::move(draws)),
      log_evidence_(log_evidence) {
  require(draws_.means.rows() > 0 && draws_.means.rows() == static_cast<Eigen::Index>(draws_.factors.size()),
          "draws: {} means and {} covariances", draws_.means.rows(), draws_.factors.size());
}

Eigen::MatrixXd PopulationPosterior::draw_specimens(const SpecimenDrawing& drawing) const {
  if (drawing.kind == SpecimenDrawing::Kind::population) return typical_.draw_specimens(drawing);
  const StreamKey key{.seed = drawing.seed,
                      .purpose = StreamPurpose::prediction,
                      .iteration = static_cast<std::uint32_t>(drawing.kind)};
  Eigen::MatrixXd points(drawing.draws, draws_.means.cols());
  const auto count = static_cast<double>(draws_.means.rows());
  for (Eigen::Index s = 0; s < points.rows(); ++s) {
    RandomStream stream(key, static_cast<std::uint32_t>(s));
    const auto draw = static_cast<Eigen::Index>(stream.uniform() * count);
    Eigen::VectorXd mean = draws_.means.row(draw);
    // What the model's error makes of the mean comes with the error itself, since the predicted outputs have it too.
    if (drawing.has_model_error && draws_.shifts.size() > 0) mean -= draws_.shifts.row(draw).transpose();
    if (drawing.mean_shift.size() > 0) mean += drawing.mean_shift.row(s).transpose();
    points.row(s) =
        (mean + draws_.factors[static_cast<std::size_t>(draw)] * standard_normals(stream, mean.size())).transpose();
  }
  return to_variables(scales_, points);
}

}  // namespace mottle::updating
