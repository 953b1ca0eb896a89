#include "mottle/drivers/umbridge/http_address.hpp"

#include <algorithm>
#include <string_view>

#include "mottle/core/error.hpp"

namespace mottle::drivers {
namespace {

constexpr std::string_view k_scheme = "http://";
constexpr std::string_view k_host_marks = "-._";
constexpr std::string_view k_path_marks = "-._~/%!$&'()*+,;=:@";

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

bool consists_of(std::string_view text, std::string_view marks) {
  return std::all_of(text.begin(), text.end(),
                     [&](char c) { return is_plain(c) || marks.find(c) != std::string_view::npos; });
}

void read_port(std::string_view digits, HttpAddress& address) {
  const bool is_number =
      !digits.empty() && digits.size() <= 5 && digits.find_first_not_of("0123456789") == std::string_view::npos;
  const int port = is_number ? std::stoi(std::string(digits)) : 0;
  require(port >= 1 && port <= 65535, "'{}' is not a port; allowed are 1 to 65535", digits);
  address.port = fmt::format("{}", port);
}

/// Schemes and hosts are the same in capitals.
std::string in_small_letters(std::string_view text) {
  std::string small(text);
  for (char& c : small) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return small;
}

/// The address as a message may show it: no password.
std::string shown(const std::string& text) {
  const std::size_t begin = text.find("://");
  const std::size_t first = begin == std::string::npos ? 0 : begin + 3;
  const std::size_t at = text.substr(0, text.find('/', first)).rfind('@');
  return at == std::string::npos || at < first ? text : text.substr(0, first) + "..." + text.substr(at);
}

}  // namespace

std::string HttpAddress::authority() const {
  const bool is_ipv6 = host.find(':') != std::string::npos;
  return is_ipv6 ? fmt::format("[{}]:{}", host, port) : fmt::format("{}:{}", host, port);
}

HttpAddress parse_http_address(const std::string& text) {
  const auto refuse = [&](std::string_view why) {
    throw InvalidInput(fmt::format("'{}' {}; give it like \"http://localhost:4242\"", shown(text), why));
  };
  const std::string scheme = in_small_letters(std::string_view(text).substr(0, text.find(':')));
  if (!in_small_letters(text).starts_with(k_scheme)) {
    refuse(scheme == "https" ? "is https, which is not spoken here" : "does not begin with http://");
  }
  const std::string_view rest = std::string_view(text).substr(k_scheme.size());
  const std::string_view authority = rest.substr(0, rest.find_first_of("/?#"));
  if (authority.find('@') != std::string_view::npos)
    refuse("has the character @: it names a user, and servers of models ask for none");
  if (rest.find_first_of("?#") != std::string_view::npos)
    refuse("has the character ? or #: a query or a fragment is never sent");
  HttpAddress address;
  address.path = rest.substr(authority.size());
  while (address.path.ends_with('/')) address.path.pop_back();
  const bool is_ipv6 = authority.starts_with('[');
  const std::size_t host_end = is_ipv6 ? authority.find(']') : authority.find(':');
  if (is_ipv6 && host_end == std::string_view::npos) refuse("has [ without ]");
  address.host = is_ipv6 ? authority.substr(1, host_end - 1) : authority.substr(0, host_end);
  const std::string_view behind =
      host_end == std::string_view::npos ? std::string_view() : authority.substr(host_end + (is_ipv6 ? 1 : 0));
  if (address.host.empty()) refuse("names no host");
  if (!consists_of(address.host, is_ipv6 ? ":." : k_host_marks)) refuse("has a character that no host's name has");
  if (!consists_of(address.path, k_path_marks)) refuse("has a character that no path has");
  if (!behind.empty() && behind.front() != ':') refuse("has something between the host and the port");
  if (!behind.empty()) read_port(behind.substr(1), address);
  address.host = in_small_letters(address.host);
  return address;
}

}  // namespace mottle::drivers
