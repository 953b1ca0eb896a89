#include "mottle/drivers/umbridge/umbridge_solver.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include "drivers/umbridge/input_map.hpp"
#include "drivers/umbridge/umbridge_client.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/rank_share.hpp"
#include "mottle/core/text.hpp"
#include "mottle/core/utf8.hpp"
#include "mottle/drivers/command/run_folders.hpp"

namespace mottle::drivers {
namespace {

constexpr double k_not_known = std::numeric_limits<double>::quiet_NaN();
constexpr double k_two_pi = 2.0 * std::numbers::pi;
// To keep an evaluation takes a write to the disk that is waited for; a quick one is rather made again.
constexpr std::chrono::milliseconds k_worth_keeping{50};

constexpr std::size_t k_max_recalled = 4096;

/// The requests at once are those of all ranks together: as evenly as they can be divided, the first rank has one at
/// least.
UmbridgeServer with_own_part(UmbridgeServer server, const Ranks* ranks) {
  if (server.parallel == 0) server.parallel = static_cast<int>(server.urls.size());
  if (ranks == nullptr) return server;
  const bool has_one_more = ranks->rank() < server.parallel % ranks->count();
  server.parallel = server.parallel / ranks->count() + (has_one_more ? 1 : 0);
  return server;
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
    : server_(with_own_part(std::move(server), storage.ranks)),
      nominal_(nominal),
      client_(std::make_unique<UmbridgeClient>(server_, stop)),
      is_resumed_(storage.is_resumed),
      ranks_(storage.ranks),
      stop_(stop),
      failures_({server_.max_failed_fraction, "evaluations by the servers", ""}, storage.ranks) {
  inputs_ = std::make_unique<InputMap>(server_.inputs, client_->shape().inputs, names);
  map_outputs();
  describe();
  forget_answers(storage);
  evaluate_means();
  if (!storage.results.empty()) open_store(storage);
}

UmbridgeSolver::~UmbridgeSolver() = default;

/// A job that is not resumed uses nothing old: the servers' model may be another one now.
void UmbridgeSolver::forget_answers(const RunStorage& storage) const {
  if (storage.results.empty() || storage.is_resumed || (ranks_ != nullptr && !ranks_->is_first())) return;
  require_no_linked_runs(storage.results);
  const RunStoreFiles files = run_store_files(storage.results, 0, 1, k_answer_store);
  std::error_code ignored;
  std::filesystem::remove(files.own, ignored);
  for (const std::filesystem::path& other : files.others) std::filesystem::remove(other, ignored);
}

/// By the first rank for all of them. None goes on before what is old is forgotten.
void UmbridgeSolver::evaluate_means() {
  RunRecord found;
  if (ranks_ == nullptr || ranks_->is_first()) found = ask(nominal_, stop_);
  if (ranks_ != nullptr) found = decode_run(ranks_->gather(ranks_->is_first() ? encode(found) : "").front());
  if (!found.failure.empty()) {
    throw ModelFailure(fmt::format("the model gives nothing at the parameters' means: {}", found.failure));
  }
  nominal_eigenvalues_ = found.modes.eigenvalues;
}

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

/// A job that is resumed must find the model that it left.
void UmbridgeSolver::open_store(const RunStorage& storage) {
  make_writable_folder(storage.results);
  require_no_linked_runs(storage.results);
  const int rank = ranks_ == nullptr ? 0 : ranks_->rank();
  const int ranks = ranks_ == nullptr ? 1 : ranks_->count();
  const RunStoreFiles files = run_store_files(storage.results, rank, ranks, k_answer_store);
  store_ = std::make_unique<RunStore>(files.own, files.others);
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
  if (rank == 0) store_->keep(key_of(nominal_), {.modes = {.eigenvalues = nominal_eigenvalues_}});
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
  std::string text =
      fmt::format("umbridge {} {} {}:{} {}:{}", static_cast<int>(server_.quantity), server_.output.value_or(-1),
                  client_->shape().name.size(), client_->shape().name, server_.config.size(), server_.config);
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
  if (record.failure.empty()) {  // failures are asked for again: the server may have been away
    const Digest key = key_of(parameters);
    if (store_ && std::chrono::steady_clock::now() - begin >= k_worth_keeping) store_->keep(key, record);
    const std::lock_guard<std::mutex> lock(mutex_);
    if (recent_.size() >= k_max_recalled) recent_.clear();
    recent_[key] = record.modes.eigenvalues;
  }
  return record;
}

RunRecord UmbridgeSolver::recalled_or_asked(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = recent_.find(key_of(parameters));
    if (found != recent_.end()) return {.modes = {.eigenvalues = found->second}};
  }
  if (store_) store_->look_at_others();
  bool is_reused = false;
  return evaluate(parameters, stop_, is_reused);
}

/// What ranks need outside of a batch is asked by one of them: a request that fails is to fail for all.
RunRecord UmbridgeSolver::once(const std::string& what, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                               const std::function<RunRecord()>& make) const {
  if (ranks_ == nullptr || !ranks_->is_together()) return make();
  const Digest key = digest_of(what + hexadecimal(key_of(parameters)));
  return decode_run(ranks_->once(key, server_.parallel > 0, [&] { return encode(make()); }));
}

ModeSet UmbridgeSolver::modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int modes) const {
  const Eigen::Index count = std::min<Eigen::Index>(modes, nominal_eigenvalues_.size());
  if (parameters == nominal_) return {nominal_eigenvalues_.head(count), {}};
  const RunRecord found = once("modes ", parameters, [&] { return recalled_or_asked(parameters); });
  if (!found.failure.empty()) throw ModelFailure(fmt::format("the evaluation failed: {}", found.failure));
  return {found.modes.eigenvalues.head(count), {}};
}

SolverUse UmbridgeSolver::solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, const SolutionRequest& /*request*/,
                                const RunContext& context, const Visitor& visit) const {
  if (store_) store_->look_at_others();
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
  if (context.share == nullptr) {
    SamplePool(samples.rows(), server_.parallel, work).wait(context);
    if (store_) store_->flush();
    failures_.end_batch();
    return {.runs = samples.rows(), .repeated = reused};
  }
  RankShare::Numbers numbers(*context.share, samples.rows(), 1);
  const auto next = [&] { return static_cast<Eigen::Index>(numbers.take()); };
  SamplePool(samples.rows(), server_.parallel, work, next).wait(context);
  if (store_) store_->flush();
  Ranks& ranks = context.share->ranks();
  failures_.end_batch(&ranks);
  std::int64_t repeated = 0;
  for (const std::int64_t count : gather_values(ranks, reused.load())) repeated += count;
  return {.runs = samples.rows(), .repeated = repeated};
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
