#include "mottle/drivers/command/external_solver.hpp"

#include <limits>
#include <numbers>
#include <numeric>

#include "mottle/core/clock.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/rank_share.hpp"
#include "mottle/core/text.hpp"
#include "mottle/dynamics/modes/mac.hpp"

namespace mottle::drivers {
namespace {

constexpr double k_not_known = std::numeric_limits<double>::quiet_NaN();

[[noreturn]] void refuse(const SolverRuns::Run& run) {
  const std::string said = run.last_words.empty() ? "" : fmt::format("; it said: {}", run.last_words);
  const std::string kept = run.folder.empty() ? "" : fmt::format("; its files are in {}", run.folder.string());
  throw ModelFailure(fmt::format("the solver's run failed: {}{}{}", run.record.failure, said, kept));
}

FailureLimit limit_of(const SolverCommand& command) {
  return {command.max_failed_fraction, "solver runs", "; folders of failed runs are in failed-runs"};
}

/// Whether three or more frequencies, or eigenvalues, are 1, 2, 3 and so on.
bool are_mode_numbers(const Eigen::VectorXd& eigenvalues) {
  constexpr double k_rounding = 1e-9;
  constexpr Eigen::Index k_few = 3;
  if (eigenvalues.size() < k_few || !(eigenvalues.minCoeff() > 0.0)) return false;
  const Eigen::VectorXd numbers =
      Eigen::VectorXd::LinSpaced(eigenvalues.size(), 1.0, static_cast<double>(eigenvalues.size()));
  const Eigen::VectorXd rad_s = eigenvalues.cwiseSqrt();
  const auto is_counting = [&](const Eigen::VectorXd& values) { return values.isApprox(numbers, k_rounding); };
  return is_counting(eigenvalues) || is_counting(rad_s) || is_counting(rad_s / (2.0 * std::numbers::pi));
}

}  // namespace

ExternalStructure::ExternalStructure(Eigen::Index parameters, ExtractedModes nominal, std::string description)
    : parameters_(parameters), nominal_(std::move(nominal)), description_(std::move(description)) {
  for (std::size_t row = 0; row < nominal_.degree_of_freedom_names.size(); ++row) {
    rows_[nominal_.degree_of_freedom_names[row]] = static_cast<int>(row);
  }
}

int ExternalStructure::find_degree_of_freedom(const std::string& name) const {
  const auto found = rows_.find(name);
  return found == rows_.end() ? -1 : found->second;
}

std::string ExternalStructure::unknown_degree_of_freedom(const std::string& name) const {
  constexpr std::size_t k_listed = 12;
  if (rows_.empty()) return "the model gives no shapes; say in its rule for shapes where a run leaves them";
  std::vector<std::string> known = nominal_.degree_of_freedom_names;
  if (known.size() > k_listed) {
    known.resize(k_listed);
    known.emplace_back("...");
  }
  if (name.empty()) return fmt::format("none is named, known: {}", join(known));
  return unknown_name_message("degree of freedom", name, known);
}

double ExternalStructure::total_mass(const Eigen::Ref<const Eigen::VectorXd>&) const {
  return k_not_known;
}

std::vector<std::string> ExternalStructure::description(const Eigen::Ref<const Eigen::VectorXd>&) const {
  std::vector<std::string> lines{description_};
  if (!rows_.empty()) lines.push_back(fmt::format("shapes: {} degrees of freedom", rows_.size()));
  return lines;
}

ExternalSolver::ExternalSolver(SolverCommand command, const std::vector<std::string>& names,
                               const Eigen::VectorXd& nominal, const Eigen::VectorXd& standard_deviations,
                               const RunStorage& storage, const std::atomic<bool>* stop)
    : place_(command, storage),
      runs_(std::move(command), names, place_.storage()),
      scheduled_(scheduled_runs(runs_, place_, stop)),
      nominal_(nominal),
      least_(runs_.command().frequencies.modes),
      ranks_(storage.ranks),
      structure_(run_at_means(stop)),
      stop_(stop),
      failures_(limit_of(runs_.command()), storage.ranks) {
  for (const std::string& placeholder : runs_.coarse_placeholders(nominal, difference_step() * standard_deviations)) {
    notes_.push_back(
        fmt::format("{} has too few digits for differences by {} of a prior standard deviation: derivatives will "
                    "be poor; give it more",
                    placeholder, difference_step()));
  }
  if (are_mode_numbers(structure_.nominal().eigenvalues)) {
    notes_.emplace_back(
        "the frequencies of the run at the parameters' means are 1, 2, 3, ... as if the column of the modes' numbers "
        "had been read: look at [model.frequencies]");
  }
}

/// The structure from the run at the means, which also determines how many modes a run must give.
ExternalStructure ExternalSolver::run_at_means(const std::atomic<bool>* stop) {
  const bool is_first = ranks_ == nullptr || ranks_->is_first();
  const double begin = steady_seconds();
  SolverRuns::Run run;
  if (is_first) run = run_one(nominal_, std::max(1, least_), stop);
  if (is_first && !run.is_reused) {
    seconds_at_means_ = scheduled_ ? scheduled_->seconds_a_run() : steady_seconds() - begin;
  }
  // One run serves all ranks; one that fails, too.
  if (ranks_ != nullptr) run.record = decode_run(ranks_->gather(is_first ? encode(run.record) : "").front());
  if (!run.record.failure.empty()) refuse(run);
  ExtractedModes modes = std::move(run.record.modes);
  if (least_ == 0) {
    least_ = static_cast<int>(modes.eigenvalues.size());
    if (is_first) runs_.keep_as(nominal_, least_, {.failure = {}, .modes = modes});
  }
  std::string description = fmt::format("model: by command '{}', {} modes a run, {}, total mass not known",
                                        runs_.command_text(), least_, place_of_runs());
  return {nominal_.size(), std::move(modes), std::move(description)};
}

std::string ExternalSolver::place_of_runs() const {
  const std::optional<SchedulerOptions>& scheduler = runs_.command().scheduler;
  if (!scheduler) return fmt::format("{} at once", runs_.command().parallel);
  constexpr std::size_t k_runs = 1000;
  const int each = runs_of_task(k_runs, scheduled_->seconds_a_run(), *scheduler);
  const std::string limit =
      scheduler->runs_at_once > 0 ? fmt::format(", at most {} at once", scheduler->runs_at_once) : "";
  return fmt::format("by tasks of {} (1000 runs: {} tasks of {}{})", scheduler_name(scheduler->kind),
                     (k_runs + static_cast<std::size_t>(each) - 1) / static_cast<std::size_t>(each),
                     each == 1 ? "1 run" : fmt::format("{} runs", each), limit);
}

SolverRuns::Run ExternalSolver::run_one(const Eigen::VectorXd& values, int min_modes,
                                        const std::atomic<bool>* stop) const {
  runs_.begin_batch();
  if (!scheduled_) return runs_.run(values, min_modes, stop);
  SolverRuns::Run found;
  scheduled_->run_all(values.transpose(), min_modes, {.observer = place_.storage().observer, .stop = stop},
                      [&](Eigen::Index, const SolverRuns::Run& run) { found = run; });
  return found;
}

ModeSet ExternalSolver::modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int /*modes*/) const {
  if (parameters == nominal_) {
    return {structure_.nominal().eigenvalues, structure_.nominal().shapes};
  }
  SolverRuns::Run run = run_one(parameters, least_, stop_);
  if (!run.record.failure.empty()) refuse(run);
  return {std::move(run.record.modes.eigenvalues), std::move(run.record.modes.shapes)};
}

std::string ExternalSolver::observe(const ExtractedModes& found, const SolutionRequest& request,
                                    Solution& solution) const {
  solution.eigenvalues = found.eigenvalues;
  if (!request.needs_shapes()) return {};
  if (found.degree_of_freedom_names != structure_.nominal().degree_of_freedom_names) {
    return "its shapes have other degrees of freedom than those at the parameters' means";
  }
  const ModeSet modes{found.eigenvalues, found.shapes};
  if (request.reference.shapes.cols() > 0) solution.cosines = cosines(request.reference, modes);
  solution.displacements = request.observation * found.shapes;
  return {};
}

void ExternalSolver::solve_sample(Eigen::Index s, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                                  const SolutionRequest& request, const Visitor& visit, const std::atomic<bool>& halt,
                                  std::atomic<std::int64_t>& reused) const {
  if (!samples.row(s).allFinite()) {
    Solution none;
    return visit(s, none, "a parameter is not finite");
  }
  SolverRuns::Run run;
  try {
    run = runs_.run(samples.row(s).transpose(), least_, &halt);
  } catch (const FormatError& error) {  // a value that does not fit into its placeholder
    run.record.failure = error.what();
  }
  finish_sample(s, run, request, visit, reused);
}

void ExternalSolver::finish_sample(Eigen::Index s, const SolverRuns::Run& run, const SolutionRequest& request,
                                   const Visitor& visit, std::atomic<std::int64_t>& reused) const {
  Solution solution;
  std::string failure = run.record.failure;
  if (failure.empty()) failure = observe(run.record.modes, request, solution);
  visit(s, solution, failure);
  if (run.is_reused) ++reused;
  failures_.add(failure);
}

SolverUse ExternalSolver::solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, const SolutionRequest& request,
                                const RunContext& context, const Visitor& visit) const {
  runs_.begin_batch();
  std::atomic<std::int64_t> reused{0};
  Ranks* together = nullptr;  // that share the batch
  const auto work = [&](Eigen::Index s, const std::atomic<bool>& halt) {
    solve_sample(s, samples, request, visit, halt, reused);
  };
  if (scheduled_) {
    scheduled_->begin_log();
    scheduled_->run_all(samples, least_, context, [&](Eigen::Index s, const SolverRuns::Run& run) {
      finish_sample(s, run, request, visit, reused);
    });
  } else if (context.share != nullptr) {
    RankShare::Numbers numbers(*context.share, samples.rows(), 1);
    const auto next = [&] { return static_cast<Eigen::Index>(numbers.take()); };
    SamplePool(samples.rows(), runs_.command().parallel, work, next).wait(context);
    together = &context.share->ranks();
  } else {
    SamplePool(samples.rows(), runs_.command().parallel, work).wait(context);
  }
  runs_.flush();
  failures_.end_batch(together);
  std::int64_t repeated = reused;
  if (together != nullptr) {
    const std::vector<std::int64_t> counts = gather_values(*together, repeated);
    repeated = std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
  }
  return {.runs = samples.rows(), .repeated = repeated};
}

Eigen::MatrixXd ExternalSolver::cosines(const ModeSet& reference, const ModeSet& modes) const {
  return shape_cosines(reference.shapes, modes.shapes);
}

Eigen::MatrixXd ExternalSolver::eigenvalue_derivatives(const Eigen::Ref<const Eigen::VectorXd>&,
                                                       const ModeSet& modes) const {
  return Eigen::MatrixXd::Constant(modes.eigenvalues.size(), nominal_.size(), k_not_known);
}

Eigen::MatrixXd ExternalSolver::shape_derivatives(const Eigen::Ref<const Eigen::VectorXd>&, const ModeSet& modes,
                                                  int) const {
  return Eigen::MatrixXd::Constant(modes.shapes.rows(), nominal_.size(), k_not_known);
}

std::vector<Eigen::MatrixXd> ExternalSolver::static_derivatives(const Eigen::Ref<const Eigen::VectorXd>&,
                                                                const Eigen::MatrixXd& loads,
                                                                const ObservationMatrix& observation) const {
  return {static_cast<std::size_t>(loads.cols()),
          Eigen::MatrixXd::Constant(observation.rows(), nominal_.size(), k_not_known)};
}

}  // namespace mottle::drivers
