// Answers of UM-Bridge servers, right and wrong; requests as the protocol's documentation shows them.
#include "drivers/umbridge/protocol.hpp"

#include <gmock/gmock.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "mottle/drivers/umbridge/http_address.hpp"

namespace {

using mottle::InvalidInput;
using mottle::drivers::AnswerFault;
using mottle::drivers::parse_http_address;
using mottle::drivers::read_features;
using mottle::drivers::read_info;
using mottle::drivers::read_output;
using mottle::drivers::read_sizes;
using mottle::drivers::read_vector;
using mottle::drivers::Vectors;
using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

auto says(const char* text) {
  return ThrowsMessage<AnswerFault>(HasSubstr(text));
}

TEST(UmbridgeProtocol, RequestsHaveTheKeysOfTheProtocol) {
  const mottle::drivers::ModelName model{.name = "forward", .config = R"({"level": 2})"};
  EXPECT_EQ(json::parse(model_request(model)), json::parse(R"({"name": "forward", "config": {"level": 2}})"));
  EXPECT_EQ(json::parse(evaluate_request(model, {{0.1}, {2.0, 3.0}}))["input"], json::parse("[[0.1], [2.0, 3.0]]"));
  const json gradient = json::parse(gradient_request(model, {{0.1}}, 3, 2, {1.0}));
  EXPECT_EQ(gradient["outWrt"], 3);
  EXPECT_EQ(gradient["inWrt"], 2);
  EXPECT_EQ(gradient["sens"], json::parse("[1.0]"));
  EXPECT_EQ(json::parse(jacobian_request(model, {{0.1}}, 0, 0, {7.0}))["vec"], json::parse("[7.0]"));
}

TEST(UmbridgeProtocol, NumbersArriveAsTheyWereSent) {
  const double value = 0.1 + 0.2;  // which has no short text
  const json request =
      json::parse(mottle::drivers::evaluate_request({.name = "f"}, {{value, 5e-324, 1.7976931348623157e308}}));
  EXPECT_EQ(request["input"][0][0].get<double>(), value);
  EXPECT_EQ(request["input"][0][1].get<double>(), 5e-324);
  EXPECT_EQ(request["input"][0][2].get<double>(), 1.7976931348623157e308);
}

TEST(UmbridgeProtocol, ReadsWhatServersAnswer) {
  EXPECT_THAT(read_info(200, R"({"protocolVersion": 1.0, "models": ["a", "b"]})").models, ElementsAre("a", "b"));
  EXPECT_EQ(read_info(200, R"({"protocolVersion": 0.9, "support": {}})").protocol_version, 0.9);
  EXPECT_TRUE(read_features(200, R"({"support": {"Evaluate": true, "Gradient": false}})").evaluate);
  EXPECT_FALSE(read_features(200, R"({"support": {"Evaluate": true, "Gradient": false}})").gradient);
  EXPECT_THAT(read_sizes(200, R"({"inputSizes": [2, 0, 1]})", "inputSizes"), ElementsAre(2U, 0U, 1U));
  EXPECT_EQ(read_output(200, R"({"output": [[1, 2.5], [-3e4]] })", {2, 1}), (Vectors{{1.0, 2.5}, {-3e4}}));
  EXPECT_THAT(read_vector(200, R"({"output": [4.0]})", 1), ElementsAre(4.0));
}

TEST(UmbridgeProtocol, AnErrorObjectIsToldWhateverTheStatus) {
  const char* body = R"({"error": {"type": "InvalidOutput", "message": "diverged"}})";
  EXPECT_THAT([&] { read_output(500, body, {1}); }, says("HTTP 500: InvalidOutput: diverged"));
  EXPECT_THAT([&] { read_output(200, body, {1}); }, says("HTTP 200: InvalidOutput: diverged"));
  EXPECT_THAT([] { read_output(400, R"({"error": "x"})", {1}); }, says("HTTP 400: \"x\""));
  EXPECT_THAT([] { read_output(400, R"({"error": {"type": 1}})", {1}); }, says("HTTP 400: ?: ?"));
}

TEST(UmbridgeProtocol, RefusesWhatIsNoAnswer) {
  EXPECT_THAT([] { read_output(200, "", {1}); }, says("not JSON"));
  EXPECT_THAT([] { read_output(200, R"({"output": [[NaN]]})", {1}); },
              says("not JSON (which has no nan): '{\"output\""));
  EXPECT_THAT([] { read_output(200, R"({"output": [[1e999]]})", {1}); }, says("not JSON"));
  EXPECT_THAT([] { read_output(200, R"({"output": [[null]]})", {1}); }, says("output[0][0] is 'null'"));
  EXPECT_THAT([] { read_output(200, R"({"output": [[true]]})", {1}); }, says("output[0][0] is 'true'"));
  EXPECT_THAT([] { read_output(200, R"({"output": [[1]]})", {2}); }, says("output[0] has 1 numbers, 2 were promised"));
  EXPECT_THAT([] { read_output(200, R"({"output": [[1], [1]]})", {1}); },
              says("output has 2 vectors, 1 were promised"));
  EXPECT_THAT([] { read_output(200, R"({"output": [1]})", {1}); }, says("output[0] is not a list of numbers"));
  EXPECT_THAT([] { read_output(200, R"({"output": 1})", {1}); }, says("no list 'output'"));
  EXPECT_THAT([] { read_output(200, "[1]", {1}); }, says("not an object"));
  EXPECT_THAT([] { read_output(302, "<html>", {1}); }, says("HTTP 302: the server refers to another address"));
  EXPECT_THAT([] { read_info(200, R"({"models": []})"); }, says("no number 'protocolVersion'"));
  EXPECT_THAT([] { read_info(200, R"({"protocolVersion": 1, "models": [1]})"); }, says("name is not a text"));
  EXPECT_THAT([] { read_features(200, R"({"support": []})"); }, says("no object 'support'"));
  EXPECT_THAT([] { read_sizes(200, R"({"s": [1.5]})", "s"); }, says("s has '1.5', which is not a size"));
  EXPECT_THAT([] { read_sizes(200, R"({"s": [-1]})", "s"); }, says("s has '-1'"));
  EXPECT_THAT([] { read_sizes(200, R"({"s": [18446744073709551615]})", "s"); }, says("not a size up to"));
  EXPECT_THAT([] { read_sizes(200, R"({"s": [600000, 600000]})", "s"); }, says("more than 1000000 numbers together"));
}

TEST(UmbridgeProtocol, NestingWithoutEndIsRefused) {
  EXPECT_THAT([] { read_output(200, std::string(10'000'000, '['), {1}); }, says("not JSON"));
}

TEST(UmbridgeProtocol, AForeignMessageIsShortAndPlain) {
  const std::string body = json{{"error", {{"type", "T"}, {"message", "\x1b[31m" + std::string(10000, 'x')}}}}.dump();
  try {
    read_output(500, body, {1});
    FAIL();
  } catch (const AnswerFault& fault) {
    EXPECT_LT(std::string(fault.what()).size(), 500U);
    EXPECT_EQ(std::string(fault.what()).find('\x1b'), std::string::npos);
  }
}

TEST(HttpAddress, ReadsHostPortAndPath) {
  EXPECT_EQ(parse_http_address("http://localhost:4242").text(), "http://localhost:4242");
  EXPECT_EQ(parse_http_address("http://a.b-c").port, "80");
  EXPECT_EQ(parse_http_address("http://a:080/models/").text(), "http://a:80/models");
  const auto six = parse_http_address("http://[::1]:42");
  EXPECT_EQ(six.host, "::1");
  EXPECT_EQ(six.authority(), "[::1]:42");
}

TEST(HttpAddress, RefusesWhatIsNone) {
  for (const char* text :
       {"", "localhost:4242", "https://a", "http://", "http://:80", "http://a:", "http://a:0", "http://a:65536",
        "http://a:-1", "http://a:8x", "http://u:p@a", "http://a b", "http://a/?q=1", "http://a/#f", "http://[::1",
        "http://[::1]x", "http://[]:1", "http://a\r\nX: y", "http://a/\x01"}) {
    EXPECT_THROW(parse_http_address(text), InvalidInput) << text;
  }
}

}  // namespace
