// The requests of UM-Bridge's protocol 1.0 as a server reads them, and its answers.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>

#include "mottle/drivers/umbridge/model_server.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

struct ServerAnswer {
  int status = 200;
  std::string body = {};  ///< JSON
};

/// {"error": {"type": ..., "message": ...}}.
ServerAnswer error_answer(int status, const std::string& type, const std::string& message);

/// What a request wants computed.
struct Computation {
  enum class Kind { evaluate, gradient, apply_jacobian };
  Kind kind = Kind::evaluate;
  Eigen::VectorXd x = {};
  Eigen::VectorXd vector = {};  ///< sens of a gradient [output], vec of a Jacobian [input]
};

/// Either an answer or what must be computed for it.
struct ReadRequest {
  std::optional<ServerAnswer> answer = std::nullopt;
  Computation computation = {};
};

/// @param is_post  else the path is got
/// @param path     "/Evaluate"
ReadRequest read_request(const ServedModel& model, bool is_post, std::string_view path, std::string_view body);

/// Of /Evaluate; `failure` says why there are none.
ServerAnswer outputs_answer(const Eigen::Ref<const Eigen::RowVectorXd>& outputs, const std::string& failure);
/// Of /Gradient and /ApplyJacobian.
ServerAnswer derivative_answer(const Computation& computation, const Eigen::MatrixXd& jacobian);

}  // namespace mottle::drivers
