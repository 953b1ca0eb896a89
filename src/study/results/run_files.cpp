#include "study/results/run_files.hpp"

#include <algorithm>

#include "mottle/formats/tables/csv.hpp"

namespace mottle::study {

std::vector<std::string> column_names(const ParameterSpace& space, const std::vector<Quantity>& outputs) {
  std::vector<std::string> names = space.names();
  for (const Quantity& output : outputs) names.push_back(output.name());
  return names;
}

std::string cloud_csv(const Cloud& cloud, const ParameterSpace& space, const std::vector<Quantity>& outputs) {
  std::vector<std::string> header = column_names(space, outputs);
  header.emplace_back("status");
  Eigen::MatrixXd values(cloud.samples.rows(), cloud.samples.cols() + cloud.outputs.cols());
  values << cloud.samples, cloud.outputs;
  std::vector<std::string> status(static_cast<std::size_t>(cloud.samples.rows()), "ok");
  for (const SampleNote& note : cloud.notes) status[static_cast<std::size_t>(note.sample)] = "ok: " + note.text;
  for (const FailedRun& failure : cloud.failures) status[static_cast<std::size_t>(failure.sample)] = failure.reason;
  return format_csv(header, values, {status});
}

std::string clouds_csv(const std::vector<Cloud>& clouds, const ParameterSpace& space,
                       const std::vector<Quantity>& outputs) {
  constexpr Eigen::Index k_shown = 500;
  std::vector<std::string> header = column_names(space, outputs);
  header.insert(header.begin(), "iteration");
  std::vector<Eigen::MatrixXd> blocks;
  Eigen::Index rows = 0;
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    const Cloud::Valid valid = clouds[i].valid();
    const Eigen::Index shown = std::min(k_shown, valid.samples.rows());
    if (shown == 0) continue;  // a state of a method that draws no cloud there
    Eigen::MatrixXd block(shown, static_cast<Eigen::Index>(header.size()));
    block << Eigen::VectorXd::Constant(shown, static_cast<double>(i)), valid.samples.topRows(shown),
        valid.outputs.topRows(shown);
    rows += shown;
    blocks.push_back(std::move(block));
  }
  Eigen::MatrixXd all(rows, static_cast<Eigen::Index>(header.size()));
  Eigen::Index row = 0;
  for (const Eigen::MatrixXd& block : blocks) {
    all.middleRows(row, block.rows()) = block;
    row += block.rows();
  }
  return format_csv(header, all);
}

std::string tests_csv(const StudyTests& tests, const std::vector<Quantity>& outputs) {
  std::vector<std::string> header;
  for (const Quantity& output : outputs) header.push_back(output.name());
  header.emplace_back("specimen");
  Eigen::MatrixXd values(tests.data.values.rows(), tests.data.values.cols() + 1);
  for (Eigen::Index s = 0; s < values.rows(); ++s) values(s, values.cols() - 1) = tests.data.number_of(s);
  values.leftCols(tests.data.values.cols()) = tests.data.values;
  return format_csv(header, values);
}

std::unique_ptr<Updater> make_method(const Study& study) {
  const auto given = study.update.method_options.find(study.update.method);
  const OptionValues values = given == study.update.method_options.end() ? OptionValues{} : given->second;
  return find_method(study.update.method)
      .make(values, fmt::format("{}: [update.{}]", study.file.string(), study.update.method));
}

}  // namespace mottle::study
