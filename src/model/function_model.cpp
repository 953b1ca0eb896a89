#include "mottle/model/function_model.hpp"

#include <cmath>
#include <limits>
#include <new>
#include <set>
#include <string>

#include "mottle/core/error.hpp"
#include "mottle/core/parallel.hpp"

namespace mottle::model {
namespace {

/// Why these are no outputs; empty where they are.
std::string fault_of(const Eigen::VectorXd& values, const std::vector<Quantity>& outputs) {
  if (values.size() != static_cast<Eigen::Index>(outputs.size())) {
    return fmt::format("the function gave {} values for {} outputs", values.size(), outputs.size());
  }
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const double value = values(static_cast<Eigen::Index>(k));
    if (!std::isfinite(value)) return fmt::format("output '{}' is {}", outputs[k].name(), value);
  }
  return {};
}

}  // namespace

FunctionModel::FunctionModel(Eigen::Index parameters, std::vector<Quantity> outputs, Function function)
    : parameters_(parameters), outputs_(std::move(outputs)), function_(std::move(function)) {
  require(parameters_ > 0, "a model needs a parameter; it has {}", parameters_);
  require(!outputs_.empty(), "a model needs an output; it has none");
  require(function_ != nullptr, "a model needs a function; it is empty");
  std::set<std::string> names;
  for (const Quantity& output : outputs_) {
    require(!output.name().empty(), "an output of the model has no name");
    require(names.insert(output.name()).second, "output '{}' is there twice", output.name());
  }
}

Evaluation FunctionModel::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const {
  require(samples.cols() == parameters_, "a model of {} parameters was given {}", parameters_, samples.cols());
  const Eigen::Index count = samples.rows();
  Evaluation result;
  result.outputs = Eigen::MatrixXd::Constant(count, static_cast<Eigen::Index>(outputs_.size()),
                                             std::numeric_limits<double>::quiet_NaN());
  std::vector<std::string> reasons(static_cast<std::size_t>(count));
  parallel_for(count, 1, context.threads, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t s = begin; s < end; ++s) {
      context.throw_if_stopped();
      std::string& reason = reasons[static_cast<std::size_t>(s)];
      try {
        const Eigen::VectorXd values = function_(samples.row(s).transpose());
        reason = fault_of(values, outputs_);
        if (reason.empty()) result.outputs.row(s) = values.transpose();
      } catch (const Stopped&) {
        throw;
      } catch (const std::bad_alloc&) {
        throw;
      } catch (const std::exception& error) {
        reason = *error.what() == '\0' ? "the function failed and gave no reason" : error.what();
      }
    }
  });
  for (Eigen::Index s = 0; s < count; ++s) {
    std::string& reason = reasons[static_cast<std::size_t>(s)];
    if (!reason.empty()) result.failures.push_back({s, std::move(reason)});
  }
  return result;
}

}  // namespace mottle::model
