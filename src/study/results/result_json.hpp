// Results as JSON: the contract of result.json. Numbers are written with the shortest digits that read back exactly.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/input/study.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "mottle/updating/methods/cloud.hpp"
#include "mottle/updating/methods/iteration.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "mottle/updating/verdict/verdict.hpp"

namespace mottle::study {

using Json = nlohmann::ordered_json;

/// null where the number is not finite.
Json number_json(double value);
Json to_json(const Eigen::Ref<const Eigen::VectorXd>& values);
Json to_json_rows(const Eigen::Ref<const Eigen::MatrixXd>& values);

/// Head that every result shares.
Json result_head(const Study& study, const std::string& command);

/// names, units, bounds, prior (its moments, and each marginal as the study gives it: `prior[] {kind, mean, std, lower,
/// upper}`, null for what its kind does not need), and the scale on which a population is taken as normal.
Json parameters_json(const ParameterSpace& space);

/// The same with what the update found of them.
Json updated_parameters_json(const UpdatingProblem& problem, const UpdatingResult& result);

Json outputs_json(const std::vector<Quantity>& outputs);

/// The same with the moments of tests and clouds, the noise and the model's own error.
Json updated_outputs_json(const UpdatingProblem& problem, const TestMoments& tests, const UpdatingResult& result);

/// regression, r_squared_quadratic and spearman of a cloud; null where the cloud has no scatter in some parameter.
void add_cloud_analysis(const std::vector<Quantity>& outputs, Json& result, const Cloud& regressed,
                        const Cloud& ranked);

Json ellipses_json(const Eigen::Ref<const Eigen::VectorXd>& mean, const Eigen::Ref<const Eigen::MatrixXd>& covariance);

/// How many physically impossible draws were replaced, and by which rule.
Json rejected_draws_json(std::int64_t count);

/// What happened to modes in a cloud: each remark with the number of samples it was made of.
Json tracking_json(const std::vector<SampleNote>& notes, std::size_t iteration);

Json failures_json(const std::vector<FailedRun>& failures, std::size_t iteration);

/// The whole of result.json of `update`, timings left to the caller.
Json update_result_json(const Study& study, const StudyTests& tests, const UpdatingProblem& problem,
                        const Updater& method, const UpdatingResult& result, const Verdict& verdict);

/// true, false, or null where undecided.
Json adequate_json(Conclusion conclusion);

/// Text of the document as it stands in result.json.
std::string pretty(const Json& json);

/// For programs that read a line a job.
std::string one_line(const Json& json);

}  // namespace mottle::study
