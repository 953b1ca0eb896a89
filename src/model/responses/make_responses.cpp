// Every kind of response, in the order of the outputs.
#include <set>

#include "model/responses/damping_ratios.hpp"
#include "model/responses/eigenvalues.hpp"
#include "model/responses/mode_shapes.hpp"
#include "model/responses/natural_frequencies.hpp"
#include "model/responses/shape_directions.hpp"
#include "model/responses/shape_ratios.hpp"
#include "model/responses/static_displacements.hpp"
#include "mottle/core/subject.hpp"

namespace mottle::model {
namespace {

void require_modes(const std::vector<int>& modes, const Subject& subject, Eigen::Index available) {
  std::set<int> seen;
  for (const int mode : modes) {
    require_of(mode >= 1 && mode <= available, subject, "mode {} is not there, the model has modes 1 to {}", mode,
               available);
    require_of(seen.insert(mode).second, subject, "mode {} is given twice", mode);
  }
}

}  // namespace

std::vector<std::unique_ptr<Response>> make_responses(const OutputSelection& selection, const Structure& structure) {
  const Eigen::Index available = structure.mode_count();
  require_modes(selection.frequencies, {Subject::Kind::frequencies}, available);
  require_modes(selection.shape_modes, {Subject::Kind::shape_modes}, available);
  require_modes(selection.damping, {Subject::Kind::damping}, available);
  require_modes(selection.eigenvalues, {Subject::Kind::outputs, "eigenvalues"}, available);
  require_of(!selection.frequencies.empty() || !selection.shape_modes.empty() || !selection.damping.empty() ||
                 !selection.static_loads.empty() || !selection.eigenvalues.empty() || !selection.shape_ratios.empty(),
             {Subject::Kind::outputs}, "none is named; give for example frequencies = [1, 2]");
  std::vector<std::unique_ptr<Response>> responses;
  if (!selection.frequencies.empty()) {
    responses.push_back(std::make_unique<NaturalFrequencies>(selection.frequencies, selection.units.frequency));
  }
  if (!selection.shape_modes.empty() || !selection.shape_degrees_of_freedom.empty()) {
    ModeShapes shapes(selection.shape_modes, selection.shape_degrees_of_freedom, selection.units.shape, structure);
    if (selection.shape_size == ShapeSize::free) {
      responses.push_back(std::make_unique<ShapeDirections>(std::move(shapes)));
    } else {
      responses.push_back(std::make_unique<ModeShapes>(std::move(shapes)));
    }
  }
  if (!selection.damping.empty()) responses.push_back(std::make_unique<DampingRatios>(selection.damping, structure));
  if (!selection.static_loads.empty()) {
    responses.push_back(std::make_unique<StaticDisplacements>(selection.static_loads, selection.units, structure));
  }
  if (!selection.eigenvalues.empty()) {
    responses.push_back(std::make_unique<Eigenvalues>(selection.eigenvalues, selection.units.eigenvalue));
  }
  if (!selection.shape_ratios.empty()) {
    responses.push_back(std::make_unique<ShapeRatios>(selection.shape_ratios, selection.units.length, structure));
  }
  return responses;
}

}  // namespace mottle::model
