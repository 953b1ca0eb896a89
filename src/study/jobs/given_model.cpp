#include "mottle/study/jobs/given_model.hpp"

#include <set>

#include "mottle/core/clock.hpp"
#include "mottle/core/error.hpp"
#include "study/jobs/job_files.hpp"
#include "study/jobs/study_reach.hpp"
#include "study/jobs/update_by_plan.hpp"
#include "study/models/given/given_source.hpp"

namespace mottle::study {
namespace {

void require_fit(const GivenStudy& given) {
  const std::vector<Quantity>& outputs = given.model->outputs();
  const Eigen::MatrixXd& values = given.tests.values;
  require(given.model->parameter_count() == given.space.count() && given.space.count() > 0,
          "parameters: {} are given, the model has {}; at least one is needed", given.space.count(),
          given.model->parameter_count());
  require(values.cols() == static_cast<Eigen::Index>(outputs.size()) && !outputs.empty(),
          "tests: {} columns for {} outputs; each output has one", values.cols(), outputs.size());
  require(!values.array().isInf().any(), "tests: a value is infinite; nan stands for what was not measured");
  for (Eigen::Index k = 0; k < values.cols(); ++k) {
    require(!values.col(k).array().isNaN().all(),
            "tests: output '{}' is never measured; leave it out of tests and function",
            outputs[static_cast<std::size_t>(k)].name());
  }
  std::set<std::string> names;
  for (const std::string& name : given.space.names()) names.insert(name);
  require(names.size() == given.space.names().size(), "parameters: one name is given twice");
  for (const Quantity& output : outputs) {
    require(names.insert(output.name()).second,
            "tests: the name '{}' is given twice, to outputs or to a parameter as well", output.name());
  }
}

Study study_of(const GivenStudy& given) {
  Study study;
  study.title = given.title;
  study.seed = given.seed;
  study.model = given_source();
  study.update = given.update;
  study.surrogate = given.surrogate;
  study.text = given.text;
  for (const std::string& name : given.space.names()) study.parameters.list.emplace_back().name = name;
  return study;
}

UpdatePlan plan_of(GivenStudy given) {
  const std::string& name = given.update.method;
  const auto options = given.update.method_options.find(name);
  UpdatePlan plan;
  plan.method = find_method(name).make(options == given.update.method_options.end() ? OptionValues() : options->second,
                                       name + ":");
  plan.made.space = std::make_unique<ParameterSpace>(std::move(given.space));
  plan.tests.data = std::move(given.tests);
  plan.tests.notes = std::move(given.notes);
  plan.given = std::move(given.model);
  return plan;
}

}  // namespace

UpdateOutcome update(GivenStudy given, const RunSettings& settings) {
  const double start = steady_seconds();
  require_fit(given);
  const Study study = study_of(given);
  require_place_of_update(study, settings.folder);
  return without_earlier(settings.folder, results_not_read(settings.folder, result_names(), paths_of(study)),
                         [&] { return update_by_plan(study, plan_of(std::move(given)), start, settings); });
}

}  // namespace mottle::study
