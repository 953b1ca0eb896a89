#include "study/tests/column_pairing.hpp"

#include <algorithm>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/stats/distributions/distribution.hpp"
#include "mottle/study/models/model_source.hpp"
#include "study/tests/tested_frequencies.hpp"

namespace mottle::study {
namespace {

/// The parameters' prior means; those of candidates beyond the study's, as of the reference.
Eigen::VectorXd prior_means(const Study& study, const StructureModel& model) {
  Eigen::VectorXd means = model.reference_parameters();
  const auto count = std::min(means.size(), static_cast<Eigen::Index>(study.parameters.list.size()));
  for (Eigen::Index i = 0; i < count; ++i) {
    means(i) = Distribution(study.parameters.list[static_cast<std::size_t>(i)].distribution).mean();
  }
  return means;
}

/// The outputs' frequencies at the prior means. A model whose solutions are runs of a program has its reference there
/// and is not run.
TestedFrequencies frequencies_at_means(const Study& study, const StructureModel& model) {
  const Eigen::VectorXd means = prior_means(study, model);
  TestData outputs;
  outputs.values = Eigen::MatrixXd::Constant(1, static_cast<Eigen::Index>(model.outputs().size()), std::nan(""));
  const bool is_at_reference = study.model->keeps_runs() || means == model.reference_parameters();
  if (!is_at_reference) outputs.values = model.evaluate(means.transpose(), {}).outputs;
  TestedFrequencies found = tested_frequencies(model, outputs);
  if (is_at_reference) found.values = reference_frequencies(model, found.modes).transpose();
  return found;
}

std::string note_on_names(const Study& study, const StructureModel& model, const CsvTable& table) {
  try {
    const FrequencyPairing known(table, model, false);
    if (known.other_than_named(model).empty()) return {};
    const FrequencyPairing pairing(table, model, !study.model->keeps_runs());
    return pairing.note_on_names(model, frequencies_at_means(study, model));
  } catch (const FormatError&) {  // said where the values are read
    return {};
  }
}

}  // namespace

std::optional<FrequencyPairing> pair_columns(const Study& study, const StructureModel& model, CsvTable& table,
                                             std::vector<std::string>& notes) {
  if (study.test->pairing == TestPairing::frequency) {
    require(model.selection().shape_modes.empty(),
            "{}: test.pairing: \"frequency\" renumbers frequencies and damping ratios, and shapes are outputs; say "
            "\"mac\", which compares them",
            study.file.string());
    FrequencyPairing pairing(table, model, true);
    pairing.renumber(table, model);
    for (std::string& note : pairing.notes(model)) notes.push_back(std::move(note));
    return pairing;
  }
  if (study.test->pairing || model.selection().frequencies.empty() || !model.selection().shape_modes.empty()) return {};
  if (std::string note = note_on_names(study, model, table); !note.empty()) notes.push_back(std::move(note));
  return {};
}

}  // namespace mottle::study
