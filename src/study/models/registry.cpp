#include "study/models/registry.hpp"

#include "study/input/key_error.hpp"

namespace mottle::study {

const std::vector<ModelKind>& model_kinds() {
  static const std::vector<ModelKind> k_kinds = {
      {"mass-spring", read_mass_spring_source}, {"nastran", read_nastran_source}, {"matrices", read_matrix_source},
      {"calculix", read_calculix_source},       {"command", read_command_source}, {"mesh", read_mesh_source},
      {"umbridge", read_umbridge_source},
  };
  return k_kinds;
}

std::unique_ptr<ModelSource> ModelSource::with_number(const std::string& /*target*/, double /*value*/) const {
  throw KeyError("predict.model",
                 "numbers of a model of matrices or of CalculiX cannot be changed in the prediction; make them "
                 "parameters");
}

}  // namespace mottle::study
