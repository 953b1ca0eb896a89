#include "mottle/study/jobs/study_objects.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>

#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"
#include "mottle/drivers/calculix/calculix.hpp"
#include "mottle/drivers/calculix/separable_fit.hpp"
#include "mottle/drivers/command/external_structure.hpp"
#include "mottle/formats/nastran/model.hpp"
#include "mottle/model/structures/dense_structure.hpp"
#include "mottle/model/structures/finite_element_structure.hpp"
#include "mottle/model/structures/matrix_structure.hpp"
#include "mottle/updating/verdict/verdict.hpp"
#include "study/input/study_matrices.hpp"
#include "study/input/unit_names.hpp"
#include "study/tests/test_files.hpp"

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

/// A structure and what belongs to it.
struct ModelParts {
  std::unique_ptr<ModalStructure> structure;
  SparseStructure* sparse = nullptr;  ///< the same, where it is one
  Eigen::VectorXd reference;          ///< parameters at which modes are numbered
  std::vector<PhysicalLimit> limits;
  std::vector<std::string> files;
  std::vector<std::string> notes;
};

/// Numbers of the deck that are other than it says.
void override_fields(FiniteElementModel& model, const std::map<std::string, double>& overrides) {
  for (const auto& [target, value] : overrides) {
    bool is_found = false;
    for (CardField& field : model.fields) {
      if (fmt::format("{}:{}:{}", field.card, field.id, field.name) != target) continue;
      field.value = value;
      is_found = true;
    }
    require(is_found, "predict.model: the deck has no number '{}'", target);
  }
}

ModelParts parts_of(MatrixModel model, std::vector<std::string> files) {
  ModelParts parts;
  parts.reference = model.reference;
  parts.limits = std::move(model.limits);
  parts.notes = std::move(model.notes);
  parts.files = std::move(files);
  auto structure = std::make_unique<MatrixStructure>(std::move(model.pencil), parts.reference);
  parts.sparse = structure.get();
  parts.structure = std::move(structure);
  return parts;
}

/// A solver by command: places in its input have these names.
ModelParts make_external(const SolverCommand& command, const std::vector<std::string>& names,
                         const JointDistribution& prior, const RunSettings& settings) {
  ModelParts parts;
  parts.reference = prior.mean();
  parts.limits.assign(names.size(), {.lower = -std::numeric_limits<double>::infinity()});
  for (const std::vector<RunFile>* list : {&command.templates, &command.files}) {
    for (const RunFile& file : *list) parts.files.push_back(file.source.string());
  }
  auto structure = std::make_unique<ExternalStructure>(
      command, names, parts.reference, prior.covariance().diagonal().cwiseSqrt(),
      SolverPlace{.results = settings.folder, .is_resumed = settings.resume}, settings.stop);
  parts.notes = structure->notes();
  parts.structure = std::move(structure);
  return parts;
}

/// By its matrices, or where they have no separable form by a run for each sample.
ModelParts make_calculix(const CalculixDeck& deck, const std::vector<ParameterTargets>& targets,
                         const JointDistribution& prior, const CalculixSettings& calculix,
                         const RunSettings& settings) {
  std::string reason;
  try {
    return parts_of(calculix_model(deck, targets, prior.mean(), calculix), deck.files);
  } catch (const NotSeparable& error) {
    reason = error.what();
  }
  std::vector<std::string> names;
  for (const ParameterTargets& target : targets) names.push_back(target.parameter);
  ModelParts parts = make_external(calculix_command(deck, targets, calculix), names, prior, settings);
  parts.limits.assign(targets.size(), {});
  parts.files = deck.files;
  parts.notes.insert(parts.notes.begin(), fmt::format("CalculiX: each sample is a run, since {}", reason));
  return parts;
}

void refuse_programs(const StudyModelSource& source) {
  const bool is_calculix = source.kind == StudyModelSource::Kind::calculix;
  require(!is_calculix && source.kind != StudyModelSource::Kind::command,
          "model.{}: '{}' would be run, which --no-run forbids; read the study and what it runs first",
          is_calculix ? "program" : "command",
          is_calculix ? source.program : join(source.command.command.arguments, " "));
}

ModelParts make_parts(const StudyModelSource& source, const std::vector<ParameterTargets>& targets,
                      const JointDistribution& prior, const RunSettings& settings) {
  if (!settings.may_run_programs) refuse_programs(source);
  if (source.kind == StudyModelSource::Kind::command) {
    std::vector<std::string> names;
    for (const ParameterTargets& target : targets) names.push_back(target.targets.front());
    return make_external(source.command, names, prior, settings);
  }
  const Eigen::VectorXd prior_mean = prior.mean();
  const std::filesystem::path& cache = settings.cache;
  ModelParts parts;
  if (source.kind == StudyModelSource::Kind::mass_spring) {
    parts.structure = std::make_unique<DenseStructure>(separate(source.system, targets), prior_mean.size());
    parts.reference = prior_mean;
    for (const ParameterTargets& target : targets) parts.limits.push_back(physical_limit(target));
    return parts;
  }
  if (source.kind == StudyModelSource::Kind::matrices) {
    std::vector<std::string> files;
    MatrixModel model = read_matrices(source, targets, prior_mean, files);
    return parts_of(std::move(model), std::move(files));
  }
  if (source.kind == StudyModelSource::Kind::calculix) {
    const CalculixDeck deck = read_calculix_deck(source.deck);
    return make_calculix(deck, targets, prior,
                         {.program = source.program,
                          .timeout = source.timeout,
                          .cache = cache,
                          .parallel = source.parallel,
                          .stop = settings.stop},
                         settings);
  }
  NastranModel deck = read_nastran_model(source.deck, {.ignore_cards = source.ignore_cards});
  override_fields(deck.model, source.overrides);
  parts.files = std::move(deck.files);
  parts.notes = std::move(deck.notes);
  auto structure = std::make_unique<FiniteElementStructure>(std::move(deck.model), targets, prior_mean);
  parts.reference = structure->reference();
  parts.limits = structure->limits();
  parts.sparse = structure.get();
  parts.structure = std::move(structure);
  return parts;
}

/// A reduced model learns from the prior, by samples that no cloud uses: its numbers then depend on nothing else.
ReductionSettings reduction_settings(double frequency_error, const ParameterSpace& space,
                                     const std::filesystem::path& cache) {
  constexpr int k_training_samples = 400;
  const StreamKey key{.seed = 1, .purpose = StreamPurpose::basis_training};
  return {.frequency_error = frequency_error,
          .nominal = space.prior().mean(),
          .training = space.draw(space.prior(), SamplingDesign::latin_hypercube, k_training_samples, key).samples,
          .cache = cache};
}

}  // namespace

StudyModel make_model(const Study& study, const StudyParameters& parameters, const RunSettings& settings) {
  const bool is_truth = study.truth && &parameters == &study.truth->parameters;
  require(!parameters.list.empty(), "{}: parameter: there is none; give at least one [[parameter]]",
          study.file.string());
  try {
    const std::vector<ParameterTargets> targets = list_targets(parameters);
    JointDistribution prior = joint_prior(parameters);
    ModelParts parts = make_parts(study.model, targets, prior, settings);
    const UnitNames units = unit_names(study.units);
    std::vector<Parameter> list;
    for (std::size_t i = 0; i < parameters.list.size(); ++i) {
      const StudyParameter& parameter = parameters.list[i];
      const bool is_external = study.model.kind == StudyModelSource::Kind::command;
      const std::string of_target = is_external ? "" : target_unit(parameter.targets.front(), units);
      const std::string unit = parameter.is_factor ? "-" : of_target;
      list.push_back(
          {parameter.name, unit, parameter.lower_bound, parameter.upper_bound, parts.limits[i], parameter.scale});
      if (parameter.may_vanish) list.back().limit.excludes_lower = false;
    }
    ModalOutputs outputs = study.outputs;
    outputs.frequency_unit = units.frequency;
    outputs.shape_unit = units.shape;
    StudyModel made;
    made.files = std::move(parts.files);
    made.notes = std::move(parts.notes);
    made.space = std::make_unique<ParameterSpace>(std::move(list), std::move(prior));
    require_effects(parameters, outputs);
    if (study.model.may_reduce && parts.sparse != nullptr) {
      parts.sparse->allow_reduction(reduction_settings(study.model.frequency_error, *made.space, settings.cache));
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

std::vector<int> covariance_groups(const Study& study, const std::vector<std::string>& names) {
  if (!study.update.is_diagonal && study.update.covariance_groups.empty()) return {};
  std::vector<int> groups(names.size());
  std::iota(groups.begin(), groups.end(), 0);
  for (const std::vector<std::string>& together : study.update.covariance_groups) {
    int group = -1;
    for (const std::string& name : together) {
      const auto found = std::find(names.begin(), names.end(), name);
      if (found == names.end()) {
        throw InvalidInput(located(study, "update.covariance: " + unknown_name_message("parameter", name, names)));
      }
      const auto index = static_cast<std::size_t>(std::distance(names.begin(), found));
      if (group < 0) group = groups[index];
      groups[index] = group;
    }
  }
  return groups;
}

Digest study_fingerprint(const Study& study, const StudyModel& made,
                         const std::optional<std::filesystem::path>& points) {
  Checksum checksum;
  // Each part with its length: bytes that move from one file to the next are a change.
  const auto add = [&](const std::string& bytes) {
    checksum.add(fmt::format("{}:", bytes.size()));
    checksum.add(bytes);
  };
  add(version());
  for (const std::string& file : made.files) add(read_file(file));
  add(study.text);
  if (study.test) {
    for (const std::filesystem::path& file : list_test_files(study)) add(read_file(file));
  }
  if (study.test && study.test->repeats_file) add(read_file(*study.test->repeats_file));
  if (study.predict && study.predict->held_out) add(read_file(*study.predict->held_out));
  if (points) add(read_file(*points));
  return checksum.digest();
}

}  // namespace mottle
