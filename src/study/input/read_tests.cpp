// The tests of a study: columns of a file that are outputs of its model, and their repeatability.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "mottle/core/text.hpp"
#include "mottle/formats/tables/csv.hpp"
#include "mottle/model/units.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "study/input/first_few.hpp"
#include "study/input/noise_rules.hpp"
#include "study/tests/column_pairing.hpp"
#include "study/tests/doubtful_frequencies.hpp"
#include "study/tests/missing_output.hpp"
#include "study/tests/mistaken_sensors.hpp"
#include "study/tests/pair_modes.hpp"
#include "study/tests/pair_tests.hpp"
#include "study/tests/repeated_specimens.hpp"
#include "study/tests/shape_size.hpp"
#include "study/tests/table_values.hpp"
#include "study/tests/test_files.hpp"

namespace mottle::study {
namespace {

/// Renumbers the modes of every row by their shapes, or at least turns the shapes to the sign of the model's.
void pair_rows(const Study& study, const StructureModel& model, const std::vector<int>& numbers,
               Eigen::MatrixXd& values, StudyTests& tests) {
  const bool is_paired = study.test->pairing == TestPairing::mac;
  if (!is_paired && model.selection().shape_modes.empty()) return;
  std::vector<Eigen::Index> columns_of_modes;
  for (const int mode : model.selection().shape_modes) columns_of_modes.push_back(mode - 1);
  try {
    const Eigen::MatrixXd reference = model.reference_displacements()(Eigen::all, columns_of_modes);
    if (!is_paired) {
      std::string turned = turn_shapes(values, model.selection(), reference, numbers);
      if (!turned.empty()) tests.notes.push_back(std::move(turned));
    } else {
      for (std::string& note : pair_tests(values, model.selection(), reference, numbers)) tests.notes.push_back(note);
    }
    TestDoubt doubt{"mistaken-sensors", mistaken_sensors(values, model.selection(), reference)};
    if (doubt.sentence.empty() && !is_paired)
      doubt = {"unlike-shapes", unlike_shapes(values, model.selection(), reference, numbers)};
    if (!doubt.sentence.empty()) tests.doubts.push_back(std::move(doubt));
  } catch (const InvalidInput& error) {
    throw InvalidInput(located(study, error));
  }
}

/// Sums of squares about the specimens' means, with their degrees of freedom.
struct Pooled {
  double squares = 0.0;
  int degrees_of_freedom = 0;
};

Pooled pool(const Eigen::Ref<const Eigen::VectorXd>& values, const std::vector<std::string>& specimens) {
  std::map<std::string, std::vector<double>> repeats;
  for (Eigen::Index row = 0; row < values.size(); ++row) {
    if (!std::isnan(values(row))) repeats[specimens[static_cast<std::size_t>(row)]].push_back(values(row));
  }
  Pooled pooled;
  for (const auto& [specimen, list] : repeats) {
    const Eigen::Map<const Eigen::VectorXd> numbers(list.data(), static_cast<Eigen::Index>(list.size()));
    pooled.squares += (numbers.array() - numbers.mean()).square().sum();
    pooled.degrees_of_freedom += static_cast<int>(list.size()) - 1;
  }
  return pooled;
}

/// Repeatability from repeated tests.
void read_repeats(const Study& study, const StructureModel& model, const std::optional<FrequencyPairing>& pairing,
                  StudyTests& tests) {
  const std::filesystem::path& file = *study.test->repeats_file;
  CsvTable table = read_named_table(study, "test.repeatability", file);
  if (pairing) pairing->renumber(table, model);
  const std::vector<std::string> names = output_names(model.outputs());
  StudyTests repeats;
  const std::vector<int> columns = match_columns(table, study, model.measured(), repeats.notes);
  Eigen::MatrixXd values = values_of_columns(table, columns, model);
  pair_rows(study, model, table.numbers, values, repeats);
  values = model.outputs_of(values);
  const int specimen = table.find("specimen");
  std::vector<std::string> specimens(table.rows.size());
  for (std::size_t row = 0; row < specimens.size() && specimen >= 0; ++row)
    specimens[row] = table.rows[row][static_cast<std::size_t>(specimen)];
  int smallest = std::numeric_limits<int>::max();
  int largest = 0;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto index = static_cast<Eigen::Index>(k);
    const Pooled pooled = pool(values.col(index), specimens);
    if (pooled.degrees_of_freedom == 0) {
      throw FormatError(
          table.file, 0,
          fmt::format("output '{}' is measured twice on no specimen, so there is no repeatability", names[k]));
    }
    tests.data.repeatability_std(index) = std::sqrt(pooled.squares / pooled.degrees_of_freedom);
    tests.data.repeatability_degrees_of_freedom(index) = pooled.degrees_of_freedom;
    smallest = std::min(smallest, pooled.degrees_of_freedom);
    largest = std::max(largest, pooled.degrees_of_freedom);
  }
  tests.notes.push_back(
      fmt::format("Measurement noise from the repeats of {}: {} degrees of freedom.", table.file,
                  smallest == largest ? fmt::format("{}", smallest) : fmt::format("{} to {}", smallest, largest)));
}

Eigen::VectorXd column_means(const Eigen::MatrixXd& values) {
  Eigen::VectorXd means(values.cols());
  for (Eigen::Index k = 0; k < values.cols(); ++k) {
    const auto column = values.col(k).array();
    means(k) = column.isNaN().select(0.0, column).sum() / static_cast<double>((!column.isNaN()).count());
  }
  return means;
}

/// Standard deviation of each output by the rules of [test] `key`.
Eigen::VectorXd standard_deviations_by_rules(const Study& study, const std::vector<NoiseRule>& rules,
                                             const std::string& key, const std::string& what,
                                             const std::vector<std::string>& names, StudyTests& tests) {
  try {
    NoiseStandardDeviations noise = noise_standard_deviations(rules, names, column_means(tests.data.values), what);
    for (std::string& note : noise.notes) tests.notes.push_back(std::move(note));
    return noise.std;
  } catch (const InvalidInput& error) {
    throw InvalidInput(located(study, "test." + key, error.what()));
  }
}

void add_model_error(const Study& study, const std::vector<std::string>& names, StudyTests& tests) {
  tests.data.is_model_error_estimated = study.test->is_model_error_estimated;
  if (study.test->model_error.empty()) return;
  tests.data.model_error_std =
      standard_deviations_by_rules(study, study.test->model_error, "model_error", "Model error", names, tests);
}

void add_repeatability(const Study& study, const StructureModel& model, const std::optional<FrequencyPairing>& pairing,
                       StudyTests& tests) {
  const Eigen::Index outputs = tests.data.values.cols();
  tests.data.repeatability_std = Eigen::VectorXd::Zero(outputs);
  tests.data.repeatability_degrees_of_freedom = Eigen::VectorXi::Zero(outputs);
  if (study.test->repeats_file) {
    read_repeats(study, model, pairing, tests);
    return;
  }
  tests.data.repeatability_std = standard_deviations_by_rules(
      study, study.test->repeatability, "repeatability", "Measurement noise", output_names(model.outputs()), tests);
}

/// Specimens from the rows of a table; those without any value are left out.
Eigen::MatrixXd values_of_rows(const Study& study, const StructureModel& model, const CsvTable& table,
                               StudyTests& tests) {
  const std::vector<int> columns = match_columns(table, study, model.measured(), tests.notes);
  const Eigen::MatrixXd values = values_of_columns(table, columns, model);
  const std::vector<int> numbers = specimen_numbers(table);
  std::vector<Eigen::Index> kept;
  std::vector<std::string> empty;
  for (Eigen::Index row = 0; row < values.rows(); ++row) {
    if (!values.row(row).array().isNaN().all()) {
      kept.push_back(row);
      tests.data.numbers.push_back(numbers[static_cast<std::size_t>(row)]);
    } else {
      empty.push_back(fmt::format("{}", numbers[static_cast<std::size_t>(row)]));
    }
  }
  if (kept.empty()) throw FormatError(table.file, 0, "holds no specimen: there is no row with a value");
  if (!empty.empty()) {
    tests.notes.push_back(fmt::format(
        "Specimens without any value are left out, {}: specimen {}; the others keep the numbers of their rows.",
        empty.size(), first_few(empty)));
  }
  Eigen::MatrixXd rows = values(kept, Eigen::all);
  pair_rows(study, model, tests.data.numbers, rows, tests);
  return rows;
}

Eigen::MatrixXd values_of_modes(const Study& study, const StructureModel& model,
                                const std::vector<MeasuredModes>& specimens, StudyTests& tests) {
  require(
      model.highest_mode() > 0, "{}",
      located(study, study.test->key,
              "these files hold modes, and no output is of a mode; static displacements are tested in a CSV, a row for "
              "each specimen"));
  try {
    PairedModes paired =
        pair_modes(model, specimens, study.test->pairing.value_or(TestPairing::mac) == TestPairing::mac);
    for (std::string& note : paired.notes) tests.notes.push_back(std::move(note));
    if (!paired.mistaken_sensors.empty()) tests.doubts.push_back({"mistaken-sensors", paired.mistaken_sensors});
    tests.pairing = std::move(paired.table);
    tests.specimens = std::make_shared<const std::vector<PairedSpecimen>>(std::move(paired.specimens));
    return paired.values;
  } catch (const InvalidInput& error) {
    throw InvalidInput(located(study, study.test->key, error.what()));
  }
}

/// Keeps the rows for which `is_kept` holds, with their numbers; the numbers of the others.
template <class Claim>
std::vector<std::string> keep_where(StudyTests& tests, Claim is_kept) {
  std::vector<Eigen::Index> kept;
  std::vector<int> numbers;
  std::vector<std::string> others;
  for (Eigen::Index s = 0; s < tests.data.values.rows(); ++s) {
    const int number = tests.data.number_of(s);
    if (!is_kept(s, number)) {
      others.push_back(fmt::format("{}", number));
      continue;
    }
    kept.push_back(s);
    numbers.push_back(number);
  }
  if (kept.empty()) return others;
  tests.data.values = Eigen::MatrixXd(tests.data.values(kept, Eigen::all));
  tests.data.numbers = std::move(numbers);
  return others;
}

/// A specimen of which pairing left nothing tells nothing, and methods expect a value of each.
void leave_out_empty(StudyTests& tests) {
  const Eigen::MatrixXd values = tests.data.values;
  if (values.array().isNaN().all()) return;
  const std::vector<std::string> empty =
      keep_where(tests, [&](Eigen::Index s, int) { return !values.row(s).array().isNaN().all(); });
  if (empty.empty()) return;
  tests.notes.push_back(fmt::format(
      "Specimens of which no output is left after pairing are left out: specimen {}; the others keep their numbers.",
      first_few(empty)));
}

void leave_out_named(const Study& study, StudyTests& tests) {
  const std::vector<int>& named = study.test->left_out;
  if (named.empty()) return;
  std::vector<std::string> known;
  for (Eigen::Index s = 0; s < tests.data.values.rows(); ++s)
    known.push_back(fmt::format("{}", tests.data.number_of(s)));
  for (const int number : named) {
    require(tests.data.find(number) >= 0, "{}",
            located(study, "test.leave_out",
                    fmt::format("there is no specimen {}; the tests have {}", number, first_few(known))));
  }
  const std::vector<std::string> out =
      keep_where(tests, [&](Eigen::Index, int number) { return std::ranges::find(named, number) == named.end(); });
  require(static_cast<Eigen::Index>(out.size()) < tests.data.values.rows(), "{}",
          located(study, "test.leave_out", "leaves no specimen"));
  tests.notes.push_back(
      fmt::format("As [test] leave_out says, specimen {} is left out; the others keep their numbers.", first_few(out)));
}

}  // namespace

StudyTests read_tests(const Study& study, const StructureModel& model) {
  require(study.test.has_value(), "{}: test: is missing; give [test] file = \"...\"", study.file.string());
  TestContents contents = study.test->contents ? *study.test->contents : read_test_files(study);
  const TestPairing pairing = study.test->pairing.value_or(contents.table ? TestPairing::order : TestPairing::mac);
  require(contents.table || pairing == TestPairing::mac || pairing == TestPairing::order,
          "{}: test.pairing: \"named\" and \"frequency\" are for a table with one row for each specimen; these tests "
          "are modes: \"mac\" or \"order\"",
          study.file.string());
  const std::vector<std::string> names = output_names(model.outputs());
  StudyTests tests;
  tests.notes = std::move(contents.notes);
  for (std::string& sentence : repeated_specimens(contents)) {
    tests.doubts.push_back({"repeated-specimens", std::move(sentence)});
  }
  std::optional<FrequencyPairing> by_frequency;
  if (contents.table) by_frequency = pair_columns(study, model, *contents.table, tests.notes);
  const Eigen::MatrixXd measured = contents.table ? values_of_rows(study, model, *contents.table, tests)
                                                  : values_of_modes(study, model, contents.specimens, tests);
  tests.data.values = model.outputs_of(measured);
  if (model.selection().shape_size == ShapeSize::free) {
    tests.notes.push_back(free_size_note(model, measured, tests.data));
  }
  leave_out_empty(tests);
  leave_out_named(study, tests);
  tests.file = contents.table ? contents.table->file : study.test->files.front().string();
  tests.is_by_rank = pairing == TestPairing::order || pairing == TestPairing::frequency;
  for (Eigen::Index k = 0; k < tests.data.values.cols(); ++k) {
    const bool is_positive = traits_of(model.outputs()[static_cast<std::size_t>(k)].kind).is_positive;
    require(!is_positive || !(tests.data.values.col(k).array() <= 0.0).any(),
            "{}: output '{}' of a specimen is not greater than 0, as a natural frequency is; leave that mode out",
            tests.file, names[static_cast<std::size_t>(k)]);
    require(!tests.data.values.col(k).unaryExpr(&is_too_large).any(),
            "{}: output '{}' of a specimen is larger than 1e150 in size; give the tests other units", tests.file,
            names[static_cast<std::size_t>(k)]);
    const auto count = (!tests.data.values.col(k).array().isNaN()).count();
    require(count > 0, "{}: output '{}' {}", tests.file, names[static_cast<std::size_t>(k)],
            count > 0 ? ""
                      : why_missing(model, model.outputs()[static_cast<std::size_t>(k)], measured, tests,
                                    pairing == TestPairing::mac));
  }
  for (TestDoubt& doubt : doubtful_frequencies(model, tests.data)) tests.doubts.push_back(std::move(doubt));
  add_repeatability(study, model, by_frequency, tests);
  add_model_error(study, names, tests);
  return tests;
}

}  // namespace mottle::study
