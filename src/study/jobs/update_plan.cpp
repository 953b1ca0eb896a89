#include "study/jobs/update_plan.hpp"

#include <algorithm>

#include "mottle/core/error.hpp"
#include "mottle/updating/methods/surrogate_update.hpp"
#include "study/jobs/job_files.hpp"
#include "study/jobs/study_reach.hpp"
#include "study/results/run_files.hpp"
#include "study/tests/unit_errors.hpp"

namespace mottle::study {
namespace {

/// Thrown by the first model run.
struct FirstRun {};

/// A model that must not be run.
class UnusedModel final : public Model {
 public:
  explicit UnusedModel(const Model& model) : model_(model) {}

  Eigen::Index parameter_count() const override { return model_.parameter_count(); }
  const std::vector<Quantity>& outputs() const override { return model_.outputs(); }
  double difference_step() const override { return model_.difference_step(); }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>&, const RunContext&) const override { throw FirstRun(); }

 private:
  const Model& model_;
};

/// Whether solutions are not searched for unasked: where each evaluation is a run of a program, that would cost more
/// runs than the update.
bool leaves_out_search(const Study& study, const StudyModel& made) {
  return made.program && !study.surrogate && !study.update.starts;
}

}  // namespace

const Model& UpdatePlan::model() const {
  return given ? *given : *made.model;
}

const DifferentiableModel* UpdatePlan::derivatives() const {
  return given ? dynamic_cast<const DifferentiableModel*>(given.get()) : made.model->derivatives();
}

Digest fingerprint_of(const Study& study, const UpdatePlan& plan) {
  const Digest of_study = study_fingerprint(study, plan.made);
  if (!plan.given) return of_study;
  Checksum checksum;
  checksum.add(of_study.data(), sizeof(of_study));
  const auto add = [&checksum](const auto& values) {
    const Eigen::Index shape[] = {values.rows(), values.cols()};
    checksum.add(shape, sizeof(shape));
    checksum.add(values.data(), static_cast<std::size_t>(values.size()) * sizeof(values.data()[0]));
  };
  add(plan.tests.data.values);
  add(plan.tests.data.repeatability_std);
  add(plan.tests.data.model_error_std);
  return checksum.digest();
}

UpdatePlan plan_update(const Study& study, const RunSettings& settings) {
  StudyModel made = make_model(study, study.parameters, settings);
  StudyTests tests = read_tests(study, *made.model);
  refuse_unit_errors(study, made, tests);
  std::vector<int> groups = covariance_groups(study, made.space->names());
  std::unique_ptr<Updater> method = make_method(study);
  if (leaves_out_search(study, made)) {
    tests.notes.emplace_back(
        "Other solutions are not searched for, since each evaluation is a run of the program: the estimate may be a "
        "local minimum, and whether other parameters explain the tests as well is not known. update.starts states from "
        "how many points to search; with a surrogate ([surrogate]) the search costs no runs.");
  }
  UpdatePlan plan{std::move(made), std::move(tests), std::move(method), std::move(groups), std::nullopt};
  if (shows_few_samples(study, plan.made)) {
    plan.tests.notes.push_back(fmt::format(
        "The first and the last cloud have {} samples each, since every one is a run of the program; update.samples "
        "states another number.",
        cloud_settings(study, plan.made, plan.tests.data.values.rows(), plan.tests.data.values.cols()).samples));
  }
  if (study.predict) plan.prediction = plan_prediction(study, settings);
  if (plan.prediction && plan.made.program) {
    plan.tests.notes.push_back(fmt::format(
        "The prediction takes up to three times {} runs of the program besides, after the update; predict.draws states "
        "another number. With few draws the ends of its intervals are rough.",
        study.predict->draws));
  }
  return plan;
}

void require_place_of_update(const Study& study, const std::filesystem::path& folder) {
  require_none_is_read(folder,
                       {"study.toml", "tests.csv", "pairing.csv", "history.csv", "cloud-initial.csv", "cloud-final.csv",
                        "clouds.csv", "prediction.csv", "modes.json", "posterior.csv", "posterior.json", "report.html",
                        k_log, k_journal, "result.json"},
                       paths_of(study));
  std::vector<std::string> names = files_of_jobs();
  names.emplace_back("tests.csv");
  require_own(folder, std::move(names), paths_of(study));
}

UpdatingProblem problem_of(const Study& study, const UpdatePlan& plan, const Model& model) {
  const TestData& tests = plan.tests.data;
  return {.model = model,
          .derivatives = plan.derivatives(),
          .space = *plan.made.space,
          .tests = tests,
          .cloud = cloud_settings(study, plan.made, tests.values.rows(), tests.values.cols()),
          .iterations = study.update.iterations,
          .level = study.update.level,
          .tolerance = study.update.tolerance,
          .covariance_groups = plan.covariance_groups,
          .starts = leaves_out_search(study, plan.made) ? 0 : study.update.starts.value_or(k_usual_starts)};
}

void refuse_what_methods_refuse(const Study& study, const UpdatePlan& plan, const RunContext& context) {
  const UnusedModel model(plan.model());
  const UpdatingProblem problem = problem_of(study, plan, model);
  const auto begin = [&](const auto& work) {
    try {
      work();
    } catch (const FirstRun&) {
      return;
    } catch (const InvalidInput& error) {
      throw InvalidInput(located(study, error));
    }
  };
  begin([&] { plan.method->update(problem, context); });
  if (study.surrogate) begin([&] { SurrogateUpdate(problem, *study.surrogate).run(*plan.method, context); });
}

}  // namespace mottle::study
