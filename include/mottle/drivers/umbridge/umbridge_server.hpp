// Description of a model behind UM-Bridge servers, as plain data.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/drivers/command/extraction.hpp"
#include "mottle/drivers/umbridge/http_address.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/model.hpp"

namespace mottle::drivers {

/// A part of a description that does not fit the servers' model; what() is "KEY: FAULT".
class UmbridgeFault final : public InvalidInput {
 public:
  /// @param key  of UmbridgeServer, as a study names it: "urls", "name", "inputs", "output"
  UmbridgeFault(const std::string& key, const std::string& fault)
      : InvalidInput(key + ": " + fault), key_(key), fault_(fault) {}

  const std::string& key() const { return key_; }
  const std::string& fault() const { return fault_; }

 private:
  std::string key_;
  std::string fault_;
};

/// Throws UmbridgeFault with the formatted fault unless `claim` holds.
template <typename... Arguments>
void require_fit(bool claim, const std::string& key, fmt::format_string<Arguments...> fault, Arguments&&... arguments) {
  if (!claim) throw UmbridgeFault(key, fmt::format(fault, std::forward<Arguments>(arguments)...));
}

/// One number of an input vector: a parameter by its name, or a constant.
struct InputEntry {
  std::string parameter = {};  ///< empty: the constant
  double constant = 0.0;
};

struct UmbridgeServer {
  std::vector<HttpAddress> urls = {};  ///< servers of the same model
  std::string name = {};               ///< of the model; empty: the only one that the servers have
  std::string config = "{}";           ///< JSON that goes with every request
  /// The input vectors; empty: the parameters in their order, over the vectors that the model has.
  std::vector<std::vector<InputEntry>> inputs = {};
  std::optional<int> output = std::nullopt;  ///< output vector of the modes, from 0; nothing: all, one behind the other
  FrequencyRule::Quantity quantity = FrequencyRule::Quantity::hertz;
  bool uses_derivatives = true;  ///< where the servers offer them; else differences are taken
  std::chrono::milliseconds timeout = std::chrono::hours(24);
  int retries = 1;                    ///< of a request that failed, at another server where there is one
  int parallel = 0;                   ///< requests at once over all servers; 0: one for each
  double max_failed_fraction = 0.25;  ///< of 20 evaluations or more; above it all stops
  double difference_step = k_coarse_difference_step;  ///< in prior standard deviations
};

}  // namespace mottle::drivers
