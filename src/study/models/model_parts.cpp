#include "study/models/model_parts.hpp"

#include <limits>

#include "mottle/drivers/command/external_solver.hpp"

namespace mottle::study {

std::optional<double> read_reduction(TomlReader& reader) {
  constexpr double k_usual_error = 1e-4;
  const bool is_allowed = reader.choice("reduction", {"auto", "off"}, 0) == 0;
  const double error = reader.number_or("frequency_error", k_usual_error, {1e-8, 0.1});
  return is_allowed ? std::optional(error) : std::nullopt;
}

std::filesystem::path name_beside(const std::filesystem::path& file, const std::filesystem::path& deck) {
  const std::filesystem::path folder = std::filesystem::weakly_canonical(std::filesystem::absolute(deck).parent_path());
  std::filesystem::path name =
      std::filesystem::weakly_canonical(std::filesystem::absolute(file)).lexically_relative(folder);
  require(
      !name.empty() && *name.begin() != "..",
      "{}: is outside of the folder of {}; copy it there and include it from there, so that the deck can be exported "
      "as a whole",
      file.string(), deck.string());
  return name;
}

ModelParts parts_of(MatrixModel model, std::vector<std::string> files) {
  ModelParts parts;
  parts.reference = model.reference;
  parts.limits = std::move(model.limits);
  parts.notes = std::move(model.notes);
  parts.files = std::move(files);
  parts.sparse = std::make_unique<MatrixStructure>(std::move(model.pencil), parts.reference);
  return parts;
}

ModelParts make_external(const SolverCommand& command, const std::vector<std::string>& names,
                         const JointDistribution& prior, const RunSettings& settings) {
  ModelParts parts;
  parts.reference = prior.mean();
  parts.limits.assign(names.size(), {.lower = -std::numeric_limits<double>::infinity()});
  for (const std::vector<RunFile>* list : {&command.templates, &command.files}) {
    for (const RunFile& file : *list) parts.files.push_back(file.source.string());
  }
  SolverCommand own = command;
  if (!settings.ends_by_failures) own.max_failed_fraction = 1.0;
  auto solver = std::make_unique<ExternalSolver>(
      own, names, parts.reference, prior.covariance().diagonal().cwiseSqrt(),
      RunStorage{.results = settings.run_folder.empty() ? settings.folder : settings.run_folder,
                 .is_resumed = settings.resume,
                 .ranks = settings.ranks,
                 .observer = settings.observer},
      settings.stop);
  parts.notes = solver->notes();
  const int limit = command.scheduler ? command.scheduler->runs_at_once : command.parallel;
  const int at_once = limit > 0 ? limit : drivers::k_usual_tasks_at_once;
  parts.program = {.seconds_at_means = solver->seconds_at_means(), .max_parallel = at_once};
  parts.solver = std::move(solver);
  return parts;
}

}  // namespace mottle::study
