#include "mottle/drivers/command/external_structure.hpp"

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <limits>
#include <system_error>
#include <thread>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/dynamics/modes/mac.hpp"

namespace mottle {
namespace {

constexpr double k_not_known = std::numeric_limits<double>::quiet_NaN();

[[noreturn]] void refuse(const SolverRuns::Run& run) {
  const std::string said = run.last_words.empty() ? "" : fmt::format("; it said: {}", run.last_words);
  const std::string kept = run.folder.empty() ? "" : fmt::format("; its files are in {}", run.folder.string());
  throw ModelFailure(fmt::format("the solver's run failed: {}{}{}", run.record.failure, said, kept));
}

}  // namespace

/// Hands samples to several threads, each of which runs one solver at a time; the thread that owns the pool tells
/// progress and passes a stop request on.
class ExternalStructure::Pool {
 public:
  Pool(Eigen::Index count, int parallel, std::function<void(Eigen::Index, const std::atomic<bool>&)> work)
      : count_(count), work_(std::move(work)) {
    const auto threads = std::min<Eigen::Index>(count, parallel);
    try {
      for (Eigen::Index t = 0; t < threads; ++t) threads_.emplace_back([this] { take_samples(); });
    } catch (const std::system_error& error) {  // fewer at once, then
      if (threads_.empty()) throw SystemFailure(fmt::format("no thread can be started: {}", error.code().message()));
    }
  }
  ~Pool() { halt_ = true; }
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;

  /// Throws what a run threw, and Stopped.
  void wait(const RunContext& context) {
    using Clock = std::chrono::steady_clock;
    Clock::time_point told = Clock::now();
    std::unique_lock<std::mutex> lock(mutex_);
    while (idle_ < threads_.size()) {
      changed_.wait_for(lock, std::chrono::milliseconds(100));
      if (context.stop_requested()) halt_ = true;
      if (Clock::now() - told < std::chrono::seconds(1)) continue;
      told = Clock::now();
      context.progress("solver runs", done_, count_);
    }
    if (error_) std::rethrow_exception(error_);
    context.throw_if_stopped();
  }

 private:
  void take_samples() {
    for (Eigen::Index sample = next_++; sample < count_ && !halt_; sample = next_++) {
      try {
        work_(sample, halt_);
        const std::lock_guard<std::mutex> lock(mutex_);
        ++done_;
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!error_ && !halt_) error_ = std::current_exception();
        halt_ = true;
      }
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    ++idle_;
    changed_.notify_all();
  }

  Eigen::Index count_;
  std::function<void(Eigen::Index, const std::atomic<bool>&)> work_;
  std::atomic<Eigen::Index> next_{0};
  std::atomic<bool> halt_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::exception_ptr error_;
  std::int64_t done_ = 0;
  std::size_t idle_ = 0;
  std::vector<std::jthread> threads_;  // last: they end before what they use
};

ExternalStructure::ExternalStructure(SolverCommand command, const std::vector<std::string>& names,
                                     const Eigen::VectorXd& nominal, const Eigen::VectorXd& deviations,
                                     const SolverPlace& place, const std::atomic<bool>* stop)
    : runs_(std::move(command), names, place),
      nominal_(nominal),
      least_(runs_.command().frequencies.modes),
      stop_(stop) {
  SolverRuns::Run run = runs_.run(nominal, std::max(1, least_), stop);
  if (!run.record.failure.empty()) refuse(run);
  modes_ = std::move(run.record.modes);
  if (least_ == 0) {
    least_ = static_cast<int>(mode_count());
    runs_.keep_as(nominal, least_, {.failure = {}, .modes = modes_});
  }
  for (std::size_t row = 0; row < modes_.degree_of_freedom_names.size(); ++row) {
    rows_[modes_.degree_of_freedom_names[row]] = static_cast<int>(row);
  }
  for (const std::string& spot : runs_.coarse_places(nominal, difference_step() * deviations)) {
    notes_.push_back(
        fmt::format("{} has too few digits for differences by {} of a prior deviation: derivatives will be "
                    "poor; give it more",
                    spot, difference_step()));
  }
}

int ExternalStructure::find_degree_of_freedom(const std::string& name) const {
  const auto found = rows_.find(name);
  return found == rows_.end() ? -1 : found->second;
}

std::string ExternalStructure::unknown_degree_of_freedom(const std::string& name) const {
  constexpr std::size_t k_listed = 12;
  if (rows_.empty()) return "the model gives no shapes; say in [model.shapes] where they stand";
  std::vector<std::string> known = modes_.degree_of_freedom_names;
  if (known.size() > k_listed) {
    known.resize(k_listed);
    known.emplace_back("...");
  }
  if (name.empty()) return fmt::format("none is named, known: {}", join(known));
  return unknown_name_message("degree of freedom", name, known);
}

Eigen::MatrixXd ExternalStructure::displacements(const Eigen::Ref<const Eigen::MatrixXd>& shapes,
                                                 const std::vector<int>& degrees_of_freedom) const {
  return shapes(degrees_of_freedom, Eigen::all);
}

ModeSet ExternalStructure::modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int /*modes*/) const {
  if (parameters == nominal_) return {modes_.eigenvalues, modes_.shapes};
  SolverRuns::Run run = runs_.run(parameters, least_, stop_);
  if (!run.record.failure.empty()) refuse(run);
  return {std::move(run.record.modes.eigenvalues), std::move(run.record.modes.shapes)};
}

std::string ExternalStructure::observe(const ExtractedModes& found, const ModalObservation& observation,
                                       ObservedModes& observed) const {
  observed.eigenvalues = found.eigenvalues;
  if (!observation.needs_shapes()) return {};
  if (found.degree_of_freedom_names != modes_.degree_of_freedom_names) {
    return "its shapes have other degrees of freedom than those at the parameters' means";
  }
  const ModeSet modes{found.eigenvalues, found.shapes};
  if (observation.reference.shapes.cols() > 0) observed.cosines = cosines(observation.reference, modes);
  observed.displacements = displacements(found.shapes, observation.degrees_of_freedom);
  return {};
}

namespace {

/// Throws where so many failed that chance cannot be why, or, at the end of a batch, too many at all.
void require_few_failures(std::int64_t done, std::int64_t failed, double largest_part, bool is_end,
                          const std::string& last) {
  constexpr std::int64_t k_fewest = 20;
  const auto runs = static_cast<double>(done);
  const double slack = is_end ? 0.0 : 3.0 * std::sqrt(largest_part * (1.0 - largest_part) * runs);
  if (done < k_fewest || static_cast<double>(failed) <= largest_part * runs + slack) return;
  throw SystemFailure(
      fmt::format("{} of {} solver runs failed, at most {:.0f} % may (model.largest_failed_part); folders "
                  "of failed runs are in failed-runs; the last: {}",
                  failed, done, 100.0 * largest_part, last));
}

}  // namespace

SolverUse ExternalStructure::solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, int /*modes*/,
                                   const ModalObservation& observation, const RunContext& context,
                                   const Visitor& visit) const {
  const double part = runs_.command().largest_failed_part;
  std::atomic<std::int64_t> reused{0};
  std::mutex mutex;
  std::string last_failure;
  const auto work = [&](Eigen::Index s, const std::atomic<bool>& halt) {
    ObservedModes observed;
    if (!samples.row(s).allFinite()) return visit(s, observed, "a parameter is not finite");
    SolverRuns::Run run;
    try {
      run = runs_.run(samples.row(s).transpose(), least_, &halt);
    } catch (const FormatError& error) {  // a value that does not fit into its place
      run.record.failure = error.what();
    }
    std::string failure = run.record.failure;
    if (failure.empty()) failure = observe(run.record.modes, observation, observed);
    visit(s, observed, failure);
    if (run.is_reused) ++reused;
    const std::int64_t done = ++done_;
    if (failure.empty()) return;
    const std::int64_t failed = ++failed_;
    const std::lock_guard<std::mutex> lock(mutex);
    last_failure = failure;
    require_few_failures(done, failed, part, false, failure);
  };
  Pool(samples.rows(), runs_.command().parallel, work).wait(context);
  if (!last_failure.empty()) require_few_failures(done_, failed_, part, true, last_failure);
  return {.runs = samples.rows(), .repeated = reused};
}

Eigen::MatrixXd ExternalStructure::cosines(const ModeSet& reference, const ModeSet& modes) const {
  return shape_cosines(reference.shapes, modes.shapes);
}

Eigen::MatrixXd ExternalStructure::eigenvalue_derivatives(const Eigen::Ref<const Eigen::VectorXd>&,
                                                          const ModeSet& modes) const {
  return Eigen::MatrixXd::Constant(modes.eigenvalues.size(), parameter_count(), k_not_known);
}

Eigen::MatrixXd ExternalStructure::shape_derivatives(const Eigen::Ref<const Eigen::VectorXd>&, const ModeSet& modes,
                                                     int) const {
  return Eigen::MatrixXd::Constant(modes.shapes.rows(), parameter_count(), k_not_known);
}

Eigen::VectorXd ExternalStructure::damping_ratios(const Eigen::Ref<const Eigen::VectorXd>&,
                                                  const ModeSet& modes) const {
  return Eigen::VectorXd::Constant(modes.eigenvalues.size(), k_not_known);
}

double ExternalStructure::total_mass(const Eigen::Ref<const Eigen::VectorXd>&) const {
  return k_not_known;
}

std::vector<std::string> ExternalStructure::description(const Eigen::Ref<const Eigen::VectorXd>&) const {
  std::vector<std::string> lines{fmt::format("model: by command '{}', {} modes a run, {} at once, total mass not known",
                                             runs_.command_text(), least_, runs_.command().parallel)};
  if (!rows_.empty()) lines.push_back(fmt::format("shapes: {} degrees of freedom", rows_.size()));
  return lines;
}

}  // namespace mottle
