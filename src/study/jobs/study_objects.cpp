#include "mottle/study/jobs/study_objects.hpp"

#include <algorithm>
#include <numeric>
#include <set>

#include "mottle/core/files.hpp"
#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"
#include "mottle/model/solvers/reduced_solver.hpp"
#include "mottle/model/units.hpp"
#include "mottle/study/models/model_source.hpp"
#include "mottle/updating/verdict/verdict.hpp"
#include "study/input/key_error.hpp"
#include "study/jobs/model_around.hpp"
#include "study/tests/test_files.hpp"

namespace mottle::study {
namespace {

JointDistribution joint_prior(const StudyParameters& parameters) {
  std::vector<Distribution> marginals;
  for (const StudyParameter& parameter : parameters.list) marginals.emplace_back(parameter.distribution);
  if (parameters.correlation.isIdentity(0.0)) return JointDistribution(std::move(marginals));
  return {std::move(marginals), parameters.correlation};
}

/// Dampers change nothing but damping ratios.
void require_effects(const StudyParameters& parameters, const OutputSelection& outputs) {
  for (const StudyParameter& parameter : parameters.list) {
    const bool is_seen = !outputs.damping.empty() ||
                         std::any_of(parameter.targets.begin(), parameter.targets.end(),
                                     [](const std::string& target) { return !target.starts_with("damper:"); });
    require_of(is_seen, subject_parameter(parameter.name),
               "it acts on nothing: {} changes damping alone, on which no output depends; name mode numbers in "
               "outputs.damping or leave the parameter out",
               join(parameter.targets));
  }
}

/// Parameters and outputs are columns of one table.
void require_own_names(const StudyParameters& parameters, const std::vector<Quantity>& outputs) {
  std::set<std::string> names;
  for (const Quantity& output : outputs) names.insert(output.name());
  for (const StudyParameter& parameter : parameters.list) {
    require_of(!names.contains(parameter.name), subject_parameter(parameter.name),
               "an output has that name, choose another");
  }
}

void refuse_programs(const ModelSource& model) {
  for (const std::string& program : model.programs()) {
    const std::size_t colon = program.find(": ");
    throw KeyError(program.substr(0, colon),
                   fmt::format("'{}' would be run, which --no-run forbids; read the study and what it runs first",
                               program.substr(colon + 2)));
  }
}

/// Samples of the prior moved to `centre`, as far as they are possible there.
Eigen::MatrixXd moved_to(const Eigen::VectorXd& centre, const ParameterSpace& space, const Eigen::MatrixXd& samples) {
  const Eigen::MatrixXd moved = samples.rowwise() + (centre - space.prior().mean()).transpose();
  std::vector<Eigen::Index> possible;
  for (Eigen::Index s = 0; s < moved.rows(); ++s) {
    if (space.is_possible(moved.row(s).transpose())) possible.push_back(s);
  }
  return moved(possible, Eigen::all);
}

/// A reduced model is trained on samples that no cloud uses, so that it depends on nothing else.
///
/// @param centre  of the clouds to come
ReductionSettings reduction_settings(double frequency_error, const ParameterSpace& space, const Eigen::VectorXd& centre,
                                     const std::filesystem::path& cache) {
  SampleRegion region = region_of(space, centre, space.prior());
  if (centre != space.prior().mean()) region = {centre, moved_to(centre, space, region.samples())};
  return {.frequency_error = frequency_error, .prior = std::move(region), .cache = cache};
}

}  // namespace

std::vector<ParameterTargets> list_targets(const StudyParameters& parameters) {
  std::vector<ParameterTargets> targets;
  for (const StudyParameter& parameter : parameters.list) {
    targets.push_back({parameter.name, parameter.targets, parameter.is_factor});
  }
  return targets;
}

StudyModel make_model(const Study& study, const StudyParameters& parameters, const RunSettings& settings) {
  return make_model_around({}, study, parameters, settings);
}

StudyModel make_model_around(const Eigen::VectorXd& centre, const Study& study, const StudyParameters& parameters,
                             const RunSettings& settings) {
  const bool is_truth = study.truth && &parameters == &study.truth->parameters;
  require(!parameters.list.empty(), "{}: parameter: there is none; give at least one [[parameter]]",
          study.file.string());
  try {
    const std::vector<ParameterTargets> targets = list_targets(parameters);
    JointDistribution prior = joint_prior(parameters);
    if (!settings.may_run_programs) refuse_programs(*study.model);
    ModelParts parts = study.model->make(targets, prior, settings);
    const UnitNames units = unit_names(study.units);
    std::vector<Parameter> list;
    for (std::size_t i = 0; i < parameters.list.size(); ++i) {
      const StudyParameter& parameter = parameters.list[i];
      const std::string unit = parameter.is_factor ? "-" : study.model->target_unit(parameter.targets.front(), units);
      list.push_back(
          {parameter.name, unit, parameter.lower_bound, parameter.upper_bound, parts.limits[i], parameter.transform});
      if (parameter.may_vanish) list.back().limit.excludes_lower = false;
    }
    OutputSelection outputs = study.outputs;
    outputs.units = units;
    StudyModel made;
    made.files = std::move(parts.files);
    made.notes = std::move(parts.notes);
    made.program = parts.program;
    made.space = std::make_unique<ParameterSpace>(std::move(list), std::move(prior));
    require_effects(parameters, outputs);
    if (parts.sparse) {
      std::optional<ReductionSettings> reduction;
      const std::optional<double> error = study.model->reduction_error();
      if (error && study.may_reduce) {
        const Eigen::VectorXd around = centre.size() > 0 ? centre : Eigen::VectorXd(made.space->prior().mean());
        reduction = reduction_settings(*error, *made.space, around, settings.cache);
      }
      parts.solver = make_sparse_solver(std::move(parts.sparse), std::move(reduction));
    }
    made.model = std::make_unique<StructureModel>(std::move(parts.solver), std::move(outputs), parts.reference);
    require_own_names(parameters, made.model->outputs());
    made.model->require_solution_at(made.space->prior().mean());
    return made;
  } catch (const InvalidInput& error) {
    throw InvalidInput(located(study, error, is_truth ? "truth." : ""));
  }
}

bool shows_few_samples(const Study& study, const StudyModel& made) {
  return made.program && !study.update.states_samples && !study.surrogate &&
         !find_method(study.update.method).samples_each_iteration;
}

CloudSettings cloud_settings(const Study& study, const StudyModel& made, Eigen::Index specimens, Eigen::Index outputs) {
  CloudSettings settings;
  settings.samples = study.update.samples;
  constexpr int k_runs_of_a_program = 40;  // enough to show a cloud; each may take minutes
  if (shows_few_samples(study, made)) settings.samples = k_runs_of_a_program;
  if (study.update.has_automatic_samples) {
    settings.samples = automatic_samples(static_cast<int>(specimens), static_cast<int>(outputs), study.update.level);
  }
  settings.design = study.update.design;
  settings.max_failed = study.update.max_failed;
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
        throw InvalidInput(located(study, "update.covariance", unknown_name_message("parameter", name, names)));
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

}  // namespace mottle::study
