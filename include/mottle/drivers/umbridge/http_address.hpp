// Address of a model's server: http://HOST[:PORT][/PATH].
#pragma once

#include <string>

#include "mottle/layers.hpp"

namespace mottle::drivers {

struct HttpAddress {
  std::string host;         ///< a name or a numeric address, of IPv6 without its brackets
  std::string port = "80";  ///< 1 to 65535
  std::string path = {};    ///< in front of the protocol's own paths: "" or "/models"

  /// What a request's Host says: "localhost:4242", "[::1]:4242".
  std::string authority() const;
  /// "http://localhost:4242/models".
  std::string text() const { return "http://" + authority() + path; }
};

/// @throws InvalidInput  what is wrong with it: another scheme than http, a user's name, a query, a port out of range,
///                       a character that no address has
HttpAddress parse_http_address(const std::string& text);

}  // namespace mottle::drivers
