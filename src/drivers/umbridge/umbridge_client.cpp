#include "drivers/umbridge/umbridge_client.hpp"

#include <algorithm>
#include <thread>
#include <tuple>

#include "mottle/core/text.hpp"
#include "mottle/core/utf8.hpp"

namespace mottle::drivers {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds k_contact{60'000};  // what a server offers is no computation
constexpr milliseconds k_rest{5'000};      // one that is down answers at once, and would draw all requests to itself

/// Waits, longer after each try that got no answer: a container may be starting again.
void pause_before(int try_number, const std::atomic<bool>* stop) {
  const milliseconds longest{5'000};
  const Clock::time_point end =
      Clock::now() + std::min(longest, milliseconds(100) * (1 << std::min(2 * try_number, 10)));
  while (Clock::now() < end) {
    if (stop != nullptr && stop->load(std::memory_order_relaxed)) throw Stopped("stopped on request");
    std::this_thread::sleep_for(milliseconds(20));
  }
}

}  // namespace

UmbridgeClient::UmbridgeClient(const UmbridgeServer& server, const std::atomic<bool>* stop) : server_(server) {
  for (const HttpAddress& address : server_.urls) {
    ServedShape found = ask(address, stop);
    const bool is_first = sites_.empty();
    require_fit(is_first || found == shape_, "urls",
                "{} and {} do not offer the same: model, sizes of inputs and outputs or derivatives differ",
                server_.urls.front().text(), address.text());
    if (is_first) shape_ = std::move(found);
    sites_.push_back({.address = address, .host = make_known_host()});
  }
  model_ = {.name = shape_.name, .config = server_.config};
}

HttpReply UmbridgeClient::contact(const HttpAddress& address, const HttpRequest& request,
                                  const std::atomic<bool>* stop) const {
  HttpReply reply =
      HttpConnection(address, make_known_host()).send(request, std::min(server_.timeout, k_contact), stop);
  if (!reply.failure.empty()) {
    throw SystemFailure(fmt::format("{}: {}; is the model's server running?", address.text(), reply.failure));
  }
  return reply;
}

std::string UmbridgeClient::choose_name(const HttpAddress& address, const ServerInfo& info) const {
  require_fit(info.protocol_version == 1.0, "urls", "{} speaks version {} of UM-Bridge's protocol; 1.0 is needed",
              address.text(), number_text(info.protocol_version));
  require_fit(!info.models.empty(), "urls", "{} offers no model", address.text());
  std::vector<std::string> known;
  for (const std::string& model : info.models) known.push_back(printable(model));
  if (server_.name.empty()) {
    require_fit(info.models.size() == 1, "name", "is missing; {} offers {} models, choose one of: {}", address.text(),
                known.size(), join(known));
    return info.models.front();
  }
  const bool is_there = std::find(info.models.begin(), info.models.end(), server_.name) != info.models.end();
  require_fit(is_there, "name", "{} (at {})", unknown_name_message("model", server_.name, known), address.text());
  return server_.name;
}

ServedShape UmbridgeClient::ask(const HttpAddress& address, const std::atomic<bool>* stop) const {
  std::string path = "/Info";
  try {
    const HttpReply info = contact(address, {.path = path}, stop);
    ServedShape shape{.name = choose_name(address, read_info(info.status, info.body))};
    const auto post = [&](std::string next) {
      path = std::move(next);
      return contact(address, {path, model_request({shape.name, server_.config})}, stop);
    };
    const HttpReply features = post("/ModelInfo");
    shape.features = read_features(features.status, features.body);
    require_fit(shape.features.evaluate, "name", "'{}' at {} cannot be evaluated", printable(shape.name),
                address.text());
    const HttpReply inputs = post("/InputSizes");
    shape.inputs = read_sizes(inputs.status, inputs.body, "inputSizes");
    const HttpReply outputs = post("/OutputSizes");
    shape.outputs = read_sizes(outputs.status, outputs.body, "outputSizes");
    return shape;
  } catch (const AnswerFault& fault) {
    throw SystemFailure(
        fmt::format("{}{} does not answer as UM-Bridge's protocol 1.0 says: {}", address.text(), path, fault.what()));
  }
}

/// The one with the fewest requests that is not resting and not the one that has just failed; else any. Waits while as
/// many requests are under way as there may be.
std::size_t UmbridgeClient::take_site(std::size_t avoided, const std::atomic<bool>* stop) {
  std::unique_lock<std::mutex> lock(mutex_);
  while (busy_ >= std::max(server_.parallel, 1)) {
    if (stop != nullptr && stop->load(std::memory_order_relaxed)) throw Stopped("stopped on request");
    given_back_.wait_for(lock, milliseconds(100));
  }
  ++busy_;
  const Clock::time_point now = Clock::now();
  const auto rank = [&](std::size_t i) {
    return std::tuple(i == avoided, sites_[i].rests_until > now, sites_[i].busy);
  };
  std::size_t best = 0;
  for (std::size_t i = 1; i < sites_.size(); ++i) {
    if (rank(i) < rank(best)) best = i;
  }
  ++sites_[best].busy;
  return best;
}

void UmbridgeClient::give_back(std::size_t site, std::unique_ptr<HttpConnection> connection, bool is_sound) {
  const std::lock_guard<std::mutex> lock(mutex_);
  Site& used = sites_[site];
  --used.busy;
  --busy_;
  given_back_.notify_one();
  used.rests_until = is_sound ? Clock::time_point() : Clock::now() + k_rest;
  if (connection) used.idle.push_back(std::move(connection));
}

HttpReply UmbridgeClient::send_to(std::size_t site, const HttpRequest& request, const std::atomic<bool>* stop) {
  std::unique_ptr<HttpConnection> connection;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::vector<std::unique_ptr<HttpConnection>>& idle = sites_[site].idle;
    if (!idle.empty()) {
      connection = std::move(idle.back());
      idle.pop_back();
    }
  }
  if (!connection) connection = std::make_unique<HttpConnection>(sites_[site].address, sites_[site].host);
  HttpReply reply{.failure = "stopped"};
  try {
    reply = connection->send(request, server_.timeout, stop);
  } catch (...) {
    give_back(site, nullptr, false);
    throw;
  }
  if (!reply.failure.empty()) connection.reset();
  constexpr int k_server_error = 500;
  const bool is_sound = reply.failure.empty() && (reply.status < k_server_error || tells_error(reply.body));
  give_back(site, std::move(connection), is_sound);
  return reply;
}

template <typename Values, typename Read>
UmbridgeClient::Answer<Values> UmbridgeClient::ask_until_answered(const HttpRequest& request, const Read& read,
                                                                  const std::atomic<bool>* stop) {
  std::string failure;
  std::size_t last = sites_.size();
  for (int number = 0; number <= server_.retries; ++number) {
    const int rounds = number / static_cast<int>(sites_.size());  // in which every server was asked
    if (number > 0 && number % static_cast<int>(sites_.size()) == 0) pause_before(rounds - 1, stop);
    const std::size_t site = take_site(last, stop);
    last = site;
    HttpReply reply = send_to(site, request, stop);
    try {
      if (reply.failure.empty()) return {.values = read(reply)};
    } catch (const AnswerFault& fault) {
      reply.failure = fault.what();
    }
    failure = fmt::format("{}: {}", sites_[site].address.text(), reply.failure);
    if (number > 0) failure += fmt::format(" ({} tries)", number + 1);
  }
  return {.failure = std::move(failure)};
}

UmbridgeClient::Answer<Vectors> UmbridgeClient::evaluate(const Vectors& input, const std::atomic<bool>* stop) {
  return ask_until_answered<Vectors>(
      {"/Evaluate", evaluate_request(model_, input)},
      [&](const HttpReply& reply) { return read_output(reply.status, reply.body, shape_.outputs); }, stop);
}

UmbridgeClient::Answer<std::vector<double>> UmbridgeClient::gradient(const Vectors& input, std::size_t out,
                                                                     std::size_t in, const std::vector<double>& sens,
                                                                     const std::atomic<bool>* stop) {
  return ask_until_answered<std::vector<double>>(
      {"/Gradient", gradient_request(model_, input, out, in, sens)},
      [&](const HttpReply& reply) { return read_vector(reply.status, reply.body, shape_.inputs[in]); }, stop);
}

UmbridgeClient::Answer<std::vector<double>> UmbridgeClient::apply_jacobian(const Vectors& input, std::size_t out,
                                                                           std::size_t in,
                                                                           const std::vector<double>& vec,
                                                                           const std::atomic<bool>* stop) {
  return ask_until_answered<std::vector<double>>(
      {"/ApplyJacobian", jacobian_request(model_, input, out, in, vec)},
      [&](const HttpReply& reply) { return read_vector(reply.status, reply.body, shape_.outputs[out]); }, stop);
}

}  // namespace mottle::drivers
