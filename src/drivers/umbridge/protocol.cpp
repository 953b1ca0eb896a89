#include "drivers/umbridge/protocol.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "drivers/umbridge/json_body.hpp"
#include "mottle/core/utf8.hpp"

namespace mottle::drivers {
namespace {

using Json = nlohmann::json;

constexpr std::size_t k_longest_quote = 120;
constexpr std::size_t k_longest_message = 400;

std::string excerpt(std::string_view body) {
  return fmt::format("'{}'", shortened(printable(body.substr(0, 4 * k_longest_quote)), k_longest_quote));
}

template <typename... Arguments>
void expect(bool claim, fmt::format_string<Arguments...> message, Arguments&&... arguments) {
  if (!claim) throw AnswerFault(fmt::format(message, std::forward<Arguments>(arguments)...));
}

/// "InvalidInput: what the server says"; nothing: it is no error object.
std::string error_text(const Json& answer) {
  const auto error = answer.find("error");
  if (error == answer.end()) return {};
  if (!error->is_object()) return shortened(printable(error->dump(-1, ' ', true)), k_longest_message);
  const auto part = [&](const char* key) {
    const auto found = error->find(key);
    return found != error->end() && found->is_string() ? found->get<std::string>() : std::string("?");
  };
  return shortened(printable(fmt::format("{}: {}", part("type"), part("message"))), k_longest_message);
}

/// The answer's object, once it is known to be one and to tell no error.
Json object_of(int status, std::string_view body) {
  const std::optional<Json> answer = parse_body(body);
  const bool is_object = answer && answer->is_object();
  if (is_object) {
    const std::string error = error_text(*answer);
    expect(error.empty(), "HTTP {}: {}", status, error);
  }
  expect(status < 300 || status > 399, "HTTP {}: the server refers to another address; give that one in model.urls",
         status);
  expect(status == 200, "HTTP {}: {}", status, excerpt(body));
  expect(answer.has_value(), "the answer is not JSON (which has no nan): {}", excerpt(body));
  expect(is_object, "the answer is not an object: {}", excerpt(body));
  return *answer;
}

const Json& list_in(const Json& object, const std::string& key) {
  const auto found = object.find(key);
  expect(found != object.end() && found->is_array(), "the answer has no list '{}'", key);
  return *found;
}

std::vector<double> numbers_of(const Json& list, std::size_t size, const std::string& what) {
  expect(list.is_array(), "{} is not a list of numbers", what);
  expect(list.size() == size, "{} has {} numbers, {} were promised", what, list.size(), size);
  std::vector<double> numbers;
  numbers.reserve(size);
  for (std::size_t i = 0; i < size; ++i) {
    expect(list[i].is_number(), "{}[{}] is {}, which is not a number", what, i, excerpt(list[i].dump(-1, ' ', true)));
    numbers.push_back(list[i].get<double>());
    expect(std::isfinite(numbers.back()), "{}[{}] is not finite", what, i);
  }
  return numbers;
}

Json head_of(const ModelName& model) {
  return {{"name", model.name}, {"config", Json::parse(model.config)}};
}

Json derivative_head(const ModelName& model, const Vectors& input, std::size_t out, std::size_t in) {
  Json request = head_of(model);
  request["input"] = input;
  request["outWrt"] = out;
  request["inWrt"] = in;
  return request;
}

}  // namespace

std::string model_request(const ModelName& model) {
  return head_of(model).dump();
}

std::string evaluate_request(const ModelName& model, const Vectors& input) {
  Json request = head_of(model);
  request["input"] = input;
  return request.dump();
}

std::string gradient_request(const ModelName& model, const Vectors& input, std::size_t out, std::size_t in,
                             const std::vector<double>& sens) {
  Json request = derivative_head(model, input, out, in);
  request["sens"] = sens;
  return request.dump();
}

std::string jacobian_request(const ModelName& model, const Vectors& input, std::size_t out, std::size_t in,
                             const std::vector<double>& vec) {
  Json request = derivative_head(model, input, out, in);
  request["vec"] = vec;
  return request.dump();
}

bool tells_error(std::string_view body) {
  const std::optional<Json> answer = parse_body(body);
  if (!answer || !answer->is_object()) return false;
  const auto error = answer->find("error");
  return error != answer->end() && error->is_object();
}

ServerInfo read_info(int status, std::string_view body) {
  const Json answer = object_of(status, body);
  ServerInfo info;
  const auto version = answer.find("protocolVersion");
  expect(version != answer.end() && version->is_number(), "the answer has no number 'protocolVersion'");
  info.protocol_version = version->get<double>();
  if (info.protocol_version != 1.0) return info;  // other versions list no models
  for (const Json& model : list_in(answer, "models")) {
    expect(model.is_string(), "a model's name is not a text");
    info.models.push_back(model.get<std::string>());
  }
  return info;
}

SupportedFeatures read_features(int status, std::string_view body) {
  const Json answer = object_of(status, body);
  const auto support = answer.find("support");
  expect(support != answer.end() && support->is_object(), "the answer has no object 'support'");
  const auto has = [&](const char* feature) {
    const auto found = support->find(feature);
    return found != support->end() && found->is_boolean() && found->get<bool>();
  };
  return {.evaluate = has("Evaluate"), .gradient = has("Gradient"), .apply_jacobian = has("ApplyJacobian")};
}

std::vector<std::size_t> read_sizes(int status, std::string_view body, const std::string& key) {
  constexpr std::size_t k_most = 1'000'000;
  const Json answer = object_of(status, body);
  std::vector<std::size_t> sizes;
  std::size_t sum = 0;
  for (const Json& size : list_in(answer, key)) {
    const bool is_size = size.is_number_unsigned() && size.get<std::uint64_t>() <= k_most;
    expect(is_size, "{} has {}, which is not a size up to {}", key, excerpt(size.dump(-1, ' ', true)), k_most);
    sizes.push_back(size.get<std::size_t>());
    sum += sizes.back();
    expect(sum <= k_most, "{} are more than {} numbers together", key, k_most);
  }
  return sizes;
}

Vectors read_output(int status, std::string_view body, const std::vector<std::size_t>& sizes) {
  const Json answer = object_of(status, body);
  const Json& list = list_in(answer, "output");
  expect(list.size() == sizes.size(), "output has {} vectors, {} were promised", list.size(), sizes.size());
  Vectors vectors;
  for (std::size_t v = 0; v < sizes.size(); ++v) {
    vectors.push_back(numbers_of(list[v], sizes[v], fmt::format("output[{}]", v)));
  }
  return vectors;
}

std::vector<double> read_vector(int status, std::string_view body, std::size_t size) {
  const Json answer = object_of(status, body);
  return numbers_of(list_in(answer, "output"), size, "output");
}

}  // namespace mottle::drivers
