#include "mottle/drivers/umbridge/umbridge_solver.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include "drivers/umbridge/input_map.hpp"
#include "drivers/umbridge/umbridge_client.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"
#include "mottle/core/utf8.hpp"
#include "mottle/drivers/command/run_folders.hpp"

namespace mottle::drivers {
namespace {

constexpr double k_not_known = std::numeric_limits<double>::quiet_NaN();
constexpr double k_two_pi = 2.0 * std::numbers::pi;
// To keep an evaluation takes a write to the disk that is waited for; a quick one is rather made again.
constexpr std::chrono::milliseconds k_worth_keeping{50};

Digest digest_of(const std::string& text) {
  Checksum sum;
  sum.add(text);
  return sum.digest();
}

}  // namespace

std::string UmbridgeStructure::unknown_degree_of_freedom(const std::string&) const {
  return "a model behind UM-Bridge gives natural frequencies and no shapes";
}

double UmbridgeStructure::total_mass(const Eigen::Ref<const Eigen::VectorXd>&) const {
  return k_not_known;
}

UmbridgeSolver::UmbridgeSolver(UmbridgeServer server, const std::vector<std::string>& names,
                               const Eigen::VectorXd& nominal, const RunStorage& storage, const std::atomic<bool>* stop)
    : server_(std::move(server)),
      nominal_(nominal),
      client_(std::make_unique<UmbridgeClient>(server_, stop)),
      is_resumed_(storage.is_resumed),
      stop_(stop),
      failures_({server_.max_failed_fraction, "evaluations by the servers", ""}) {
  if (server_.parallel == 0) server_.parallel = static_cast<int>(server_.urls.size());
  inputs_ = std::make_unique<InputMap>(server_.inputs, client_->shape().inputs, names);
  map_outputs();
  describe();
  const RunRecord found = ask(nominal_, stop);
  if (!found.failure.empty()) {
    throw ModelFailure(fmt::format("the model gives nothing at the parameters' means: {}", found.failure));
  }
  nominal_eigenvalues_ = found.modes.eigenvalues;
  if (!storage.results.empty()) open_store(storage);
}

UmbridgeSolver::~UmbridgeSolver() = default;

void UmbridgeSolver::map_outputs() {
  const std::vector<std::size_t>& sizes = client_->shape().outputs;
  const bool is_there = !server_.output || static_cast<std::size_t>(*server_.output) < sizes.size();
  require_fit(is_there, "output", "is {}, and the model has {} output vectors, counted from 0",
              server_.output.value_or(0), sizes.size());
  for (std::size_t v = 0; v < sizes.size(); ++v) {
    if (server_.output && static_cast<std::size_t>(*server_.output) != v) continue;
    for (std::size_t i = 0; i < sizes[v]; ++i) places_.push_back({.vector = v, .number = i});
  }
  require_fit(!places_.empty(), "output", "holds no number: the model's outputs have the sizes {}",
              fmt::format("[{}]", fmt::join(sizes, ", ")));
}

void UmbridgeSolver::describe() {
  std::vector<std::string> urls;
  for (const HttpAddress& address : server_.urls) urls.push_back(address.text());
  const auto modes = static_cast<Eigen::Index>(places_.size());
  const char* derivatives = !has_derivatives()        ? "by differences"
                            : prefers_jacobian(modes) ? "of the model, by ApplyJacobian"
                                                      : "of the model, by Gradient";
  std::vector<std::string> lines{
      fmt::format("model: '{}' by UM-Bridge at {}, {} frequencies, {} requests at once, total mass not known",
                  printable(client_->shape().name), join(urls), modes, server_.parallel),
      fmt::format("derivatives: {}", derivatives)};
  structure_ = std::make_unique<UmbridgeStructure>(nominal_.size(), modes, std::move(lines));
}

/// A job that is not resumed forgets what was kept: the servers' model may be another one now. One that is resumed
/// must find the model that it left.
void UmbridgeSolver::open_store(const RunStorage& storage) {
  make_writable_folder(storage.results);
  require_no_linked_runs(storage.results);
  store_ = std::make_unique<RunStore>(storage.results / k_run_store);
  const Digest head = digest_of("umbridge epoch");
  const std::optional<RunRecord> last = store_->find(head);
  const int number = last ? std::atoi(last->failure.c_str()) : 0;
  epoch_ = fmt::format("{}", is_resumed_ && number > 0 ? number : number + 1);
  const std::optional<RunRecord> before = is_resumed_ ? store_->find(key_of(nominal_)) : std::nullopt;
  if (before) {
    constexpr double k_same = 1e-8;  // of the same model on another machine
    const Eigen::VectorXd& old = before->modes.eigenvalues;
    require_fit(
        old.size() == nominal_eigenvalues_.size() && old.isApprox(nominal_eigenvalues_, k_same), "urls",
        "the servers answer otherwise than before at the parameters' means: their model has changed; start anew "
        "without --resume");
    return;
  }
  store_->keep(head, {.failure = epoch_});
  store_->keep(key_of(nominal_), {.modes = {.eigenvalues = nominal_eigenvalues_}});
}

double UmbridgeSolver::eigenvalue_of(double output) const {
  using Quantity = FrequencyRule::Quantity;
  if (server_.quantity == Quantity::eigenvalue) return output;
  const double omega = server_.quantity == Quantity::hertz ? k_two_pi * output : output;
  return omega * omega;
}

/// d lambda / d output.
double UmbridgeSolver::slope_of(double eigenvalue) const {
  using Quantity = FrequencyRule::Quantity;
  if (server_.quantity == Quantity::eigenvalue) return 1.0;
  const double slope = 2.0 * std::sqrt(std::max(eigenvalue, 0.0));
  return server_.quantity == Quantity::hertz ? k_two_pi * slope : slope;
}

RunRecord UmbridgeSolver::ask(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                              const std::atomic<bool>* stop) const {
  const auto answer = client_->evaluate(inputs_->input_at(parameters), stop);
  if (!answer.failure.empty()) return {.failure = answer.failure};
  RunRecord record;
  record.modes.eigenvalues.resize(static_cast<Eigen::Index>(places_.size()));
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const double output = answer.values[places_[k].vector][places_[k].number];
    if (output < 0.0 && server_.quantity != FrequencyRule::Quantity::eigenvalue) {
      return {.failure = fmt::format("output[{}][{}] is {}, and a frequency is not negative", places_[k].vector,
                                     places_[k].number, number_text(output))};
    }
    record.modes.eigenvalues(static_cast<Eigen::Index>(k)) = eigenvalue_of(output);
  }
  if (!record.modes.eigenvalues.allFinite()) return {.failure = "a frequency is too large"};
  return record;
}

Digest UmbridgeSolver::key_of(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  const Vectors input = inputs_->input_at(parameters);
  std::string text = fmt::format("umbridge {} {} {} {}:{} {}:{}", epoch_, static_cast<int>(server_.quantity),
                                 server_.output.value_or(-1), client_->shape().name.size(), client_->shape().name,
                                 server_.config.size(), server_.config);
  for (const std::vector<double>& vector : input) {
    text += fmt::format(" [{}]", vector.size());
    for (const double value : vector) text += ' ' + number_text(value);
  }
  return digest_of(text);
}

RunRecord UmbridgeSolver::evaluate(const Eigen::Ref<const Eigen::VectorXd>& parameters, const std::atomic<bool>* stop,
                                   bool& is_reused) const {
  is_reused = false;
  if (store_ && is_resumed_) {
    if (std::optional<RunRecord> known = store_->find(key_of(parameters))) {
      is_reused = true;
      return *std::move(known);
    }
  }
  const auto begin = std::chrono::steady_clock::now();
  RunRecord record = ask(parameters, stop);
  if (store_ && std::chrono::steady_clock::now() - begin >= k_worth_keeping) store_->keep(key_of(parameters), record);
  return record;
}

ModeSet UmbridgeSolver::modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int modes) const {
  const Eigen::Index count = std::min<Eigen::Index>(modes, nominal_eigenvalues_.size());
  if (parameters == nominal_) return {nominal_eigenvalues_.head(count), {}};
  bool is_reused = false;
  const RunRecord found = evaluate(parameters, stop_, is_reused);
  if (!found.failure.empty()) throw ModelFailure(fmt::format("the evaluation failed: {}", found.failure));
  return {found.modes.eigenvalues.head(count), {}};
}

SolverUse UmbridgeSolver::solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, const SolutionRequest& /*request*/,
                                const RunContext& context, const Visitor& visit) const {
  std::atomic<std::int64_t> reused{0};
  const auto work = [&](Eigen::Index s, const std::atomic<bool>& halt) {
    Solution solution;
    if (!samples.row(s).allFinite()) return visit(s, solution, "a parameter is not finite");
    bool is_reused = false;
    RunRecord found = evaluate(samples.row(s).transpose(), &halt, is_reused);
    solution.eigenvalues = std::move(found.modes.eigenvalues);
    visit(s, solution, found.failure);
    if (is_reused) ++reused;
    failures_.add(found.failure);
  };
  SamplePool(samples.rows(), server_.parallel, work).wait(context);
  failures_.end_batch();
  return {.runs = samples.rows(), .repeated = reused};
}

Eigen::MatrixXd UmbridgeSolver::cosines(const ModeSet&, const ModeSet&) const {
  return {};
}

Eigen::MatrixXd UmbridgeSolver::shape_derivatives(const Eigen::Ref<const Eigen::VectorXd>&, const ModeSet&, int) const {
  return Eigen::MatrixXd::Constant(0, nominal_.size(), k_not_known);
}

std::vector<Eigen::MatrixXd> UmbridgeSolver::static_derivatives(const Eigen::Ref<const Eigen::VectorXd>&,
                                                                const Eigen::MatrixXd& loads,
                                                                const ObservationMatrix& observation) const {
  return {static_cast<std::size_t>(loads.cols()),
          Eigen::MatrixXd::Constant(observation.rows(), nominal_.size(), k_not_known)};
}

}  // namespace mottle::drivers
