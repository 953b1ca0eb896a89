// One connection to a HTTP server: a request at a time, ended by its answer, a time limit or a stop request.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "mottle/drivers/umbridge/http_address.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

/// An answer is no longer than this.
inline constexpr std::size_t k_largest_answer = std::size_t{16} << 20;

struct HttpRequest {
  std::string path;                                ///< "/Evaluate", behind the address's own path
  std::optional<std::string> body = std::nullopt;  ///< JSON to post; nothing: the path is got
};

struct HttpReply {
  std::string failure = {};  ///< why there is no answer; empty: there is one
  int status = 0;
  std::string body = {};
};

/// The addresses that a host's name stands for, once they are known: to look a name up may take long, and cannot be cut
/// short. Several connections share it.
class KnownHost;
std::shared_ptr<KnownHost> make_known_host();

class HttpConnection {
 public:
  /// @param host  of all connections to this address; where none of its addresses takes a connection any more, the name
  ///              is looked up again
  HttpConnection(HttpAddress address, std::shared_ptr<KnownHost> host);
  ~HttpConnection();
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  const HttpAddress& address() const { return address_; }

  /// Connects where it is not connected, sends the request and reads the answer. A connection that the server closed
  /// while it was idle is made anew.
  ///
  /// @param timeout  of it all; connecting takes 10 s at most
  /// @param stop     ends it within 0.1 s, or as soon as the host's name is looked up; nullptr: nothing does
  /// @throws Stopped
  HttpReply send(const HttpRequest& request, std::chrono::milliseconds timeout, const std::atomic<bool>* stop);

 private:
  class Stream;
  HttpAddress address_;
  std::shared_ptr<KnownHost> host_;
  std::unique_ptr<Stream> stream_;
};

}  // namespace mottle::drivers
