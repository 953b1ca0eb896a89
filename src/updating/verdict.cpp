#include "mottle/updating/verdict.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/stats/hotelling.hpp"
#include "mottle/stats/regression.hpp"
#include "mottle/updating/iteration.hpp"

namespace mottle {

VerdictTest mean_agreement_test(const UpdatingProblem& problem, const IterationRecord& state, double level) {
  const TestMoments tests = test_moments(problem.tests);
  const auto specimens = static_cast<int>(problem.tests.values.rows());
  const auto samples = static_cast<int>(state.cloud.valid().outputs.rows());
  // Tests scatter by their noise too; where no parameter scatters the outputs, by nothing else.
  Eigen::MatrixXd covariance = state.output_covariance;
  covariance.diagonal() += problem.tests.repeatability_std.cwiseAbs2();
  const TwoSampleTest hotelling =
      hotelling_two_sample(tests.mean, tests.covariance, specimens, state.output_mean, covariance, samples, level);
  return {.name = "mean-agreement",
          .statistic = hotelling.t_squared,
          .critical = hotelling.critical_t_squared,
          .p_value = hotelling.p_value,
          .passed = !hotelling.rejects,
          .meaning = fmt::format("Hotelling's two-sample T^2: do the {} tests and the {} samples of the updated model "
                                 "have the same mean outputs?",
                                 specimens, samples)};
}

std::string conclusion_text(Conclusion conclusion) {
  switch (conclusion) {
    case Conclusion::adequate:
      return "adequate";
    case Conclusion::inadequate:
      return "inadequate";
    default:
      return "undecided";
  }
}

Verdict judge(const UpdatingProblem& problem, const UpdatingResult& result) {
  Verdict verdict;
  verdict.level = problem.level;
  verdict.tests = result.tests;
  verdict.not_tested = result.not_tested;
  bool is_refused = false;
  for (const VerdictTest& test : result.tests) {
    is_refused = is_refused || !test.passed;
    verdict.reasons.push_back(
        fmt::format("{} {} (statistic {:.4g}, critical value {:.4g}, p = {:.3g}).", test.meaning,
                    test.passed ? "They agree as well as chance allows." : "They differ by more than chance allows.",
                    test.statistic, test.critical, test.p_value));
  }
  const Eigen::VectorXi active = problem.space.active_bounds(result.mean);
  for (Eigen::Index i = 0; i < active.size(); ++i) {
    if (active(i) == 0) continue;
    is_refused = true;
    verdict.reasons.push_back(fmt::format(
        "The mean of {} ended on its {} bound, {:.6g}: within the bounds the chosen parameters cannot explain the "
        "tests, so something else in the model is wrong or missing.",
        problem.space.parameters()[static_cast<std::size_t>(i)].name, active(i) < 0 ? "lower" : "upper",
        result.mean(i)));
  }
  for (const Outlier& outlier : result.outliers) {
    verdict.reasons.push_back(fmt::format(
        "Specimen {} lies {:.1f} standard deviations from the others (p = {:.2g} among all of them): look at its test "
        "before trusting means and deviations.",
        outlier.sample + 1, outlier.distance, outlier.p_value));
  }
  for (const Eigen::VectorXd& other : result.other_solutions) {
    std::vector<std::string> values;
    for (Eigen::Index i = 0; i < other.size(); ++i) {
      values.push_back(
          fmt::format("{} = {:.4g}", problem.space.parameters()[static_cast<std::size_t>(i)].name, other(i)));
    }
    verdict.reasons.push_back(
        fmt::format("Other parameters explain the mean of the tests as well: {}. Measure what tells "
                    "them apart, or narrow the bounds.",
                    join(values)));
  }
  if (result.status != UpdatingStatus::converged) {
    verdict.reasons.push_back("The iteration did not converge: " + result.message + ".");
  }
  const bool is_tested = result.status == UpdatingStatus::converged && !result.tests.empty();
  verdict.conclusion = is_refused ? Conclusion::inadequate : is_tested ? Conclusion::adequate : Conclusion::undecided;
  return verdict;
}

Identifiability identify(const Eigen::Ref<const Eigen::MatrixXd>& sensitivity,
                         const Eigen::Ref<const Eigen::VectorXd>& output_scale,
                         const Eigen::Ref<const Eigen::VectorXd>& parameter_scale) {
  constexpr double k_unseen = 1e-6;
  const Eigen::MatrixXd scaled = output_scale.cwiseInverse().asDiagonal() * sensitivity * parameter_scale.asDiagonal();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(scaled, Eigen::ComputeFullV);
  Identifiability result;
  result.singular_values = svd.singularValues();
  const double threshold = k_unseen * result.singular_values(0);
  for (Eigen::Index i = 0; i < scaled.cols(); ++i) {
    if (i < result.singular_values.size() && result.singular_values(i) > threshold) {
      ++result.rank;
    } else {
      result.unseen_directions.push_back(svd.matrixV().col(i));
    }
  }
  return result;
}

std::optional<Identifiability> identify(const UpdatingProblem& problem, const UpdatingResult& result) {
  Eigen::MatrixXd sensitivity = result.sensitivity;
  if (sensitivity.size() == 0) {
    const Cloud::Valid valid = result.history.back().cloud.valid();
    if (valid.samples.rows() <= valid.samples.cols() + 1) return std::nullopt;
    sensitivity = linear_regression(valid.samples, valid.outputs).sensitivity;
  }
  const TestMoments tests = test_moments(problem.tests);
  const Eigen::VectorXd deviation = tests.covariance.diagonal().cwiseSqrt();
  const bool has_scatter = (deviation.array() > 0.0).all();
  return identify(sensitivity, has_scatter ? deviation : Eigen::VectorXd(tests.mean.cwiseAbs()),
                  problem.space.prior().covariance().diagonal().cwiseSqrt());
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
    return fmt::format("{} is not seen by the outputs", name(largest));
  }
  if (parts.size() == 2) {
    const Eigen::Index first = parts[0];
    const Eigen::Index second = parts[1];
    const double ratio = -direction(first) / direction(second);
    return fmt::format("{} and {} can only be seen together: {} {} {:.2g} {}, in prior deviations", name(first),
                       name(second), name(first), ratio < 0.0 ? '-' : '+', std::abs(ratio), name(second));
  }
  return fmt::format("the outputs do not see {}, in prior deviations", direction_text(direction, names));
}

std::string direction_text(const Eigen::Ref<const Eigen::VectorXd>& direction, const std::vector<std::string>& names) {
  constexpr double k_small = 0.1;
  constexpr std::size_t k_most = 6;
  std::vector<Eigen::Index> order;
  for (Eigen::Index i = 0; i < direction.size(); ++i) {
    if (std::abs(direction(i)) >= k_small) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return std::abs(direction(a)) > std::abs(direction(b)); });
  std::string text;
  for (std::size_t k = 0; k < std::min(order.size(), k_most); ++k) {
    const double weight = direction(order[k]);
    const char* sign = weight < 0.0 ? (k == 0 ? "-" : " - ") : (k == 0 ? "" : " + ");
    text += fmt::format("{}{:.2f} {}", sign, std::abs(weight), names[static_cast<std::size_t>(order[k])]);
  }
  return order.size() > k_most ? text + " + ..." : text;
}

int automatic_samples(int specimens, int outputs, double alpha) {
  constexpr double k_near_limit = 0.01;
  constexpr int k_per_specimen = 100;
  return std::max(sufficient_samples(specimens, outputs, alpha, k_near_limit), k_per_specimen * specimens);
}

}  // namespace mottle
