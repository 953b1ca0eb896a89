#include "study/jobs/expected_runs.hpp"

#include <cmath>
#include <set>
#include <vector>

#include "mottle/core/clock.hpp"
#include "mottle/core/error.hpp"
#include "mottle/updating/methods/iteration.hpp"

namespace mottle::study {
namespace {

/// Thrown where counting would take too long; `runs`: as many at least, those that were asked for last among them.
struct TooMany {
  std::int64_t runs;
};

/// y = mean + S (x - x_0): prior standard deviations move outputs about as much as the tests scatter, or by a few
/// percent where one specimen shows no scatter, each in its way.
class LinearModel final : public Model {
 public:
  LinearModel(const Model& model, const ParameterSpace& space, const TestData& tests)
      : model_(model), prior_mean_(space.prior().mean()) {
    constexpr double k_few_percent = 0.03;
    const TestMoments moments = test_moments(tests);
    mean_ = moments.mean;
    const Eigen::VectorXd prior_std = space.prior().covariance().diagonal().cwiseSqrt();
    sensitivity_.resize(mean_.size(), prior_mean_.size());
    for (Eigen::Index k = 0; k < mean_.size(); ++k) {
      const double scatter = std::sqrt(moments.covariance(k, k));
      const double size = scatter > 0.0 ? scatter : k_few_percent * (mean_(k) == 0.0 ? 1.0 : std::abs(mean_(k)));
      for (Eigen::Index i = 0; i < prior_mean_.size(); ++i) {
        sensitivity_(k, i) = size * std::cos(static_cast<double>((k + 1) * (2 * i + 1))) / prior_std(i);
      }
    }
  }

  Eigen::Index parameter_count() const override { return model_.parameter_count(); }
  const std::vector<Quantity>& outputs() const override { return model_.outputs(); }
  double difference_step() const override { return model_.difference_step(); }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext&) const override {
    constexpr std::size_t k_most = 20'000;
    constexpr double k_patience = 2.0;  // seconds
    if (asked_.size() + static_cast<std::size_t>(samples.rows()) > k_most || steady_seconds() - begin_ > k_patience) {
      throw TooMany{runs() + samples.rows()};
    }
    for (Eigen::Index s = 0; s < samples.rows(); ++s) {
      const Eigen::VectorXd row = samples.row(s).transpose();
      asked_.emplace(row.data(), row.data() + row.size());
    }
    Evaluation found;
    found.outputs =
        ((samples.rowwise() - prior_mean_.transpose()) * sensitivity_.transpose()).rowwise() + mean_.transpose();
    return found;
  }

  std::int64_t runs() const { return static_cast<std::int64_t>(asked_.size()); }

 private:
  const Model& model_;
  Eigen::VectorXd prior_mean_;
  Eigen::VectorXd mean_;
  Eigen::MatrixXd sensitivity_;  // [output x parameter]
  double begin_ = steady_seconds();
  mutable std::set<std::vector<double>> asked_;
};

}  // namespace

ExpectedRuns count_expected_runs(const Study& study, const UpdatePlan& plan, const RunContext& context) {
  const LinearModel model(*plan.made.model, *plan.made.space, plan.tests.data);
  try {
    const UpdatingProblem problem = problem_of(study, plan, model).with_model(model, nullptr);
    const UpdatingStatus status = plan.method->update(problem, context).status;
    return {status == UpdatingStatus::failed ? 0 : model.runs()};
  } catch (const TooMany& counted) {
    return {counted.runs, true};
  } catch (const Stopped&) {
    throw;
  } catch (const Error&) {
    return {};
  }
}

std::string expected_runs_text(const ExpectedRuns& expected, double seconds, int max_parallel) {
  const double all = seconds * static_cast<double>(expected.count) / max_parallel;
  const std::string time =
      seconds > 0.0 ? fmt::format(", some {} with {} at a time", duration_text(all), max_parallel) : "";
  return fmt::format(
      "of a model that is linear in the parameters the update would take {} {} runs{}; this one may take fewer, or "
      "up to ten times as many where it is curved or does not fit the tests",
      expected.is_cut ? "more than" : "about", expected.count, time);
}

void note_expected_runs(const Study& study, const UpdatePlan& plan, const RunContext& context) {
  if (!plan.made.program || study.surrogate) return;
  const ExpectedRuns expected =
      count_expected_runs(study, plan, {.seed = context.seed, .threads = context.threads, .stop = context.stop});
  if (expected.count == 0) return context.note("how many runs of the program the update takes cannot be told before");
  const ProgramRuns& program = *plan.made.program;
  const std::string text = expected_runs_text(expected, program.seconds_at_means, program.max_parallel);
  constexpr const char* k_stored = "; of these, runs that are stored are not made again";
  if (!expected.is_cut) return context.note(text + k_stored);
  context.warning(text + k_stored +
                  ". A [surrogate] takes 50 or so (docs/howto/surrogate.md); stopped now, nothing is lost: --resume");
}

}  // namespace mottle::study
