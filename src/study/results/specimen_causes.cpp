#include "study/results/specimen_causes.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "mottle/core/text.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"
#include "study/results/next_steps.hpp"

namespace mottle::study {
namespace {

using Causes = std::vector<VerdictCause>;

void add_outliers(const SummarySources& s, Causes& causes) {
  if (s.result.outliers.empty()) return;
  VerdictCause cause{.kind = "outlier"};
  std::vector<std::string> names;
  std::vector<std::string> distances;
  for (const Outlier& outlier : s.result.outliers) {
    cause.specimens.push_back(s.problem.tests.number_of(outlier.sample));
    names.push_back(fmt::format("{}", cause.specimens.back()));
    distances.push_back(fmt::format("{:.1f}", outlier.distance));
  }
  cause.sentence =
      names.size() == 1
          ? fmt::format("Specimen {} lies {} standard deviations from the others.", names.front(), distances.front())
          : fmt::format("Specimens {} lie {} standard deviations from the others.", join(names), join(distances));
  cause.next = without_specimens(s, cause.specimens);
  causes.push_back(std::move(cause));
}

/// Specimens whose own residuals refuse the model while those of most others do not: what is wrong is theirs.
std::vector<Eigen::Index> odd_specimens(const SummarySources& s) {
  if (!s.result.specimens || s.verdict.conclusion != Conclusion::inadequate) return {};
  const Eigen::MatrixXd& residuals = s.result.specimens->residuals;
  constexpr Eigen::Index k_fewest = 4;
  if (residuals.rows() < k_fewest) return {};
  std::vector<double> p_values;
  for (const auto& row : residuals.rowwise()) {
    const auto measured = static_cast<double>((!row.array().isNaN()).count());
    const double squares = row.array().isNaN().select(0.0, row.array().square()).sum();
    p_values.push_back(measured > 0.0 ? chi_squared_upper_tail(squares, measured) : 1.0);
  }
  std::vector<Eigen::Index> odd;
  const double least = s.verdict.level / static_cast<double>(residuals.rows());
  for (std::size_t i = 0; i < p_values.size(); ++i) {
    if (p_values[i] < least) odd.push_back(static_cast<Eigen::Index>(i));
  }
  constexpr std::size_t k_most = 4;  // a quarter: where more are odd, the model is
  return odd.size() * k_most <= p_values.size() ? odd : std::vector<Eigen::Index>{};
}

/// "f1": the output of its largest residual.
std::string worst_output(const SummarySources& s, Eigen::Index specimen) {
  const Eigen::ArrayXd sizes = s.result.specimens->residuals.row(specimen).array().abs();
  Eigen::Index worst = 0;
  sizes.isNaN().select(0.0, sizes).maxCoeff(&worst);
  return s.problem.model.outputs()[static_cast<std::size_t>(worst)].name();
}

void add_odd_specimens(const SummarySources& s, Causes& causes) {
  VerdictCause cause{.kind = "outlier"};
  std::vector<std::string> names;
  for (const Eigen::Index specimen : odd_specimens(s)) {
    cause.specimens.push_back(s.problem.tests.number_of(specimen));
    cause.outputs.push_back(worst_output(s, specimen));
    names.push_back(fmt::format("specimen {} ({})", cause.specimens.back(), cause.outputs.back()));
  }
  if (names.empty()) return;
  cause.sentence = fmt::format(
      "No parameters of the population reproduce the test of {}, as they do most of the others.", join(names));
  cause.next = without_specimens(s, cause.specimens);
  causes.push_back(std::move(cause));
}

void add_normality(const SummarySources& s, Causes& causes) {
  if (!s.result.normality || !s.result.normality->is_remarkable) return;
  std::vector<std::string> looks;
  bool has_more_than_outliers = s.result.outliers.empty();
  for (const std::string& suggestion : s.result.normality->suggestions) {
    if (suggestion.empty()) continue;
    looks.push_back(suggestion);
    has_more_than_outliers = has_more_than_outliers || suggestion.find("except for the specimens") == std::string::npos;
  }
  if (!has_more_than_outliers) return;
  const bool has_batches =
      std::ranges::any_of(looks, [](const auto& look) { return look.find("two batches") != std::string::npos; });
  causes.push_back({.kind = has_batches ? "two-batches" : "not-normal",
                    .sentence = looks.empty() ? "The specimens do not look like one normal population."
                                              : fmt::format("The specimens do not look like one normal population: {}.",
                                                            join(looks, "; ")),
                    .next = other_population(s, has_batches)});
}

}  // namespace

void add_causes_of_specimens(const SummarySources& s, Causes& causes) {
  // More than a fifth of the specimens are no outliers, but a batch.
  const bool are_few = 5 * static_cast<Eigen::Index>(s.result.outliers.size()) <= s.problem.tests.values.rows();
  Causes of_population;
  add_normality(s, of_population);
  const bool has_batches = !of_population.empty() && of_population.front().kind == "two-batches";
  if (are_few || !has_batches) add_outliers(s, causes);
  if (s.result.outliers.empty()) add_odd_specimens(s, causes);
  std::ranges::move(of_population, std::back_inserter(causes));
}

}  // namespace mottle::study
