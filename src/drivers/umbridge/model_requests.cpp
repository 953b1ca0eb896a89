#include "drivers/umbridge/model_requests.hpp"

#include <map>
#include <nlohmann/json.hpp>

#include "drivers/umbridge/json_body.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/utf8.hpp"

namespace mottle::drivers {
namespace {

using Json = nlohmann::json;

/// A fault of the request, as its client is told.
class RequestFault : public Error {
 public:
  RequestFault(const std::string& type, const std::string& message) : Error(message), type_(type) {}
  const std::string& type() const { return type_; }

 private:
  std::string type_;
};

template <typename... Arguments>
void expect(bool claim, fmt::format_string<Arguments...> message, Arguments&&... arguments) {
  if (!claim) throw RequestFault("InvalidInput", fmt::format(message, std::forward<Arguments>(arguments)...));
}

std::string foreign(const std::string& text) {
  constexpr std::size_t k_longest = 100;
  return shortened(printable(text), k_longest);
}

Eigen::VectorXd numbers_of(const Json& list, Eigen::Index size, const char* what) {
  expect(list.is_array(), "{} is not a list of numbers", what);
  expect(list.size() == static_cast<std::size_t>(size), "{} has {} numbers, {} are needed", what, list.size(), size);
  Eigen::VectorXd numbers(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const Json& entry = list[static_cast<std::size_t>(i)];
    expect(entry.is_number(), "{}[{}] is not a number", what, i);
    numbers(i) = entry.get<double>();
  }
  expect(numbers.allFinite(), "{} is not finite", what);
  return numbers;
}

const Json& need(const Json& request, const char* key) {
  const auto found = request.find(key);
  expect(found != request.end(), "'{}' is missing", key);
  return *found;
}

Eigen::VectorXd read_input(const ServedModel& model, const Json& request) {
  const Json& input = need(request, "input");
  expect(input.is_array() && input.size() == 1, "input is to be a list of one vector: [[...]]");
  Eigen::VectorXd x = numbers_of(input[0], model.inputs, "input[0]");
  const std::string fault = model.fault_of ? model.fault_of(x) : "";
  expect(fault.empty(), "{}", fault);
  return x;
}

void require_first(const Json& request, const char* key) {
  expect(need(request, key) == 0, "{} is to be 0: there is one input vector and one output vector", key);
}

Json object_of(std::string_view body) {
  const std::optional<Json> request = parse_body(body);
  expect(request && request->is_object(), "the request is not a JSON object (JSON has no nan)");
  return *request;
}

void require_name(const ServedModel& model, const Json& request) {
  const auto name = request.find("name");
  if (name != request.end() && *name == model.name) return;
  const bool is_text = name != request.end() && name->is_string();
  throw RequestFault("ModelNotFound", fmt::format("there is no model '{}'; there is '{}'",
                                                  is_text ? foreign(name->get<std::string>()) : "", model.name));
}

Json support_of(const ServedModel& model) {
  const bool has_derivatives = model.jacobian != nullptr;
  return {
      {"Evaluate", true}, {"Gradient", has_derivatives}, {"ApplyJacobian", has_derivatives}, {"ApplyHessian", false}};
}

Computation read_computation(const ServedModel& model, std::string_view path, const Json& request) {
  if (path == "/Evaluate") return {.x = read_input(model, request)};
  if (path == "/ApplyHessian" || !model.jacobian) {
    throw RequestFault("UnsupportedFeature", fmt::format("{} is not offered for this model", path));
  }
  const bool is_gradient = path == "/Gradient";
  require_first(request, "outWrt");
  require_first(request, "inWrt");
  Computation computation{.kind = is_gradient ? Computation::Kind::gradient : Computation::Kind::apply_jacobian,
                          .x = read_input(model, request)};
  const char* key = is_gradient ? "sens" : "vec";
  computation.vector = numbers_of(need(request, key), is_gradient ? model.outputs : model.inputs, key);
  return computation;
}

std::string output_body(const Json& output) {
  return Json{{"output", output}}.dump();
}

std::vector<double> list_of(const Eigen::Ref<const Eigen::VectorXd>& values) {
  return {values.data(), values.data() + values.size()};
}

ReadRequest answered(const Json& answer) {
  return {.answer = ServerAnswer{.body = answer.dump()}};
}

}  // namespace

ServerAnswer error_answer(int status, const std::string& type, const std::string& message) {
  const Json error = {{"type", type}, {"message", printable(message)}};
  return {.status = status, .body = Json{{"error", error}}.dump()};
}

ReadRequest read_request(const ServedModel& model, bool is_post, std::string_view path, std::string_view body) {
  if (path == "/Info") return answered({{"protocolVersion", 1.0}, {"models", {model.name}}});
  const bool is_known = path == "/ModelInfo" || path == "/InputSizes" || path == "/OutputSizes" ||
                        path == "/Evaluate" || path == "/Gradient" || path == "/ApplyJacobian" ||
                        path == "/ApplyHessian";
  if (!is_known) {
    return {.answer =
                error_answer(404, "InvalidInput", fmt::format("there is nothing at {}", foreign(std::string(path))))};
  }
  if (!is_post) return {.answer = error_answer(405, "InvalidInput", fmt::format("{} is to be posted", path))};
  try {
    const Json request = object_of(body);
    require_name(model, request);
    if (path == "/ModelInfo") return answered({{"support", support_of(model)}});
    if (path == "/InputSizes") return answered({{"inputSizes", {model.inputs}}});
    if (path == "/OutputSizes") return answered({{"outputSizes", {model.outputs}}});
    return {.computation = read_computation(model, path, request)};
  } catch (const RequestFault& fault) {
    return {.answer = error_answer(400, fault.type(), fault.what())};
  }
}

ServerAnswer outputs_answer(const Eigen::Ref<const Eigen::RowVectorXd>& outputs, const std::string& failure) {
  if (!failure.empty()) return error_answer(500, "InvalidOutput", failure);
  if (!outputs.allFinite()) return error_answer(500, "InvalidOutput", "an output is not a number there");
  return {.body = output_body(Json::array({list_of(outputs.transpose())}))};
}

ServerAnswer derivative_answer(const Computation& computation, const Eigen::MatrixXd& jacobian) {
  const bool is_gradient = computation.kind == Computation::Kind::gradient;
  const Eigen::VectorXd product = is_gradient ? Eigen::VectorXd(jacobian.transpose() * computation.vector)
                                              : Eigen::VectorXd(jacobian * computation.vector);
  if (!product.allFinite())
    return error_answer(500, "InvalidOutput", "a derivative does not exist or is not finite there");
  return {.body = output_body(list_of(product))};
}

}  // namespace mottle::drivers
