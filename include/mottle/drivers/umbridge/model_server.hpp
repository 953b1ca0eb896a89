// Offers a function of a vector as an UM-Bridge model (protocol 1.0) on this machine's loopback address.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "mottle/core/run_context.hpp"
#include "mottle/layers.hpp"
#include "mottle/model/model.hpp"

namespace mottle::drivers {

/// y = f(x): one input vector, one output vector. The functions are called by one thread at a time.
struct ServedModel {
  std::string name = "forward";
  Eigen::Index inputs = 0;
  Eigen::Index outputs = 0;
  /// f of every row [sample x input].
  std::function<Evaluation(const Eigen::MatrixXd& samples)> evaluate;
  /// dy/dx [output x input]; empty: derivatives are not offered.
  std::function<Eigen::MatrixXd(const Eigen::VectorXd& x)> jacobian = {};
  /// Why there can be no model at `x`; empty: there can. Without it every finite x is allowed.
  std::function<std::string(const Eigen::VectorXd& x)> fault_of = {};
  /// Requests for evaluations that wait are evaluated together, up to so many. More than 1 only where a row's outputs
  /// depend on that row alone.
  Eigen::Index batch = 1;
};

/// What is served, and until when.
class ModelServer {
 public:
  /// Listens at 127.0.0.1.
  ///
  /// @param port  0: one that is free
  /// @throws InvalidInput   the port is in use or not allowed
  /// @throws SystemFailure  no socket can be had
  ModelServer(ServedModel model, int port);
  ~ModelServer();
  ModelServer(const ModelServer&) = delete;
  ModelServer& operator=(const ModelServer&) = delete;

  /// "http://127.0.0.1:4242".
  std::string address() const;

  /// Answers requests until the context's stop request, and returns then. Faults of a request, and errors that a
  /// function of the model throws, are told to the client; other exceptions end it and are thrown.
  void serve(const RunContext& context);

  class Implementation;  // of which the sessions of clients know

 private:
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace mottle::drivers
