// Requests to the servers of one model: which server takes a request, what is tried again, what an answer says.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "drivers/umbridge/http_client.hpp"
#include "drivers/umbridge/protocol.hpp"
#include "mottle/drivers/umbridge/umbridge_server.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

/// What the servers say of the model.
struct ServedShape {
  std::string name;
  std::vector<std::size_t> inputs = {};   ///< sizes of the input vectors
  std::vector<std::size_t> outputs = {};  ///< and of the output vectors
  SupportedFeatures features = {};

  bool operator==(const ServedShape&) const = default;
};

class UmbridgeClient {
 public:
  /// Asks every server what it offers.
  ///
  /// @param server  no more than its `parallel` requests are under way at any time, whoever asks
  /// @param stop  nullptr: nothing stops it
  /// @throws InvalidInput   servers that disagree, a name that no model has or that is missing, a model that cannot be
  ///                        evaluated, another version of the protocol
  /// @throws SystemFailure  a server that does not answer, or not as the protocol says; Stopped
  UmbridgeClient(const UmbridgeServer& server, const std::atomic<bool>* stop);

  const ServedShape& shape() const { return shape_; }

  /// The result of one request; called by several threads at once.
  template <typename Values>
  struct Answer {
    std::string failure = {};  ///< with the server's address; empty: there are values
    Values values = {};
  };

  /// Throws Stopped.
  Answer<Vectors> evaluate(const Vectors& input, const std::atomic<bool>* stop);
  /// Of `sens . output[out]` with respect to input[in].
  Answer<std::vector<double>> gradient(const Vectors& input, std::size_t out, std::size_t in,
                                       const std::vector<double>& sens, const std::atomic<bool>* stop);
  /// The derivative of output[out] with respect to input[in], times `vec`.
  Answer<std::vector<double>> apply_jacobian(const Vectors& input, std::size_t out, std::size_t in,
                                             const std::vector<double>& vec, const std::atomic<bool>* stop);

 private:
  struct Site {
    HttpAddress address;
    std::shared_ptr<KnownHost> host;
    std::vector<std::unique_ptr<HttpConnection>> idle = {};
    int busy = 0;
    std::chrono::steady_clock::time_point rests_until =
        {};  ///< after it gave no answer, or an error that is not the model's
  };
  HttpReply contact(const HttpAddress& address, const HttpRequest& request, const std::atomic<bool>* stop) const;
  ServedShape ask(const HttpAddress& address, const std::atomic<bool>* stop) const;
  std::string choose_name(const HttpAddress& address, const ServerInfo& info) const;
  std::size_t take_site(std::size_t avoided, const std::atomic<bool>* stop);
  void give_back(std::size_t site, std::unique_ptr<HttpConnection> connection, bool is_sound);
  HttpReply send_to(std::size_t site, const HttpRequest& request, const std::atomic<bool>* stop);
  template <typename Values, typename Read>
  Answer<Values> ask_until_answered(const HttpRequest& request, const Read& read, const std::atomic<bool>* stop);

  UmbridgeServer server_;
  ModelName model_;
  ServedShape shape_;
  std::vector<Site> sites_;
  int busy_ = 0;      ///< requests under way
  std::mutex mutex_;  // of the sites and their number of requests
  std::condition_variable given_back_;
};

}  // namespace mottle::drivers
