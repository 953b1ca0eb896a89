// The kinds of model.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/models/model_source.hpp"
#include "study/input/toml_reader.hpp"

namespace mottle::study {

/// A kind of model as a study names it.
struct ModelKind {
  std::string name;  ///< model.kind
  /// Reads the keys of this kind; `folder` is the study's.
  std::shared_ptr<const ModelSource> (*read)(TomlReader& reader, const std::filesystem::path& folder);
};

/// All kinds, in the order of documentation.
const std::vector<ModelKind>& model_kinds();

std::shared_ptr<const ModelSource> read_mass_spring_source(TomlReader& reader, const std::filesystem::path& folder);
std::shared_ptr<const ModelSource> read_nastran_source(TomlReader& reader, const std::filesystem::path& folder);
std::shared_ptr<const ModelSource> read_matrix_source(TomlReader& reader, const std::filesystem::path& folder);
std::shared_ptr<const ModelSource> read_calculix_source(TomlReader& reader, const std::filesystem::path& folder);
std::shared_ptr<const ModelSource> read_command_source(TomlReader& reader, const std::filesystem::path& folder);
std::shared_ptr<const ModelSource> read_mesh_source(TomlReader& reader, const std::filesystem::path& folder);
std::shared_ptr<const ModelSource> read_umbridge_source(TomlReader& reader, const std::filesystem::path& folder);

}  // namespace mottle::study
