#include "mottle/study/study_objects.hpp"

#include <algorithm>
#include <cctype>
#include <set>

#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"
#include "mottle/formats/csv.hpp"
#include "mottle/formats/nastran_model.hpp"
#include "mottle/model/dense_structure.hpp"
#include "mottle/model/finite_element_structure.hpp"
#include "mottle/study/pair_tests.hpp"
#include "mottle/study/text_file.hpp"
#include "mottle/updating/verdict.hpp"
#include "unit_names.hpp"

namespace mottle {
namespace {

std::vector<ParameterTargets> list_targets(const StudyParameters& parameters) {
  std::vector<ParameterTargets> targets;
  for (const StudyParameter& parameter : parameters.list) {
    targets.push_back({parameter.name, parameter.targets, parameter.is_factor});
  }
  return targets;
}

JointDistribution joint_prior(const StudyParameters& parameters) {
  std::vector<Distribution> marginals;
  for (const StudyParameter& parameter : parameters.list) marginals.emplace_back(parameter.distribution);
  if (parameters.correlation.isIdentity(0.0)) return JointDistribution(std::move(marginals));
  return {std::move(marginals), parameters.correlation};
}

/// Dampers change nothing but damping ratios.
void require_effects(const StudyParameters& parameters, const ModalOutputs& outputs) {
  for (const StudyParameter& parameter : parameters.list) {
    const bool is_seen = !outputs.damping.empty() ||
                         std::any_of(parameter.targets.begin(), parameter.targets.end(),
                                     [](const std::string& target) { return !target.starts_with("damper:"); });
    require(is_seen,
            "parameter '{}': it acts on nothing: {} changes damping alone, which no output sees; name mode numbers in "
            "outputs.damping or leave the parameter out",
            parameter.name, join(parameter.targets));
  }
}

/// Parameters and outputs are columns of one table.
void require_own_names(const StudyParameters& parameters, const std::vector<Output>& outputs) {
  std::set<std::string> names;
  for (const Output& output : outputs) names.insert(output.name);
  for (const StudyParameter& parameter : parameters.list) {
    require(!names.contains(parameter.name), "parameter '{}': an output has that name, choose another", parameter.name);
  }
}

/// "f1_Hz", "f1 [Hz]", "f1 (Hz)" -> "f1".
std::string without_unit(std::string name) {
  for (const std::string open : {" [", " (", "[", "("}) {
    const std::size_t position = name.find(open);
    if (position != std::string::npos && position > 0) name.resize(position);
  }
  if (name.size() > 3 && name.compare(name.size() - 3, 3, "_Hz") == 0) name.resize(name.size() - 3);
  return name;
}

/// Whether `name` is how a model of this kind would call some output: f4, zeta2, phi3:m1.
bool looks_like_output(const std::string& name) {
  for (const std::string stem : {"zeta", "phi", "f"}) {
    if (name.rfind(stem, 0) != 0) continue;
    std::size_t end = stem.size();
    while (end < name.size() && std::isdigit(static_cast<unsigned char>(name[end])) != 0) ++end;
    return end > stem.size() && (end == name.size() || (stem == "phi" && name[end] == ':'));
  }
  return false;
}

std::vector<std::string> names_of(const std::vector<Output>& outputs) {
  std::vector<std::string> names;
  for (const Output& output : outputs) names.push_back(output.name);
  return names;
}

std::string read_test_file(const Study& study) {
  try {
    return read_text_file(study.test->file);
  } catch (const FormatError&) {
    throw;
  } catch (const InvalidInput& error) {
    throw InvalidInput(located(study, fmt::format("test.file: {}", error.what())));
  }
}

/// Column of each output; throws where one is missing or a column is nothing known.
std::vector<int> match_columns(const CsvTable& table, const Study& study, const std::vector<std::string>& outputs,
                               std::vector<std::string>& notes) {
  std::vector<int> columns(outputs.size(), -1);
  std::vector<std::string> unused;
  for (std::size_t column = 0; column < table.header.size(); ++column) {
    const std::string name = without_unit(table.header[column]);
    const auto output = std::find(outputs.begin(), outputs.end(), name);
    if (output != outputs.end()) {
      int& found = columns[static_cast<std::size_t>(std::distance(outputs.begin(), output))];
      if (found >= 0) throw FormatError(table.file, 1, fmt::format("output '{}' has two columns", name));
      found = static_cast<int>(column);
      continue;
    }
    const bool is_parameter = std::any_of(study.parameters.list.begin(), study.parameters.list.end(),
                                          [&](const StudyParameter& parameter) { return parameter.name == name; });
    const bool is_label = name == "specimen" || name == "status";
    if (!is_parameter && !is_label && !looks_like_output(name)) {
      throw FormatError(table.file, 1, unknown_name_message("column", table.header[column], outputs));
    }
    if (!is_label) unused.push_back(table.header[column]);
  }
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (columns[i] < 0) {
      throw FormatError(table.file, 1,
                        fmt::format("output '{}' has no column; the columns are {}", outputs[i], join(table.header)));
    }
  }
  if (!unused.empty()) notes.push_back(fmt::format("Columns of the test file that are not used: {}.", join(unused)));
  return columns;
}

/// A structure and what belongs to it.
struct ModelParts {
  std::unique_ptr<ModalStructure> structure;
  FiniteElementStructure* finite_elements = nullptr;  ///< the same, where it is one
  Eigen::VectorXd reference;                          ///< parameters at which modes are numbered
  std::vector<PhysicalLimit> limits;
  std::vector<std::string> files;
  std::vector<std::string> notes;
};

ModelParts make_parts(const StudyModelSource& source, const std::vector<ParameterTargets>& targets,
                      const Eigen::VectorXd& prior_mean) {
  ModelParts parts;
  if (source.kind == StudyModelSource::Kind::mass_spring) {
    parts.structure = std::make_unique<DenseStructure>(separate(source.system, targets), prior_mean.size());
    parts.reference = prior_mean;
    for (const ParameterTargets& target : targets) parts.limits.push_back(physical_limit(target));
    return parts;
  }
  NastranModel deck = read_nastran_model(source.deck, {.ignore_cards = source.ignore_cards});
  parts.files = std::move(deck.files);
  parts.notes = std::move(deck.notes);
  auto structure = std::make_unique<FiniteElementStructure>(std::move(deck.model), targets, prior_mean);
  parts.reference = structure->reference();
  parts.limits = structure->limits();
  parts.finite_elements = structure.get();
  parts.structure = std::move(structure);
  return parts;
}

/// A reduced model learns from the prior, by samples that no cloud uses: its numbers then depend on nothing else.
ReductionSettings reduction_settings(double frequency_error, const ParameterSpace& space) {
  constexpr int k_training_samples = 400;
  const StreamKey key{.seed = 1, .purpose = StreamPurpose::basis_training};
  return {.frequency_error = frequency_error,
          .nominal = space.prior().mean(),
          .training = space.draw(space.prior(), SamplingDesign::latin_hypercube, k_training_samples, key).samples};
}

}  // namespace

StudyModel make_model(const Study& study, const StudyParameters& parameters) {
  const bool is_truth = study.truth && &parameters == &study.truth->parameters;
  require(!parameters.list.empty(), "{}: parameter: there is none; give at least one [[parameter]]",
          study.file.string());
  try {
    const std::vector<ParameterTargets> targets = list_targets(parameters);
    JointDistribution prior = joint_prior(parameters);
    ModelParts parts = make_parts(study.model, targets, prior.mean());
    const UnitNames units = unit_names(study.units);
    std::vector<Parameter> list;
    for (std::size_t i = 0; i < parameters.list.size(); ++i) {
      const StudyParameter& parameter = parameters.list[i];
      const std::string unit = parameter.is_factor ? "-" : target_unit(parameter.targets.front(), units);
      list.push_back({parameter.name, unit, parameter.lower_bound, parameter.upper_bound, parts.limits[i]});
    }
    ModalOutputs outputs = study.outputs;
    outputs.frequency_unit = units.frequency;
    outputs.shape_unit = units.shape;
    StudyModel made;
    made.files = std::move(parts.files);
    made.notes = std::move(parts.notes);
    made.space = std::make_unique<ParameterSpace>(std::move(list), std::move(prior));
    require_effects(parameters, outputs);
    if (study.model.may_reduce && parts.finite_elements != nullptr) {
      parts.finite_elements->allow_reduction(reduction_settings(study.model.frequency_error, *made.space));
    }
    made.model = std::make_unique<ModalModel>(std::move(parts.structure), std::move(outputs), parts.reference);
    require_own_names(parameters, made.model->outputs());
    return made;
  } catch (const FormatError&) {
    throw;  // names the deck's own file and line
  } catch (const InvalidInput& error) {
    throw InvalidInput(located(study, error.what(), is_truth ? "truth." : ""));
  }
}

StudyTests read_tests(const Study& study, const ModalModel& model) {
  require(study.test.has_value(), "{}: test: is missing; give [test] file = \"...\"", study.file.string());
  const CsvTable table = parse_csv(read_test_file(study), study.test->file.string());
  const std::vector<std::string> names = names_of(model.outputs());
  StudyTests tests;
  const std::vector<int> columns = match_columns(table, study, names, tests.notes);
  Eigen::MatrixXd values(static_cast<Eigen::Index>(table.rows.size()), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    values.col(static_cast<Eigen::Index>(i)) = numbers_of_column(table, columns[i]);
  }
  std::vector<Eigen::Index> kept;
  for (Eigen::Index row = 0; row < values.rows(); ++row) {
    if (!values.row(row).array().isNaN().all()) kept.push_back(row);
  }
  if (kept.empty()) throw FormatError(table.file, 0, "holds no specimen: there is no row with a value");
  if (kept.size() < table.rows.size()) {
    tests.notes.push_back(fmt::format("{} specimens without any value are left out.", table.rows.size() - kept.size()));
  }
  tests.data.values = values(kept, Eigen::all);
  if (study.test->pairs_by_mac) {
    std::vector<Eigen::Index> columns_of_modes;
    for (const int mode : model.selection().shape_modes) columns_of_modes.push_back(mode - 1);
    try {
      const Eigen::MatrixXd reference = model.reference_displacements()(Eigen::all, columns_of_modes);
      for (std::string& note : pair_tests(tests.data.values, model.selection(), reference)) tests.notes.push_back(note);
    } catch (const InvalidInput& error) {
      throw InvalidInput(located(study, error.what()));
    }
  }
  tests.data.repeatability_std = Eigen::VectorXd::Zero(values.cols());
  for (const auto& [name, value] : study.test->repeatability) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      throw InvalidInput(located(study, "test.repeatability: " + unknown_name_message("output", name, names)));
    }
    tests.data.repeatability_std(std::distance(names.begin(), found)) = value;
  }
  for (Eigen::Index k = 0; k < values.cols(); ++k) {
    const auto measured = (!tests.data.values.col(k).array().isNaN()).count();
    require(measured > 0, "{}: output '{}' is never measured; leave it out of [outputs]", table.file,
            names[static_cast<std::size_t>(k)]);
    require(measured > 1 || kept.size() == 1,
            "{}: output '{}' is measured once in {} specimens, which gives no scatter; leave it out of [outputs]",
            table.file, names[static_cast<std::size_t>(k)], kept.size());
  }
  return tests;
}

CloudSettings cloud_settings(const Study& study, Eigen::Index specimens, Eigen::Index outputs) {
  CloudSettings settings;
  settings.samples = study.update.samples;
  if (study.update.has_automatic_samples) {
    settings.samples = automatic_samples(static_cast<int>(specimens), static_cast<int>(outputs), study.update.level);
  }
  settings.design = study.update.design;
  settings.most_failed = study.update.most_failed;
  return settings;
}

std::uint64_t study_fingerprint(const Study& study, const StudyModel& made) {
  std::uint64_t print = fingerprint(version());
  for (const std::string& file : made.files) print = fingerprint(read_file(file), print);
  print = fingerprint(study.text, print);
  if (study.test) print = fingerprint(read_file(study.test->file), print);
  return print;
}

}  // namespace mottle
