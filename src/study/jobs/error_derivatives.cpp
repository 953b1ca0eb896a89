#include "study/jobs/error_derivatives.hpp"

#include <algorithm>

#include "mottle/core/error.hpp"
#include "mottle/updating/methods/deterministic.hpp"

namespace mottle::study {
namespace {

constexpr double k_frequency_noise = 0.001;
constexpr double k_shape_noise = 0.01;

Eigen::Index index_of_output(const std::vector<Quantity>& outputs, const std::string& name) {
  const auto found = std::find_if(outputs.begin(), outputs.end(), [&](const Quantity& o) { return o.name() == name; });
  return std::distance(outputs.begin(), found);
}

/// Noise of frequencies as a fraction of each, of a shape as a fraction of its largest component.
void add_noise(const Eigen::VectorXd& values, ErrorDerivatives& found) {
  found.size = values.cwiseAbs();
  found.noise = Eigen::VectorXd::Zero(values.size());
  for (std::size_t i = 0; i < found.further.size(); ++i) {
    const std::vector<Eigen::Index>& rows = found.rows[i];
    found.size(rows).setConstant(values(rows).cwiseAbs().maxCoeff());
    found.noise(rows) = (found.further[i].is_shape ? k_shape_noise : k_frequency_noise) * found.size(rows);
  }
}

/// Sets changes to zero that are rounding of the output: another oscillator's mode moves by 1e-35 of itself.
///
/// @param steps  size of each column's change
void clear_rounding(const Eigen::VectorXd& values, const Eigen::VectorXd& steps, Eigen::MatrixXd& derivatives) {
  constexpr double k_rounding = 1e-12;
  const Eigen::ArrayXXd sizes = (derivatives * steps.asDiagonal()).cwiseAbs();
  const Eigen::ArrayXXd least = (k_rounding * values.cwiseAbs()).replicate(1, steps.size());
  derivatives = (sizes <= least).select(0.0, derivatives.array());
}

/// The study with the numbers as parameters.
Study widened(const Study& study, const FixedNumbers& numbers, bool has_further, Eigen::Index mode_count) {
  Study whole = with_candidates(study, numbers.list);
  whole.may_reduce = false;  // one point does not pay for the training of a reduced model
  if (has_further) whole.outputs = wider_outputs(study, mode_count);
  return whole;
}

/// Rows of the wider model's outputs: those of the study, then the further ones, which are numbered in `found`.
std::vector<Eigen::Index> order_of_outputs(const StudyModel& made, const std::vector<Quantity>& wider,
                                           ErrorDerivatives& found) {
  std::vector<Eigen::Index> order;
  for (const Quantity& output : made.model->outputs()) order.push_back(index_of_output(wider, output.name()));
  for (const FurtherOutputs& item : found.further) {
    found.rows.emplace_back();
    for (const std::string& name : item.names) {
      const Eigen::Index index = index_of_output(wider, name);
      if (index == static_cast<Eigen::Index>(wider.size())) continue;  // follows from the others where sizes are free
      found.rows.back().push_back(static_cast<Eigen::Index>(order.size()));
      order.push_back(index);
    }
  }
  return order;
}

}  // namespace

ErrorDerivatives differentiate_errors(const Study& study, const StudyModel& made, const FixedNumbers& numbers,
                                      const Eigen::VectorXd& mean, bool has_further, const RunContext& context) {
  const Eigen::Index mode_count = made.model->structure().mode_count();
  const Study whole = widened(study, numbers, has_further, mode_count);
  const StudyModel model = make_model(whole, whole.parameters);
  const Eigen::Index q = mean.size();
  Eigen::VectorXd point = model.space->prior().mean();
  point.head(q) = mean;
  const UpdatingProblem problem{
      .model = *model.model, .derivatives = model.model->derivatives(), .space = *model.space};
  std::int64_t evaluations = 0;
  const Eigen::VectorXd prior_std = model.space->prior().covariance().diagonal().cwiseSqrt();
  const Eigen::MatrixXd jacobian = model_jacobian(problem, point, prior_std, context, evaluations);
  ErrorDerivatives found;
  if (has_further) found.further = further_outputs(study, mode_count);
  const std::vector<Eigen::Index> order = order_of_outputs(made, model.model->outputs(), found);
  const Eigen::Index m = numbers.sizes.size();
  found.parameters = jacobian(order, Eigen::seqN(0, q));
  found.errors = jacobian(order, Eigen::lastN(m)) * numbers.sizes.asDiagonal();
  const Eigen::VectorXd values = problem.model.evaluate(point.transpose(), context).outputs.row(0)(order).transpose();
  require(found.parameters.allFinite() && found.errors.allFinite() && values.allFinite(),
          "the model has no derivatives at the updated mean");
  clear_rounding(values, prior_std.head(q), found.parameters);
  clear_rounding(values, Eigen::VectorXd::Ones(m), found.errors);
  add_noise(values, found);
  return found;
}

}  // namespace mottle::study
