#include <algorithm>
#include <set>

#include "mottle/core/text.hpp"
#include "mottle/study/input/text_file.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "study/input/noise_rules.hpp"
#include "study/input/overrides.hpp"
#include "study/input/study_sections.hpp"
#include "study/input/toml_writer.hpp"
#include "study/input/unknown_values.hpp"
#include "study/models/given/given_source.hpp"
#include "study/models/registry.hpp"
#include "study/tests/shape_size.hpp"

namespace mottle::study {
namespace {

std::shared_ptr<const ModelSource> read_model(TomlReader reader, const std::filesystem::path& folder) {
  if (reader.text("kind") == k_given_kind) {
    reader.fail("kind", "the model was a function of the program that made these results, which alone can run it");
  }
  std::vector<std::string> names;
  for (const ModelKind& kind : model_kinds()) names.push_back(kind.name);
  return model_kinds()[reader.choice("kind", names, 0)].read(reader, folder);
}

}  // namespace

StudyTest read_test(TomlReader reader, const std::filesystem::path& folder) {
  StudyTest test;
  for (const std::string& file : reader.texts("file")) test.files.push_back(folder / file);
  if (reader.has("pairing")) {
    test.pairing =
        std::vector{TestPairing::order, TestPairing::mac, TestPairing::named,
                    TestPairing::frequency}[reader.choice("pairing", {"order", "mac", "named", "frequency"}, 0)];
  } else {
    reader.raw("pairing");
  }
  test.left_out = reader.mode_numbers("leave_out", "specimen");
  const toml::node* repeatability = reader.raw("repeatability");
  if (repeatability != nullptr && repeatability->is_string()) {
    test.repeats_file = folder / reader.text("repeatability");
  } else {
    test.repeatability = read_noise_rules(reader, "repeatability");
  }
  const toml::node* error = reader.raw("model_error");
  if (error != nullptr && error->is_string()) {
    test.is_model_error_estimated = reader.text("model_error") == "estimated";
    if (!test.is_model_error_estimated) {
      reader.fail_value("model_error", "\"estimated\", or a table of outputs like { \"f*\" = \"0.3 %\" }");
    }
  } else {
    test.model_error = read_noise_rules(reader, "model_error");
  }
  reader.finish();
  return test;
}

namespace {

void read_covariance(TomlReader& reader, StudyUpdate& update) {
  const std::string allowed = "\"full\" | \"diagonal\", or lists of parameters like [[\"k1\", \"k2\"], [\"k5\"]]";
  const toml::node* node = reader.raw("covariance");
  if (node == nullptr) return;
  if (const auto text = node->value_exact<std::string>()) {
    update.is_diagonal = *text == "diagonal";
    if (!update.is_diagonal && *text != "full") reader.fail_value("covariance", allowed);
    return;
  }
  const toml::array* groups = node->as_array();
  if (groups == nullptr || groups->empty()) reader.fail_value("covariance", allowed);
  std::set<std::string> seen;
  for (const toml::node& entry : *groups) {
    const toml::array* names = entry.as_array();
    if (names == nullptr || names->empty()) reader.fail_value("covariance", allowed);
    update.covariance_groups.emplace_back();
    for (const toml::node& name : *names) {
      const auto text = name.value_exact<std::string>();
      if (!text) reader.fail_value("covariance", allowed);
      if (!seen.insert(*text).second) reader.fail("covariance", fmt::format("parameter '{}' is given twice", *text));
      update.covariance_groups.back().push_back(*text);
    }
  }
}

}  // namespace

StudyUpdate read_update(TomlReader reader) {
  StudyUpdate update;
  std::vector<std::string> methods;
  for (const MethodEntry& method : updating_methods()) methods.push_back(method.name);
  update.method = methods[reader.choice("method", methods, 0)];
  const toml::node* samples = reader.raw("samples");
  update.states_samples = samples != nullptr;
  update.has_automatic_samples = samples != nullptr && samples->value_exact<std::string>() == "auto";
  if (!update.has_automatic_samples) {
    if (samples != nullptr && !samples->is_integer()) reader.fail_value("samples", "a whole number >= 2, or \"auto\"");
    update.samples = static_cast<int>(reader.integer_or("samples", update.samples, {.lower = 2.0, .upper = 1e8}));
  }
  update.design =
      std::vector{SamplingDesign::monte_carlo, SamplingDesign::latin_hypercube,
                  SamplingDesign::sobol}[reader.choice("sampling", {"monte-carlo", "latin-hypercube", "sobol"}, 0)];
  update.iterations =
      static_cast<int>(reader.integer_or("iterations", update.iterations, {.lower = 1.0, .upper = 100000.0}));
  update.tolerance =
      reader.number_or("tolerance", update.tolerance, {.lower = 0.0, .upper = 1.0, .excludes_lower = true});
  update.level = reader.number_or("level", update.level, {.lower = 1e-6, .upper = 0.5});
  update.max_failed = reader.number_or("max_failed", update.max_failed, {.lower = 0.0, .upper = 1.0});
  if (reader.has("starts"))
    update.starts = static_cast<int>(reader.integer_or("starts", 0, {.lower = 0.0, .upper = 100000.0}));
  read_covariance(reader, update);
  for (const MethodEntry& method : updating_methods()) {
    if (!reader.has(method.name)) {
      reader.raw(method.name);
      continue;
    }
    TomlReader options = reader.table(method.name);
    if (options.has("starts") && method.name != "mixture") options.fail("starts", "it is update.starts now");
    update.method_options[method.name] = options.option_values();
    for (const auto& option : update.method_options[method.name]) method.make({option}, options.where_of(option.first));
  }
  reader.finish();
  return update;
}

StudyTruth read_truth(TomlReader reader, const ModelSource& model) {
  StudyTruth truth;
  truth.specimens = static_cast<int>(reader.integer_or("specimens", truth.specimens, {.lower = 1.0, .upper = 1e7}));
  truth.noise = read_noise_rules(reader, "noise");
  truth.parameters = read_parameters(reader, model);
  reader.finish();
  return truth;
}

namespace {

/// Keys of thousands of parts (a.a.a...) would take the parser deeper than the stack is.
void require_short_keys(const std::string& bytes, const std::filesystem::path& file) {
  constexpr int k_max_parts = 1000;
  int line = 1;
  int parts = 0;
  for (const char c : bytes) {
    if (c == '\n') ++line;
    if (std::string_view("\n=,[]{}#").find(c) != std::string_view::npos) parts = 0;
    if (c == '.' && ++parts > k_max_parts) {
      throw FormatError(file.string(), line, fmt::format("holds a key of more than {} parts", k_max_parts));
    }
  }
}

toml::table parse_text(const std::string& bytes, const std::filesystem::path& file) {
  require_short_keys(bytes, file);
  try {
    return toml::parse(bytes, file.string());
  } catch (const toml::parse_error& error) {
    throw FormatError(file.string(), static_cast<int>(error.source().begin.line),
                      fmt::format("is not valid TOML: {}", error.description()));
  }
}

/// Lines of all keys, and of the entries of lists by their numbers and names.
void note_lines(const toml::table& table, const std::string& path, std::map<std::string, int>& lines) {
  for (const auto& [name, node] : table) {
    const std::string key = path + std::string(name.str());
    if (node.source().begin.line > 0) lines[key] = static_cast<int>(node.source().begin.line);
    if (const toml::table* inner = node.as_table()) note_lines(*inner, key + '.', lines);
    const toml::array* list = node.as_array();
    for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
      const toml::table* entry = list->get(i)->as_table();
      if (entry == nullptr) continue;
      const std::string number = fmt::format("{}.{}", key, i + 1);
      lines[number] = static_cast<int>(entry->source().begin.line);
      note_lines(*entry, number + '.', lines);
      if (entry->get("name") == nullptr) continue;
      lines[fmt::format("{} '{}'", key, entry->get("name")->value_or(std::string()))] =
          static_cast<int>(entry->source().begin.line);
    }
  }
}

Study study_of(const toml::table& root, const std::filesystem::path& file) {
  Study study;
  study.file = file;
  TomlReader reader(root, file.string(), "");
  study.title = reader.text_or("title", file.stem().string());
  const std::vector<std::string> units{"SI", "mm-t-s", "mm-kg-ms", "in-lbf-s"};
  study.units = units[reader.choice("units", units, 0)];
  study.seed = static_cast<std::uint64_t>(reader.integer_or("seed", 1, {.lower = 0.0}));
  const std::filesystem::path folder = file.parent_path();
  study.model = read_model(reader.table("model"), folder);
  study.parameters = read_parameters(reader, *study.model);
  study.outputs = read_outputs(reader.table("outputs"), *study.model);
  if (reader.raw("test") != nullptr) study.test = read_test(reader.table("test"), folder);
  if (reader.raw("update") != nullptr) study.update = read_update(reader.table("update"));
  if (reader.raw("truth") != nullptr) study.truth = read_truth(reader.table("truth"), *study.model);
  if (reader.raw("predict") != nullptr) study.predict = read_predict(reader.table("predict"), *study.model, folder);
  if (reader.raw("surrogate") != nullptr) study.surrogate = read_surrogate(reader.table("surrogate"));
  if (reader.raw("diagnose") != nullptr) study.diagnose = read_diagnose(reader.table("diagnose"));
  reader.finish();
  study.outputs.shape_size = shape_size_of(study);
  const bool has_parameters = !study.parameters.list.empty() || (study.truth && !study.truth->parameters.list.empty());
  if (!has_parameters) reader.fail("parameter", "there is none; give at least one [[parameter]]");
  study.text = toml_document(root);
  note_lines(root, "", study.lines);
  const std::string method = fmt::format("method '{}'", study.update.method);
  for (const std::string key : {"update.method", "update"}) {
    if (study.lines.contains(key)) study.lines.emplace(method, study.lines.at(key));
  }
  return study;
}

}  // namespace

Study read_study(const std::filesystem::path& file, const StudyOverrides& overrides) {
  toml::table root = parse_text(read_text_file(file), file);
  for (const std::string& assignment : overrides.assignments) apply_override(root, assignment);
  if (overrides.seed) root.insert_or_assign("seed", static_cast<std::int64_t>(*overrides.seed));
  refuse_unknown_values(root, file);
  return study_of(root, file);
}

Study read_study_text(const std::string& text, const std::filesystem::path& file) {
  return study_of(parse_text(text, file), file);
}

namespace {

/// Rewrites the paths of the model's files by `relative`; lists of files are made anew.
template <class Relative>
void rewrite_files(toml::table& model, const std::vector<NamedFile>& files, const Relative& relative) {
  std::set<std::string> lists;
  for (const NamedFile& named : files) {
    if (named.key.empty()) continue;
    if (!named.key.ends_with(']')) {
      const std::size_t dot = named.key.rfind('.');
      toml::table* table = dot == std::string::npos ? &model : model.at_path(named.key.substr(0, dot)).as_table();
      table->insert_or_assign(named.key.substr(dot + 1), relative(named.location));
      continue;
    }
    const std::string list = named.key.substr(0, named.key.find('['));
    if (lists.insert(list).second) model.insert_or_assign(list, toml::array());
    model[list].as_array()->push_back(relative(named.location));
  }
}

}  // namespace

std::string study_text_for(const Study& study, const std::filesystem::path& folder) {
  toml::table root = toml::parse(study.text);
  const std::filesystem::path from = std::filesystem::weakly_canonical(folder);
  const auto relative = [&](const std::filesystem::path& file) {
    // Through links: "..", as the system reads it, leads out of the folder that a link names, not out of the link.
    return std::filesystem::weakly_canonical(file).lexically_relative(from).generic_string();
  };
  const auto rewrite = [&](const char* section, const char* key, const std::filesystem::path& file) {
    root[section].as_table()->insert_or_assign(key, relative(file));
  };
  if (study.test) {
    toml::array files;
    for (const std::filesystem::path& file : study.test->files) files.push_back(relative(file));
    toml::table& test = *root["test"].as_table();
    if (files.size() == 1) {
      test.insert_or_assign("file", *files[0].as_string());
    } else {
      test.insert_or_assign("file", files);
    }
  }
  if (study.test && study.test->repeats_file) rewrite("test", "repeatability", *study.test->repeats_file);
  rewrite_files(*root["model"].as_table(), study.model->files(), relative);
  if (study.predict && study.predict->held_out) rewrite("predict", "held_out", *study.predict->held_out);
  return toml_document(root);
}

}  // namespace mottle::study
