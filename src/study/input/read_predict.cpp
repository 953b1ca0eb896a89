// Readers of [surrogate], [predict] and [diagnose].
#include "mottle/study/models/model_source.hpp"
#include "study/input/study_sections.hpp"

namespace mottle::study {

StudyPredict read_predict(TomlReader reader, const ModelSource& model, const std::filesystem::path& folder) {
  StudyPredict predict;
  predict.overrides = reader.number_map("model", {.lower = 0.0});
  if (!predict.overrides.empty() && !model.has_targets()) {
    reader.fail("model", "is not for a model by command, whose numbers are its own");
  }
  predict.repeatability = reader.number_map("repeatability", {.lower = 0.0});
  constexpr int k_draws_of_a_program = 200;  // each a run, up to three times
  if (model.keeps_runs()) predict.draws = k_draws_of_a_program;
  predict.draws = static_cast<int>(reader.integer_or("draws", predict.draws, {.lower = 100.0, .upper = 1e7}));
  if (reader.raw("held_out") != nullptr) predict.held_out = folder / reader.text("held_out");
  predict.outputs = read_outputs(std::move(reader), model);
  return predict;
}

StudyDiagnose read_diagnose(TomlReader reader) {
  StudyDiagnose diagnose;
  diagnose.spread = reader.number_or("spread", diagnose.spread, {.lower = 1e-6, .upper = 1.0});
  diagnose.screened = static_cast<int>(reader.integer_or("screened", diagnose.screened, {.lower = 1.0, .upper = 1e6}));
  diagnose.like_evidence = reader.number_or("like_evidence", diagnose.like_evidence, {.lower = 0.0, .upper = 1e6});
  diagnose.evidence = static_cast<int>(reader.integer_or("evidence", diagnose.evidence, {.lower = 0.0, .upper = 1e6}));
  if (const toml::node* node = reader.raw("candidates"); node != nullptr) {
    const std::string allowed = "a list of targets, like [\"spring:k3\"], or of tables like a [[parameter]]";
    const toml::array* list = node->as_array();
    if (list == nullptr || list->empty()) reader.fail_value("candidates", allowed);
    for (std::size_t i = 0; i < list->size(); ++i) {
      StudyParameter candidate;
      if (const auto target = list->get(i)->value_exact<std::string>()) {
        candidate.targets = {*target};
      } else if (list->get(i)->is_table()) {
        TomlReader entry = reader.table_in("candidates", i);
        candidate = read_parameter(entry);
      } else {
        reader.fail_value("candidates", allowed);
      }
      diagnose.candidates.push_back(std::move(candidate));
    }
  }
  reader.finish();
  return diagnose;
}

SurrogateSettings read_surrogate(TomlReader reader) {
  SurrogateSettings settings;
  settings.kind =
      static_cast<SurrogateKind>(reader.choice("kind", surrogate_kinds(), static_cast<std::size_t>(settings.kind)));
  settings.runs = static_cast<int>(reader.integer_or("runs", settings.runs, {.lower = 10.0, .upper = 1e5}));
  settings.spread = reader.number_or("spread", settings.spread, {.lower = 0.5, .upper = 6.0});
  settings.rounds = static_cast<int>(reader.integer_or("rounds", settings.rounds, {.lower = 0.0, .upper = 100.0}));
  settings.tolerance = reader.number_or("tolerance", settings.tolerance, {.lower = 1e-6, .upper = 1.0});
  reader.finish();
  return settings;
}

}  // namespace mottle::study
