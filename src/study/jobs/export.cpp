#include "mottle/study/jobs/export.hpp"

#include <toml++/toml.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"
#include "mottle/formats/tables/csv.hpp"
#include "mottle/study/input/study.hpp"
#include "mottle/study/input/text_file.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "mottle/study/models/model_source.hpp"
#include "study/input/toml_writer.hpp"
#include "study/results/model_files.hpp"
#include "study/results/update_results.hpp"

namespace mottle::study {
namespace {

namespace fs = std::filesystem;

/// Means and standard deviations of the parameters, in the order of the study.
struct Found {
  Eigen::VectorXd mean, standard_deviation;
  Eigen::MatrixXd correlation;  ///< what is not known is 0
  std::vector<bool> is_seen;    ///< by the tests; else what is known of a parameter comes from its prior
  Eigen::VectorXd prior_std;
};

Found read_found(const Json& parameters, const Study& study) {
  std::vector<std::string> names;
  for (const StudyParameter& parameter : study.parameters.list) names.push_back(parameter.name);
  require(parameters.at("names").get<std::vector<std::string>>() == names,
          "{}: has other parameters than the result.json beside it", study.file.string());
  Found found{numbers_of(parameters.at("mean")),
              numbers_of(parameters.at("std")),
              {},
              {},
              numbers_of(parameters.at("prior_std"))};
  const Eigen::Index count = found.mean.size();
  for (std::size_t i = 0; i < names.size(); ++i) {
    found.is_seen.push_back(!parameters.contains("findings") || parameters["findings"].at(i).at("mark") != "not-seen");
  }
  require(found.mean.allFinite(), "{}: the update found no mean of every parameter", study.file.string());
  found.correlation = Eigen::MatrixXd::Identity(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::VectorXd row = numbers_of(parameters.at("correlation").at(static_cast<std::size_t>(i)));
    for (Eigen::Index j = 0; j < count; ++j) {
      if (i != j && std::isfinite(row(j))) found.correlation(i, j) = row(j);
    }
  }
  return found;
}

/// Adds the deck at the values below `folder`; false where the model has none.
bool add_deck(const Study& study, const Eigen::VectorXd& values, const fs::path& folder, ExportOutcome& outcome) {
  const std::optional<ExportedModel> model = study.model->export_at(list_targets(study.parameters), values);
  if (!model) return false;
  for (const ExportedModel::File& file : model->files) outcome.files[folder / file.name] = file.bytes;
  if (folder == "mean" && model->rounding == 0.0) {
    outcome.notes.emplace_back(
        "The files are the model's templates as a run fills them: numbers have the digits that "
        "their formats give, and what goes by the command line is in none of them.");
  }
  if (folder == "mean" && model->rounding > 0.0) {
    outcome.notes.push_back(
        fmt::format("Numbers in the deck of the means differ by at most {:.1e} from the means, as wide "
                    "as their fields are.",
                    model->rounding));
  }
  return true;
}

std::string parameters_csv(const Json& parameters, const Found& found) {
  std::string text = "parameter,unit,mean,std,mean_lower,mean_upper,std_lower,std_upper\n";
  const auto names = parameters.at("names").get<std::vector<std::string>>();
  const auto end = [&](const char* key, std::size_t i, std::size_t side) {
    if (!parameters.contains(key) || !parameters.at(key).is_array() || !parameters.at(key).at(i).is_array())
      return std::string();
    const Json& value = parameters.at(key).at(i).at(side);
    return value.is_number() ? number_text(value.get<double>()) : std::string();
  };
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    const double deviation = found.standard_deviation(index);
    text += fmt::format("{},{},{},{},{},{},{},{}\n", names[i], parameters.at("units").at(i).get<std::string>(),
                        number_text(found.mean(index)), std::isnan(deviation) ? "" : number_text(deviation),
                        end("mean_ci95", i, 0), end("mean_ci95", i, 1), end("std_ci95", i, 0), end("std_ci95", i, 1));
  }
  return text;
}

/// The parameters of the last cloud [sample x parameter].
Eigen::MatrixXd read_samples(const fs::path& folder, const Study& study) {
  const fs::path file = folder / "cloud-final.csv";
  const CsvTable table = parse_csv(read_text_file(file), file.string());
  Eigen::MatrixXd samples(static_cast<Eigen::Index>(table.rows.size()), 0);
  for (const StudyParameter& parameter : study.parameters.list) {
    const int column = table.find(parameter.name);
    if (column < 0) throw FormatError(file.string(), 1, fmt::format("has no column '{}'", parameter.name));
    samples.conservativeResize(Eigen::NoChange, samples.cols() + 1);
    samples.rightCols(1) = numbers_of_column(table, column);
  }
  return samples;
}

/// "normal" or "lognormal" with the moments found; a parameter with no scatter keeps a narrow one.
toml::table distribution_table(const StudyParameter& parameter, double mean, double deviation) {
  const bool is_log = parameter.transform.kind == ParameterTransform::Kind::log ||
                      parameter.distribution.kind == DistributionKind::lognormal;
  toml::table table;
  table.insert("kind", is_log && mean > 0.0 ? "lognormal" : "normal");
  table.insert("mean", mean);
  table.insert("std", deviation);
  return table;
}

/// The scale stays as it was, also where it went with the distribution that is no longer there.
void keep_scale(const StudyParameter& parameter, toml::table& entry) {
  if (parameter.transform.kind != ParameterTransform::Kind::logit || entry.contains("scale")) return;
  entry.insert("scale", scale_name(parameter.transform.kind));
  entry.insert("bounds", toml::array{parameter.transform.lower, parameter.transform.upper});  // unless there are
}

toml::table correlation_table(const Eigen::MatrixXd& correlation) {
  toml::array rows;
  for (Eigen::Index i = 0; i < correlation.rows(); ++i) {
    toml::array row;
    for (Eigen::Index j = 0; j < correlation.cols(); ++j) row.push_back(correlation(i, j));
    rows.push_back(std::move(row));
  }
  toml::table table;
  table.insert("matrix", std::move(rows));
  return table;
}

/// Whether a parameter's scatter says less than its prior did, since the tests do not see it.
bool keeps_prior(const Found& found, std::size_t i) {
  const auto index = static_cast<Eigen::Index>(i);
  return !found.is_seen[i] && !(found.standard_deviation(index) >= found.prior_std(index));
}

/// What the next update may take for known: parameters that the tests did not see are as uncertain as they were.
Found as_prior(Found found) {
  for (std::size_t i = 0; i < found.is_seen.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    if (!keeps_prior(found, i)) continue;
    found.standard_deviation(index) = found.prior_std(index);
    found.correlation.row(index).setZero();
    found.correlation.col(index).setZero();
    found.correlation(index, index) = 1.0;
  }
  return found;
}

/// The study with the result as its prior. A standard deviation that is nothing or unknown becomes a thousandth of the
/// mean's size, since a prior has some.
std::string next_study(const Study& study, const Found& found, const fs::path& folder, ExportOutcome& outcome) {
  constexpr double k_narrow = 1e-3;
  constexpr double k_nothing = 1e-6;  // of the prior's
  toml::table root = toml::parse(study_text_for(study, folder));
  toml::array* list = root["parameter"].as_array();
  std::vector<std::string> narrow;
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    const StudyParameter& parameter = study.parameters.list[i];
    const auto index = static_cast<Eigen::Index>(i);
    double deviation = found.standard_deviation(index);
    if (!(deviation > k_nothing * found.prior_std(index))) {
      deviation = k_narrow * std::max(std::abs(found.mean(index)), 1e-300);
      narrow.push_back(parameter.name);
    }
    toml::table& entry = *list->get(i)->as_table();
    entry.insert_or_assign("distribution", distribution_table(parameter, found.mean(index), deviation));
    keep_scale(parameter, entry);
  }
  root.erase("correlation");
  // Rounding of the file's numbers can leave a matrix of correlations of 1 indefinite: a hair is taken off.
  const Eigen::Index count = found.correlation.rows();
  const Eigen::MatrixXd shrunk = (1.0 - 1e-9) * found.correlation + 1e-9 * Eigen::MatrixXd::Identity(count, count);
  if (!found.correlation.isIdentity(0.0)) root.insert("correlation", correlation_table(shrunk));
  if (!narrow.empty()) {
    outcome.notes.push_back(
        fmt::format("No scatter was found of {}: the prior of study.toml has 0.1 % there.", join(narrow)));
  }
  return toml_document(root);
}

std::string samples_csv(const Study& study, const Eigen::MatrixXd& samples) {
  std::vector<std::string> names;
  for (const StudyParameter& parameter : study.parameters.list) names.push_back(parameter.name);
  return format_csv(names, samples);
}

void note_unseen(const Study& study, const Found& found, ExportOutcome& outcome) {
  std::vector<std::string> unseen;
  for (std::size_t i = 0; i < found.is_seen.size(); ++i) {
    if (keeps_prior(found, i)) unseen.push_back(study.parameters.list[i].name);
  }
  if (unseen.empty()) return;
  outcome.notes.push_back(
      fmt::format("The tests do not see {}: the prior of study.toml keeps the standard deviation that it had; "
                  "samples.csv and sampled decks show the scatter that was found, not how little is known.",
                  join(unseen)));
}

/// What was found holds for the model as it was: numbers for one deck in another are a quiet mistake.
void refuse_changed_model(const Study& study, const Json& result, const ExportSettings& settings,
                          ExportOutcome& outcome) {
  if (!result.contains("model_files")) {
    outcome.notes.emplace_back(
        "The results are of an earlier version, which did not record the model's files: whether they have changed "
        "since "
        "the update is not known.");
    return;
  }
  const std::vector<std::string> changes = changes_of_model_files(study, result);
  if (changes.empty()) return;
  const std::string what = join(changes);
  require(settings.accepts_changes,
          "{}: since this update {}; what it found holds for the model as it was. Update again, or put the files back; "
          "--changed-model exports the result into the model as it is now",
          settings.results.string(), what);
  outcome.notes.push_back(
      fmt::format("Since the update {}: its result holds for the model as it was, not for this one.", what));
}

}  // namespace

ExportOutcome make_export(const ExportSettings& settings) {
  const Json result = read_update_result(settings.results);
  const Study study = read_study(settings.results / "study.toml");
  const Found found = read_found(result.at("parameters"), study);
  const Eigen::MatrixXd samples = read_samples(settings.results, study);
  ExportOutcome outcome{.folder = settings.out.empty() ? settings.results / "export" : settings.out};
  if (!outcome.folder.has_filename()) outcome.folder = outcome.folder.parent_path();  // "out/"
  require(!fs::exists(fs::symlink_status(outcome.folder)),
          "{}: is there already, and is not written over; name another folder with --out", outcome.folder.string());
  require(settings.decks <= samples.rows(), "--decks {}: the last cloud has {} samples", settings.decks,
          samples.rows());
  refuse_changed_model(study, result, settings, outcome);
  const bool has_deck = add_deck(study, found.mean, "mean", outcome);
  if (!has_deck) {
    require(settings.decks == 0, "--decks: a model of this kind has no deck that could be exported");
    outcome.notes.emplace_back("A model of this kind has no deck of its own: parameters and study alone are exported.");
  }
  for (int k = 0; k < settings.decks; ++k) {
    add_deck(study, samples.row(k).transpose(), fmt::format("sample-{:04}", k + 1), outcome);
  }
  outcome.files["parameters.csv"] = parameters_csv(result.at("parameters"), found);
  note_unseen(study, found, outcome);
  outcome.files["samples.csv"] = samples_csv(study, samples);
  outcome.files["study.toml"] = next_study(study, as_prior(found), fs::absolute(outcome.folder), outcome);
  return outcome;
}

void write_results(const ExportOutcome& outcome) {
  const fs::path partial = outcome.folder.string() + fmt::format(".partial-{}", ::getpid());
  try {
    for (const auto& [name, bytes] : outcome.files) {
      make_writable_folder((partial / name).parent_path());
      write_file_atomically(partial / name, bytes);
    }
    fs::rename(partial, outcome.folder);
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(partial, ignored);
    throw;
  }
}

RunSummary summarise(const ExportOutcome& outcome) {
  RunSummary summary{.status = "done"};
  std::vector<std::string> names;
  for (const auto& [name, bytes] : outcome.files) names.push_back(name.generic_string());
  for (const std::string& name : names) summary.lines.push_back((outcome.folder / name).string());
  for (const std::string& note : outcome.notes) summary.lines.push_back("note: " + note);
  summary.json = one_line(
      Json{{"command", "export"}, {"folder", outcome.folder.string()}, {"files", names}, {"notes", outcome.notes}});
  return summary;
}

}  // namespace mottle::study
