// UM-Bridge's protocol 1.0 as a client speaks it: plain data <-> JSON. Whatever a server answers is either what the
// protocol says or an AnswerFault.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

/// An answer that is not what the protocol says, or that says what failed; what() is one line.
class AnswerFault : public Error {
 public:
  using Error::Error;
};

using Vectors = std::vector<std::vector<double>>;

struct ServerInfo {
  double protocol_version = 0.0;
  std::vector<std::string> models = {};
};

struct SupportedFeatures {
  bool evaluate = false;
  bool gradient = false;
  bool apply_jacobian = false;

  bool operator==(const SupportedFeatures&) const = default;
};

/// What all requests of one model have in common.
struct ModelName {
  std::string name;
  std::string config = "{}";  ///< a JSON object
};

/// Of /ModelInfo, /InputSizes, /OutputSizes.
std::string model_request(const ModelName& model);
/// Of /Evaluate.
std::string evaluate_request(const ModelName& model, const Vectors& input);
/// Of /Gradient: d(sens . output[out]) / d input[in].
std::string gradient_request(const ModelName& model, const Vectors& input, std::size_t out, std::size_t in,
                             const std::vector<double>& sens);
/// Of /ApplyJacobian: d output[out] / d input[in] times vec.
std::string jacobian_request(const ModelName& model, const Vectors& input, std::size_t out, std::size_t in,
                             const std::vector<double>& vec);

/// Whether an answer says by the protocol's error object what failed: then the server is sound.
bool tells_error(std::string_view body);

/// Answers by their HTTP status and body. Each throws AnswerFault.
ServerInfo read_info(int status, std::string_view body);
SupportedFeatures read_features(int status, std::string_view body);
/// @param key  "inputSizes" or "outputSizes"; at most 1,000,000 numbers together
std::vector<std::size_t> read_sizes(int status, std::string_view body, const std::string& key);
/// Vectors of these sizes, all numbers finite.
Vectors read_output(int status, std::string_view body, const std::vector<std::size_t>& sizes);
/// One vector of that size, all numbers finite.
std::vector<double> read_vector(int status, std::string_view body, std::size_t size);

}  // namespace mottle::drivers
