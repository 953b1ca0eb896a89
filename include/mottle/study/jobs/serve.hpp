// The job that offers a study's model to other programs by UM-Bridge's protocol.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/run.hpp"

namespace mottle::study {

/// What is offered, and where.
struct OfferedModel {
  std::string address;                    ///< "http://127.0.0.1:4242"
  std::string name;                       ///< of the model for its clients
  std::vector<std::string> inputs = {};   ///< the parameters, in their order
  std::vector<std::string> outputs = {};  ///< the model's outputs, in their order
  bool has_derivatives = false;
};

/// Offers the study's model at a port of this machine's loopback address until a stop is requested. Nothing is written;
/// tests are not read.
///
/// @param port     0: one that is free
/// @param offered  called once requests are answered
/// @throws InvalidInput   as for propagate(); the port is in use
/// @throws SystemFailure  the model gives nothing at the parameters' means
void serve(const Study& study, int port, const RunSettings& settings,
           const std::function<void(const OfferedModel&)>& offered);

/// In words, and as JSON.
RunSummary summarise(const OfferedModel& offered);

}  // namespace mottle::study
