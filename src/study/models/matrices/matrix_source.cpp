// [model] of kind "matrices": stiffness and mass from files, in parts that parameters scale.
#include "mottle/formats/matrices/matrix_file.hpp"
#include "study/models/matrices/read_matrices.hpp"
#include "study/models/model_parts.hpp"
#include "study/models/registry.hpp"

namespace mottle::study {
namespace {

const OptionRange k_positive{.lower = 0.0, .excludes_lower = true};

std::string matrix_location(TomlReader& reader, const std::string& key, const std::filesystem::path& folder) {
  return reader.raw(key) == nullptr ? "" : (folder / reader.text(key)).string();
}

MatrixFiles read_matrix_files(TomlReader& reader, const std::filesystem::path& folder) {
  MatrixFiles files;
  constexpr OptionRange k_exponents{.lower = -9.0, .upper = 9.0};
  files.constant_part.stiffness = matrix_location(reader, "stiffness", folder);
  files.constant_part.mass = matrix_location(reader, "mass", folder);
  files.row_names = matrix_location(reader, "degrees_of_freedom", folder);
  for (TomlReader& entry : reader.tables("terms")) {
    MatrixPartFiles part{.name = entry.name("name")};
    part.stiffness = matrix_location(entry, "stiffness", folder);
    part.mass = matrix_location(entry, "mass", folder);
    if (part.stiffness.empty() && part.mass.empty()) entry.fail("stiffness", "give stiffness, mass or both");
    if (entry.raw("nominal") != nullptr) part.nominal = entry.number("nominal", k_positive);
    part.exponent = static_cast<int>(entry.integer_or("exponent", 1, k_exponents));
    if (part.exponent == 0) entry.fail_value("exponent", "a whole number from -9 to 9 other than 0");
    entry.finish();
    files.parts.push_back(std::move(part));
  }
  return files;
}

/// The part's files, and those of names that are looked for beside them.
void add_files(const MatrixPartFiles& part, const std::string& prefix, std::vector<NamedFile>& files) {
  for (const auto& [key, location] : {std::pair{"stiffness", part.stiffness}, std::pair{"mass", part.mass}}) {
    if (location.empty()) continue;
    const std::filesystem::path file = file_of_matrix(location);
    files.push_back({"model", prefix + key, location, file});
    for (const char* extension : k_names_beside_matrices) {
      std::error_code ignored;
      const std::filesystem::path beside = std::filesystem::path(file).replace_extension(extension);
      if (std::filesystem::exists(beside, ignored)) files.push_back({"model", "", beside.string(), beside});
    }
  }
}

class MatrixSource final : public ModelSource {
 public:
  MatrixSource(MatrixFiles files, std::optional<double> reduction_error)
      : files_(std::move(files)), reduction_error_(reduction_error) {}

  ModelParts make(const std::vector<ParameterTargets>& parameters, const JointDistribution& prior,
                  const RunSettings& /*settings*/) const override {
    std::vector<std::string> read;
    MatrixModel model = read_matrices(files_, parameters, prior.mean(), read);
    return parts_of(std::move(model), std::move(read));
  }

  std::optional<double> reduction_error() const override { return reduction_error_; }
  std::vector<NamedFile> files() const override {
    std::vector<NamedFile> files;
    if (!files_.row_names.empty()) {
      files.push_back({"model.degrees_of_freedom", "degrees_of_freedom", files_.row_names.string(), files_.row_names});
    }
    add_files(files_.constant_part, "", files);
    for (std::size_t i = 0; i < files_.parts.size(); ++i)
      add_files(files_.parts[i], fmt::format("terms[{}].", i), files);
    return files;
  }

  /// Not known: the user's matrices are scaled by anything.
  std::string target_unit(const std::string& /*target*/, const UnitNames& /*units*/) const override { return ""; }

  bool shows_numbers() const override { return true; }
  /// Parts at the values at which they were written.
  std::vector<ModelNumber> numbers() const override {
    std::vector<ModelNumber> numbers;
    for (const MatrixPartFiles& part : files_.parts) {
      const double value = part.nominal.value_or(1.0);
      if (!part.stiffness.empty()) numbers.push_back({"K:" + part.name, "K", value, true});
      if (!part.mass.empty()) numbers.push_back({"M:" + part.name, "M", value});
    }
    return numbers;
  }

 private:
  MatrixFiles files_;
  std::optional<double> reduction_error_;
};

}  // namespace

std::shared_ptr<const ModelSource> read_matrix_source(TomlReader& reader, const std::filesystem::path& folder) {
  MatrixFiles files = read_matrix_files(reader, folder);
  const std::optional<double> reduction_error = read_reduction(reader);
  reader.finish();
  return std::make_shared<MatrixSource>(std::move(files), reduction_error);
}

}  // namespace mottle::study
