// Derivatives of an UmbridgeSolver, by the requests that the servers offer for them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "drivers/umbridge/input_map.hpp"
#include "drivers/umbridge/umbridge_client.hpp"
#include "mottle/drivers/umbridge/umbridge_solver.hpp"

namespace mottle::drivers {
namespace {

constexpr double k_not_known = std::numeric_limits<double>::quiet_NaN();

}  // namespace

/// Of requests by several threads.
struct UmbridgeSolver::FirstFailure {
  std::string text = {};
  std::mutex mutex = {};
};

void UmbridgeSolver::say_failure(FirstFailure& failure, const std::string& text) {
  const std::lock_guard<std::mutex> lock(failure.mutex);
  if (failure.text.empty()) failure.text = text;
}

bool UmbridgeSolver::has_derivatives() const {
  const SupportedFeatures& features = client_->shape().features;
  return server_.uses_derivatives && (features.apply_jacobian || features.gradient);
}

Eigen::Index UmbridgeSolver::jacobian_requests() const {
  Eigen::Index count = 0;
  for (Eigen::Index p = 0; p < nominal_.size(); ++p) {
    for (std::size_t v = 0; v < inputs_->vectors(); ++v) count += inputs_->acts(p, v) ? 1 : 0;
  }
  return count * (1 + static_cast<Eigen::Index>(places_.back().vector - places_.front().vector));
}

Eigen::Index UmbridgeSolver::gradient_requests(Eigen::Index modes) const {
  Eigen::Index count = 0;
  for (std::size_t v = 0; v < inputs_->vectors(); ++v) count += inputs_->moves(v) ? modes : 0;
  return count;
}

bool UmbridgeSolver::prefers_jacobian(Eigen::Index modes) const {
  const SupportedFeatures& features = client_->shape().features;
  return features.apply_jacobian && (!features.gradient || jacobian_requests() <= gradient_requests(modes));
}

bool UmbridgeSolver::has_cheap_derivatives() const {
  const auto modes = static_cast<Eigen::Index>(places_.size());
  const Eigen::Index requests = prefers_jacobian(modes) ? jacobian_requests() : gradient_requests(modes);
  return requests <= 2 * nominal_.size();
}

/// Adds d output / d parameter of every mode; nan where a request fails.
void UmbridgeSolver::add_jacobian_column(const Vectors& input, Eigen::Index parameter, Eigen::MatrixXd& derivatives,
                                         FirstFailure& failure, const std::atomic<bool>& halt) const {
  const std::size_t outs = client_->shape().outputs.size();
  for (std::size_t in = 0; in < input.size(); ++in) {
    if (!inputs_->acts(parameter, in)) continue;
    const std::vector<double> direction = inputs_->direction(parameter, in);
    std::vector<UmbridgeClient::Answer<std::vector<double>>> answers(outs);
    for (Eigen::Index mode = 0; mode < derivatives.rows(); ++mode) {
      const Place& place = places_[static_cast<std::size_t>(mode)];
      auto& answer = answers[place.vector];
      const bool is_asked = !answer.failure.empty() || !answer.values.empty();
      if (!is_asked) answer = client_->apply_jacobian(input, place.vector, in, direction, &halt);
      if (!is_asked) say_failure(failure, answer.failure);
      derivatives(mode, parameter) += answer.failure.empty() ? answer.values[place.number] : k_not_known;
    }
  }
}

void UmbridgeSolver::add_gradient_row(const Vectors& input, Eigen::Index mode, Eigen::MatrixXd& derivatives,
                                      FirstFailure& failure, const std::atomic<bool>& halt) const {
  const Place& place = places_[static_cast<std::size_t>(mode)];
  std::vector<double> sens(client_->shape().outputs[place.vector]);
  sens[place.number] = 1.0;
  for (std::size_t in = 0; in < input.size(); ++in) {
    if (!inputs_->moves(in)) continue;
    auto answer = client_->gradient(input, place.vector, in, sens, &halt);
    say_failure(failure, answer.failure);
    if (!answer.failure.empty()) answer.values.assign(input[in].size(), k_not_known);
    inputs_->add_gradient(answer.values, in, derivatives.row(mode));
  }
}

Eigen::MatrixXd UmbridgeSolver::eigenvalue_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                       const ModeSet& modes) const {
  const Eigen::Index count = modes.eigenvalues.size();
  if (!has_derivatives()) return Eigen::MatrixXd::Constant(count, nominal_.size(), k_not_known);
  const RunRecord asked =
      once(fmt::format("derivatives of {} ", count), parameters, [&] { return asked_derivatives(parameters, count); });
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++derivatives_;
    if (!asked.failure.empty() && ++failed_derivatives_ == 1) derivative_failure_ = asked.failure;
  }
  Eigen::MatrixXd derivatives = asked.modes.shapes;
  for (Eigen::Index mode = 0; mode < count; ++mode) derivatives.row(mode) *= slope_of(modes.eigenvalues(mode));
  return derivatives;
}

std::string UmbridgeSolver::derivatives_note() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (failed_derivatives_ == 0) return {};
  return fmt::format(
      "a request for derivatives failed {} of the {} times that they were asked for, and differences took their place; "
      "the first: {}",
      failed_derivatives_, derivatives_, derivative_failure_);
}

/// Of the outputs of the first modes [mode x parameter], nan where a request fails; with the reason of one that did.
RunRecord UmbridgeSolver::asked_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                            Eigen::Index count) const {
  FirstFailure failure;
  Eigen::MatrixXd derivatives = Eigen::MatrixXd::Zero(count, nominal_.size());
  const Vectors input = inputs_->input_at(parameters);
  const bool by_columns = prefers_jacobian(count);
  const auto work = [&](Eigen::Index index, const std::atomic<bool>& halt) {
    if (by_columns) {
      add_jacobian_column(input, index, derivatives, failure, halt);
    } else {
      add_gradient_row(input, index, derivatives, failure, halt);
    }
  };
  SamplePool(by_columns ? nominal_.size() : count, server_.parallel, work).wait({.stop = stop_});
  return {.failure = failure.text, .modes = {.shapes = std::move(derivatives)}};
}

}  // namespace mottle::drivers
