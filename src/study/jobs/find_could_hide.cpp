#include "study/jobs/find_could_hide.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <numeric>

#include "mottle/core/text.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/stats/distributions/chi_squared.hpp"
#include "mottle/study/models/model_source.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "study/jobs/could_hide_text.hpp"
#include "study/jobs/error_derivatives.hpp"
#include "study/results/run_files.hpp"

namespace mottle::study {
namespace {

constexpr std::size_t k_max_numbers = 200;
constexpr std::size_t k_max_listed = 12;

/// Covariance of a specimen's test as in the verdict: from the scatter of the parameters, plus noise and model error.
struct TestScatter {
  Eigen::MatrixXd parameters;                                    ///< [parameter x parameter]
  Eigen::MatrixXd rest;                                          ///< [output x output]
  double denominator = std::numeric_limits<double>::infinity();  ///< of the test of the means; nan: by the effects
  bool is_within = false;  ///< the test of the means is that of residuals within specimens, by the noise in `rest`
  Eigen::VectorXd model_error_std = {};  ///< given or estimated [output]; empty: none
};

bool is_made(const UpdatingResult& result, const std::string& name) {
  return std::any_of(result.tests.begin(), result.tests.end(),
                     [&](const VerdictTest& test) { return test.name == name; });
}

bool are_means_tested(const UpdatingResult& result) {
  return is_made(result, "mean-residuals") || is_made(result, "mean-agreement") || is_made(result, "residuals");
}

bool is_definite(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd scale = covariance.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  return semidefinite_pivots(scale.asDiagonal() * covariance * scale.asDiagonal()).minCoeff() > 1e-10;
}

TestScatter scatter_of_tests(const Study& study, const UpdatingProblem& problem, const UpdatingResult& result,
                             const Eigen::MatrixXd& g) {
  const TestMoments tests = test_moments(problem.tests);
  const Eigen::VectorXd& noise = problem.tests.repeatability_std;
  const auto n = static_cast<double>(problem.tests.values.rows());
  const bool has_noise = result.noise_covariance.size() > 0 && (result.noise_covariance.diagonal().array() > 0.0).all();
  if (result.is_population && has_noise) {
    const bool is_known = (noise.array() > 0.0).all();
    return {result.covariance, result.noise_covariance,
            is_known ? std::numeric_limits<double>::infinity() : std::nan(""),
            is_made(result, "mean-residuals") || !is_made(result, "mean-agreement")};
  }
  Eigen::MatrixXd total = tests.covariance;
  double denominator = n;  // the means' degrees of freedom are still to be taken off
  if (study.update.method == "deterministic") {
    const double part = std::get<double>(make_method(study)->options().at("measurement_error"));
    const Eigen::VectorXd std = (noise.array() > 0.0).select(noise, part * tests.mean.cwiseAbs());
    total = n * std.cwiseAbs2().asDiagonal().toDenseMatrix();
    denominator = std::numeric_limits<double>::infinity();
  }
  if (!is_definite(total)) total.diagonal() += (1e-3 * tests.mean).cwiseAbs2() + 1e-6 * tests.covariance.diagonal();
  const LinearTests linear{g, Eigen::MatrixXd::Zero(g.rows(), 0), total, Eigen::MatrixXd::Zero(1, g.rows()), {}};
  const Eigen::MatrixXd scatter = error_effects(linear).mean_covariance;
  Eigen::MatrixXd rest = total - g * scatter * g.transpose();
  return {scatter, 0.5 * (rest + rest.transpose()), denominator};
}

/// Tests of the first `measured` outputs and of `further` beside them.
LinearTests linear_tests(const UpdatingProblem& problem, const TestScatter& scatter, const ErrorDerivatives& found,
                         const std::vector<Eigen::Index>& further) {
  const Eigen::Index p = problem.tests.values.cols();
  std::vector<Eigen::Index> rows(static_cast<std::size_t>(p));
  std::iota(rows.begin(), rows.end(), 0);
  rows.insert(rows.end(), further.begin(), further.end());
  const auto all = static_cast<Eigen::Index>(rows.size());
  LinearTests tests{found.parameters(rows, Eigen::all), found.errors(rows, Eigen::all), {}, {}, {}};
  tests.covariance = tests.sensitivity * scatter.parameters * tests.sensitivity.transpose();
  tests.covariance.topLeftCorner(p, p) += scatter.rest;
  tests.covariance.diagonal().tail(all - p) += found.noise(further).cwiseAbs2();
  tests.covariance.diagonal() *= 1.0 + 1e-12;  // without noise it is only just definite
  if (scatter.is_within) {
    tests.noise.resize(all);
    tests.noise << scatter.rest.diagonal(), found.noise(further).cwiseAbs2();
  }
  tests.values = Eigen::MatrixXd::Zero(problem.tests.values.rows(), all);
  tests.values.leftCols(p) = problem.tests.values;
  const Eigen::VectorXd& model_error = scatter.model_error_std;
  if (model_error.size() > 0) {
    // The relative model error of further outputs is taken as the mean of that of the measured ones.
    const double relative = (model_error.array() / found.size.head(p).array().max(1e-300)).mean();
    tests.model_error_std = relative * found.size(rows);
    tests.model_error_std.head(p) = model_error;
  }
  return tests;
}

/// The level of the verdict's test of the means, from its critical value; where it has none, that of one test of two.
double level_of_means_test(const UpdatingProblem& problem, const UpdatingResult& result, double degrees_of_freedom,
                           double denominator) {
  for (const VerdictTest& test : result.tests) {
    const bool is_of_means = test.name == "mean-residuals" || test.name == "mean-agreement" || test.name == "residuals";
    if (!is_of_means || !(degrees_of_freedom > 0.0) || !(denominator > 0.0)) continue;
    const double level =
        std::isinf(denominator)
            ? chi_squared_upper_tail(test.critical, degrees_of_freedom)
            : boost::math::cdf(complement(boost::math::fisher_f(degrees_of_freedom, denominator), test.critical));
    if (level > 1e-6 && level <= problem.level) return level;
  }
  return 1.0 - std::sqrt(1.0 - problem.level);
}

/// The test of the means as the verdict makes it.
MeansTest means_test(const UpdatingProblem& problem, const UpdatingResult& result, const TestScatter& scatter,
                     const ErrorEffects& effects) {
  const auto n = static_cast<double>(problem.tests.values.rows());
  MeansTest test;
  test.prior_std = problem.space.prior().covariance().diagonal().cwiseSqrt();
  test.denominator = std::isnan(scatter.denominator) ? static_cast<double>(effects.denominator_degrees_of_freedom)
                     : std::isinf(scatter.denominator)
                         ? scatter.denominator
                         : std::max(scatter.denominator - static_cast<double>(effects.means_degrees_of_freedom), 0.0);
  test.level =
      level_of_means_test(problem, result, static_cast<double>(effects.means_degrees_of_freedom), test.denominator);
  const double quantile = n > 1.0 ? boost::math::quantile(boost::math::students_t(n - 1.0), 0.975) : 1.96;
  test.half_widths = quantile * effects.mean_covariance.diagonal().cwiseSqrt();
  // Beyond bounds, or 10 prior standard deviations off, the verdict refuses by other tests.
  constexpr double k_absurd = 10.0;
  const Eigen::VectorXd start = problem.space.prior().mean();
  const Eigen::VectorXd reach = k_absurd * test.prior_std;
  test.room_below = (result.mean - problem.space.clamp(start - reach)).cwiseMax(0.0);
  test.room_above = (problem.space.clamp(start + reach) - result.mean).cwiseMax(0.0);
  return test;
}

/// Power of the study's tests, with further outputs, against each error.
std::vector<HiddenError> errors_with(const UpdatingProblem& problem, const UpdatingResult& result,
                                     const TestScatter& scatter, const ErrorDerivatives& found,
                                     const std::vector<Eigen::Index>& further) {
  LinearTests tests = linear_tests(problem, scatter, found, further);
  if (further.empty() && is_made(result, "mean-agreement") && std::isinf(scatter.denominator)) {
    const IterationRecord& state = result.history.back();
    tests.of_test = state.output_covariance;
    tests.of_test.diagonal() += problem.tests.repeatability_std.cwiseAbs2();
    const Eigen::Index samples = state.cloud.valid().outputs.rows();
    tests.of_cloud = state.output_covariance / static_cast<double>(std::max<Eigen::Index>(samples, 1));
  }
  const ErrorEffects effects = error_effects(tests);
  MeansTest test = means_test(problem, result, scatter, effects);
  if (!further.empty()) test.denominator = std::numeric_limits<double>::infinity();  // their noise is stated
  if (further.empty() && !are_means_tested(result)) test.denominator = 0.0;
  if (further.empty() && result.intervals) {
    const Eigen::MatrixXd& ends = result.intervals->mean;
    const Eigen::VectorXd half = 0.5 * (ends.col(1) - ends.col(0));
    test.half_widths = (half.array() > 0.0).select(half, 0.0);  // nan: there is no interval
  }
  return hidden_errors(effects, test);
}

/// A set of further outputs, with the power that it would have against the harmful errors.
struct DecidingSet {
  std::vector<std::size_t> items;
  std::vector<NamedError> errors;
  double harm = std::numeric_limits<double>::infinity();  ///< of the worst of them
  bool is_enough() const { return harm <= 1.0; }
};

/// The smallest set with which each error is refused before it moves a mean out of its interval, else the best.
DecidingSet find_deciding_set(const UpdatingProblem& problem, const UpdatingResult& result, const TestScatter& scatter,
                              const ErrorDerivatives& found, const std::vector<NamedError>& worst) {
  DecidingSet best;
  const auto try_set = [&](const std::vector<std::size_t>& items) {
    DecidingSet set{items, worst};
    std::vector<Eigen::Index> rows;
    for (const std::size_t item : items) rows.insert(rows.end(), found.rows[item].begin(), found.rows[item].end());
    const std::vector<HiddenError> errors = errors_with(problem, result, scatter, found, rows);
    set.harm = 0.0;
    for (NamedError& error : set.errors) {
      error.error = errors[static_cast<std::size_t>(error.error.quantity)];
      set.harm = std::max(set.harm, error.error.is_detected ? error.error.harm() : std::numeric_limits<double>::max());
    }
    const bool is_smaller = set.items.size() < best.items.size() || best.items.empty();
    if (set.is_enough() && best.is_enough() ? (is_smaller || set.harm < best.harm) : set.harm < best.harm) best = set;
  };
  const std::size_t count = found.further.size();
  for (std::size_t i = 0; i < count; ++i) try_set({i});
  for (std::size_t i = 0; i < count && !best.is_enough(); ++i) {
    for (std::size_t j = 0; j < i; ++j) try_set({j, i});
  }
  for (std::size_t i = 0; i < count && !best.is_enough(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      for (std::size_t k = 0; k < j; ++k) try_set({k, j, i});
    }
  }
  return best;
}

std::string capitalised(std::string text) {
  if (text.starts_with("the ")) text.front() = 'T';
  return text;
}

std::string deciding_sentence(const DecidingSet& set, const ErrorDerivatives& found) {
  if (set.items.empty() || set.harm == std::numeric_limits<double>::max()) return {};
  std::vector<std::string> texts;
  for (const std::size_t item : set.items) texts.push_back(found.further[item].text);
  return fmt::format(
      "{} would {}, measured in addition to these outputs to 0.1 % of a frequency and 1 % of a shape's size: {} "
      "would then be refused in 80 % of cases by a test of the means with known noise.",
      capitalised(join(texts, " and ")), set.is_enough() ? "decide" : "show most", sizes_text(set.errors));
}

std::vector<NamedError> name_errors(const FixedNumbers& numbers, const std::vector<HiddenError>& errors) {
  std::vector<NamedError> named;
  for (const HiddenError& error : errors) {
    const StudyParameter& number = numbers.list[static_cast<std::size_t>(error.quantity)];
    named.push_back({number.name, number.distribution.mean, numbers.sizes(error.quantity), error});
  }
  std::stable_sort(named.begin(), named.end(), [](const NamedError& one, const NamedError& other) {
    return one.error.harm() > other.error.harm();
  });
  return named;
}

CouldHide work_out(const Study& study, const StudyModel& made, const UpdatingProblem& problem,
                   const UpdatingResult& result, bool is_undecided, const RunContext& context) {
  CouldHide hidden;
  const FixedNumbers numbers = fixed_numbers(study, k_max_numbers);
  if (numbers.list.empty()) return hidden;
  const ErrorDerivatives found = differentiate_errors(study, made, numbers, result.mean, is_undecided, context);
  const Eigen::Index p = problem.tests.values.cols();
  TestScatter scatter = scatter_of_tests(study, problem, result, found.parameters.topRows(p));
  scatter.model_error_std = result.model_error ? result.model_error->std : problem.tests.model_error_std;
  const std::vector<NamedError> errors = name_errors(numbers, errors_with(problem, result, scatter, found, {}));
  const std::vector<std::string> names = problem.space.names();
  hidden.is_level_known = !std::isnan(scatter.denominator);
  constexpr std::size_t k_told = 3;
  constexpr double k_harmless = 0.05;  // of a half-width
  std::vector<NamedError> worst;
  for (const NamedError& error : errors) {
    if (hidden.errors.size() < k_max_listed) hidden.errors.push_back(error);
    if (worst.size() < k_told && error.error.harm() >= k_harmless) worst.push_back(error);
  }
  if (worst.empty()) return hidden;
  if (is_undecided) {
    for (const NamedError& error : worst)
      hidden.sentences.push_back(hidden_error_sentence(error, names, hidden.is_level_known));
    // Means cannot be tested against a model error that is estimated from them, whatever further outputs there are.
    if (!problem.tests.is_model_error_estimated) {
      const std::string decides = deciding_sentence(find_deciding_set(problem, result, scatter, found, worst), found);
      if (!decides.empty()) hidden.sentences.push_back(decides);
    }
  }
  hidden.summary = summary_text(worst, names, hidden.is_level_known);
  if (numbers.total > numbers.list.size()) {
    hidden.notes.push_back(fmt::format("Errors were examined for the first {} of the {} numbers of the model.",
                                       numbers.list.size(), numbers.total));
  }
  return hidden;
}

}  // namespace

CouldHide find_could_hide(const Study& study, const StudyModel& made, const UpdatingProblem& problem,
                          const UpdatingResult& result, Conclusion conclusion, const RunContext& context) {
  CouldHide hidden;
  if (conclusion == Conclusion::inadequate) return hidden;
  if (!study.model->shows_numbers()) {
    hidden.notes.emplace_back(
        study.file.empty()
            ? "What errors in the model's fixed numbers could hide is not computed for a model that is a "
              "function: its numbers are not known here."
            : "What errors in the model's fixed numbers could hide is not computed for a model in "
              "another program: its numbers are not known here, or each would take runs of the program.");
    return hidden;
  }
  std::string why;
  try {
    return work_out(study, made, problem, result, conclusion == Conclusion::undecided, context);
  } catch (const InvalidInput& error) {
    why = error.what();
  } catch (const SystemFailure& error) {
    why = error.what();
  }
  hidden.notes.push_back(
      fmt::format("What errors in the model's fixed numbers could hide could not be computed: {}.", why));
  return hidden;
}

}  // namespace mottle::study
