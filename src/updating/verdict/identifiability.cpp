// What the outputs can tell of the parameters, and which combinations they do not see.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/surrogates/regression.hpp"
#include "mottle/stats/tests/hotelling.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "mottle/updating/verdict/verdict.hpp"

namespace mottle::updating {

Identifiability identify(const Eigen::Ref<const Eigen::MatrixXd>& sensitivity,
                         const Eigen::Ref<const Eigen::VectorXd>& output_scale,
                         const Eigen::Ref<const Eigen::VectorXd>& parameter_scale) {
  constexpr double k_unseen = 1e-6;
  const Eigen::MatrixXd scaled = output_scale.cwiseInverse().asDiagonal() * sensitivity * parameter_scale.asDiagonal();
  const SingularValues svd(scaled, Eigen::ComputeFullV);
  Identifiability result;
  result.singular_values = svd.values();
  const double threshold = k_unseen * result.singular_values(0);
  for (Eigen::Index i = 0; i < scaled.cols(); ++i) {
    if (i < result.singular_values.size() && result.singular_values(i) > threshold) {
      ++result.rank;
    } else {
      result.unseen_directions.push_back(svd.right().col(i));
    }
  }
  return result;
}

namespace {

/// Sensitivity by linear regression; nothing where the samples are too few or do not span all parameters.
std::optional<Eigen::MatrixXd> regressed_sensitivity(const Cloud& cloud) {
  const Cloud::Valid valid = cloud.valid();
  if (valid.samples.rows() <= valid.samples.cols() + 1) return std::nullopt;
  try {
    return linear_regression(valid.samples, valid.outputs).sensitivity;
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
}

/// The model's derivatives at the estimate; nothing where it has none there.
std::optional<Eigen::MatrixXd> exact_sensitivity(const UpdatingProblem& problem, const Eigen::VectorXd& mean) {
  if (problem.derivatives == nullptr) return std::nullopt;
  try {
    Eigen::MatrixXd jacobian = problem.derivatives->jacobian(mean);
    if (jacobian.allFinite()) return jacobian;
  } catch (const InvalidInput&) {  // a mode is lost there
  } catch (const SystemFailure&) {
  }
  return std::nullopt;
}

}  // namespace

std::optional<Identifiability> identify(const UpdatingProblem& problem, const UpdatingResult& result) {
  Eigen::MatrixXd sensitivity = result.sensitivity;
  const bool is_regressed = sensitivity.size() == 0;
  if (is_regressed) {
    // A population without scatter in some direction has a cloud that lies in a plane: the first one does not.
    const auto last = regressed_sensitivity(result.history.back().cloud);
    const auto found = last ? last : regressed_sensitivity(result.history.front().cloud);
    if (!found) return std::nullopt;
    sensitivity = *found;
  }
  if (!sensitivity.allFinite()) return std::nullopt;
  const TestMoments tests = test_moments(problem.tests);
  const Eigen::VectorXd standard_deviation = tests.covariance.diagonal().cwiseSqrt();
  const bool has_scatter = (standard_deviation.array() > 0.0).all();
  const Eigen::VectorXd output_scale = has_scatter ? standard_deviation : Eigen::VectorXd(tests.mean.cwiseAbs());
  const Eigen::VectorXd parameter_scale = problem.space.prior().covariance().diagonal().cwiseSqrt();
  const Identifiability found = identify(sensitivity, output_scale, parameter_scale);
  if (!is_regressed) return found;
  // Curved outputs correlate by chance with a parameter that they do not depend on: a regression does not show it.
  const auto exact = exact_sensitivity(problem, result.mean);
  if (!exact) return found;
  const Identifiability at_mean = identify(*exact, output_scale, parameter_scale);
  return at_mean.rank < found.rank ? at_mean : found;
}

std::string unseen_text(const Eigen::Ref<const Eigen::VectorXd>& direction, const std::vector<std::string>& names) {
  constexpr double k_alone = 0.95;
  constexpr double k_takes_part = 0.1;
  std::vector<Eigen::Index> parts;
  for (Eigen::Index i = 0; i < direction.size(); ++i) {
    if (std::abs(direction(i)) >= k_takes_part) parts.push_back(i);
  }
  const auto name = [&](Eigen::Index i) { return names[static_cast<std::size_t>(i)]; };
  Eigen::Index largest = 0;
  if (direction.cwiseAbs().maxCoeff(&largest) >= k_alone) {
    return fmt::format("{} cannot be identified from the outputs", name(largest));
  }
  if (parts.size() == 2) {
    const Eigen::Index first = parts[0];
    const Eigen::Index second = parts[1];
    const double ratio = -direction(first) / direction(second);
    return fmt::format("{} and {} can only be identified together: {} {} {:.2g} {}, in prior standard deviations",
                       name(first), name(second), name(first), ratio < 0.0 ? '-' : '+', std::abs(ratio), name(second));
  }
  return fmt::format("the outputs do not determine {}, in prior standard deviations", direction_text(direction, names));
}

std::string direction_text(const Eigen::Ref<const Eigen::VectorXd>& direction, const std::vector<std::string>& names) {
  constexpr double k_small = 0.1;
  constexpr std::size_t k_max = 6;
  std::vector<Eigen::Index> order;
  for (Eigen::Index i = 0; i < direction.size(); ++i) {
    if (std::abs(direction(i)) >= k_small) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return std::abs(direction(a)) > std::abs(direction(b)); });
  std::string text;
  for (std::size_t k = 0; k < std::min(order.size(), k_max); ++k) {
    const double weight = direction(order[k]);
    const char* sign = weight < 0.0 ? (k == 0 ? "-" : " - ") : (k == 0 ? "" : " + ");
    text += fmt::format("{}{:.2f} {}", sign, std::abs(weight), names[static_cast<std::size_t>(order[k])]);
  }
  return order.size() > k_max ? text + " + ..." : text;
}

int automatic_samples(int specimens, int outputs, double alpha) {
  constexpr double k_near_limit = 0.01;
  constexpr int k_per_specimen = 100;
  return std::max(sufficient_samples(specimens, outputs, alpha, k_near_limit), k_per_specimen * specimens);
}

}  // namespace mottle::updating
