#include "mottle/study/jobs/serve.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/drivers/umbridge/model_server.hpp"
#include "mottle/study/jobs/study_model.hpp"
#include "mottle/study/jobs/study_objects.hpp"

namespace mottle::study {
namespace {

/// The model's derivatives, with central differences of the outputs that have no analytic ones.
Eigen::MatrixXd jacobian_at(const StudyModel& made, const Eigen::VectorXd& x, const RunContext& context) {
  Eigen::MatrixXd jacobian = made.model->derivatives()->jacobian(x);
  if (jacobian.allFinite()) return jacobian;
  const Eigen::VectorXd steps = made.model->difference_step() * made.space->prior().covariance().diagonal().cwiseSqrt();
  Eigen::MatrixXd around(2 * x.size(), x.size());
  for (Eigen::Index p = 0; p < x.size(); ++p) {
    around.row(2 * p) = x.transpose();
    around.row(2 * p + 1) = x.transpose();
    around(2 * p, p) += steps(p);
    around(2 * p + 1, p) -= steps(p);
  }
  const Evaluation found = made.model->evaluate(around, context);
  if (!found.failures.empty()) {
    throw ModelFailure(
        fmt::format("there is no derivative: a run beside the point failed: {}", found.failures[0].reason));
  }
  for (Eigen::Index p = 0; p < x.size(); ++p) {
    const double step = around(2 * p, p) - around(2 * p + 1, p);
    const Eigen::VectorXd difference = (found.outputs.row(2 * p) - found.outputs.row(2 * p + 1)).transpose() / step;
    for (Eigen::Index k = 0; k < jacobian.rows(); ++k) {
      if (!std::isfinite(jacobian(k, p))) jacobian(k, p) = difference(k);
    }
  }
  return jacobian;
}

ServedModel served(const StudyModel& made, const RunContext& context) {
  constexpr Eigen::Index k_runs_together = 64;
  ServedModel model{.inputs = made.space->count(),
                    .outputs = static_cast<Eigen::Index>(made.model->outputs().size()),
                    .evaluate = [&](const Eigen::MatrixXd& samples) { return made.model->evaluate(samples, context); },
                    .fault_of = [&](const Eigen::VectorXd& x) -> std::string {
                      if (made.space->is_possible(x)) return {};
                      return "a stiffness or mass is <= 0 or a damping < 0, which is physically impossible";
                    }};
  if (made.model->derivatives() != nullptr) {
    model.jacobian = [&](const Eigen::VectorXd& x) { return jacobian_at(made, x, context); };
  }
  if (made.program) model.batch = k_runs_together;  // as many at once as the study allows
  return model;
}

}  // namespace

void serve(const Study& study, int port, const RunSettings& settings,
           const std::function<void(const OfferedModel&)>& offered) {
  RunSettings without_results = settings;
  without_results.folder.clear();
  without_results.ends_by_failures = false;  // one client's failures are no other client's
  const StudyModel made = make_model(study, study.parameters, without_results);
  const RunContext context{.seed = study.seed, .threads = settings.threads, .stop = settings.stop};
  const ServedModel model = served(made, context);
  ModelServer server(model, port);
  if (!made.program) {  // whatever is made at the first evaluation is made before a client waits for it
    const Evaluation first = model.evaluate(made.space->prior().mean().transpose());
    if (!first.failures.empty()) {
      throw SystemFailure(
          fmt::format("the model gives nothing at the parameters' means: {}", first.failures[0].reason));
    }
  }
  OfferedModel offer{.address = server.address(), .name = model.name, .inputs = made.space->names()};
  for (const Quantity& output : made.model->outputs()) offer.outputs.push_back(output.name());
  offer.has_derivatives = model.jacobian != nullptr;
  offered(offer);
  server.serve(context);
}

RunSummary summarise(const OfferedModel& offered) {
  RunSummary summary{.status = "offered", .message = offered.address};
  summary.lines = {
      fmt::format("{} offers the model '{}' by UM-Bridge's protocol 1.0; Ctrl-C ends it", offered.address,
                  offered.name),
      fmt::format("input: {}", join(offered.inputs)), fmt::format("output: {}", join(offered.outputs)),
      fmt::format("derivatives: {}", offered.has_derivatives ? "Gradient and ApplyJacobian" : "not offered")};
  summary.json = nlohmann::json{{"command", "propagate"},
                                {"status", summary.status},
                                {"address", offered.address},
                                {"model", offered.name},
                                {"inputs", offered.inputs},
                                {"outputs", offered.outputs},
                                {"derivatives", offered.has_derivatives}}
                     .dump();
  return summary;
}

}  // namespace mottle::study
