// [model] of kind "nastran": a deck with parameters on the fields of its cards.
#include <cctype>
#include <map>
#include <set>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/formats/nastran/model.hpp"
#include "mottle/formats/nastran/rewrite.hpp"
#include "mottle/model/parameters/field_targets.hpp"
#include "mottle/model/structures/finite_element_structure.hpp"
#include "mottle/model/units.hpp"
#include "study/input/key_error.hpp"
#include "study/models/model_parts.hpp"
#include "study/models/nastran/field_units.hpp"
#include "study/models/registry.hpp"

namespace mottle::study {
namespace {

/// Numbers of the deck that are other than it says.
void override_fields(FiniteElementModel& model, const std::map<std::string, double>& overrides) {
  for (const auto& [target, value] : overrides) {
    bool is_found = false;
    for (CardField& field : model.fields) {
      if (fmt::format("{}:{}:{}", field.card, field.id, field.name) != target) continue;
      field.value = value;
      is_found = true;
    }
    require_key(is_found, "predict.model", "the deck has no number '{}'", target);
  }
}

class NastranSource final : public ModelSource {
 public:
  NastranSource(std::filesystem::path deck, NastranOptions options, std::optional<double> reduction_error)
      : deck_(std::move(deck)), options_(std::move(options)), reduction_error_(reduction_error) {}

  ModelParts make(const std::vector<ParameterTargets>& parameters, const JointDistribution& prior,
                  const RunSettings& /*settings*/) const override {
    NastranModel deck = read();
    override_fields(deck.model, overrides_);
    ModelParts parts;
    parts.files = std::move(deck.files);
    parts.notes = std::move(deck.notes);
    auto structure = std::make_unique<FiniteElementStructure>(std::move(deck.model), parameters, prior.mean());
    parts.reference = structure->reference();
    parts.limits = structure->limits();
    parts.sparse = std::move(structure);
    return parts;
  }

  std::optional<double> reduction_error() const override { return reduction_error_; }
  std::vector<NamedFile> files() const override { return {{"model.file", "file", deck_.string(), deck_}}; }

  std::string target_key(const std::string& target) const override { return capitals(target); }
  std::string target_unit(const std::string& target, const UnitNames& units) const override {
    return field_unit(capitals(target.substr(0, target.find(':'))), capitals(target.substr(target.rfind(':') + 1)),
                      units);
  }

  bool shows_numbers() const override { return true; }
  std::vector<ModelNumber> numbers() const override {
    const NastranModel deck = read();
    std::vector<ModelNumber> numbers;
    for (const CardField& field : deck.model.fields) {
      const bool is_usual = is_design_number(field) && field.value != 0.0;
      numbers.push_back({fmt::format("{}:{}:{}", field.card, field.id, field.name),
                         fmt::format("{}:{}", field.card, field.name), field.value, is_usual, is_usual});
    }
    return numbers;
  }
  std::optional<ExportedModel> export_at(const std::vector<ParameterTargets>& parameters,
                                         const Eigen::VectorXd& values) const override {
    FiniteElementModel model = read().model;
    const FieldTargets targets = find_field_targets(model, parameters);
    require(
        targets.geometry.empty(),
        "coordinates, orientations and offsets cannot be written into the deck: a card holds them in its own system");
    std::vector<FieldChange> changes;
    for (std::size_t p = 0; p < targets.parameters.size(); ++p) {
      for (const FieldIndex index : targets.parameters[p].fields) {
        const CardField& field = model.fields[static_cast<std::size_t>(index)];
        const double value = values(static_cast<Eigen::Index>(p));
        changes.push_back(
            {field.card, field.id, field.name, targets.parameters[p].is_factor ? value * field.value : value});
      }
    }
    const RewrittenDeck deck = rewrite_nastran_deck(deck_, options_, changes);
    ExportedModel exported{.rounding = deck.rounding};
    for (const RewrittenFile& file : deck.files) exported.files.push_back({name_beside(file.name, deck_), file.bytes});
    return exported;
  }
  std::unique_ptr<ModelSource> with_number(const std::string& target, double value) const override {
    auto other = std::make_unique<NastranSource>(*this);
    other->overrides_[target] = value;
    return other;
  }

 private:
  NastranModel read() const { return read_nastran_model(deck_, options_); }

  std::filesystem::path deck_;
  NastranOptions options_;
  std::map<std::string, double> overrides_;  // numbers of the deck that are other, by target in capitals
  std::optional<double> reduction_error_;
};

}  // namespace

std::shared_ptr<const ModelSource> read_nastran_source(TomlReader& reader, const std::filesystem::path& folder) {
  const std::filesystem::path deck = folder / reader.text("file");
  NastranOptions options;
  if (reader.raw("ignore_cards") != nullptr) {
    for (const std::string& card : reader.texts("ignore_cards")) options.ignore_cards.insert(capitals(card));
  }
  constexpr OptionRange k_any_id{.lower = 1.0, .upper = 99999999.0};
  if (reader.raw("subcase") != nullptr) options.subcase = static_cast<int>(reader.integer_or("subcase", 1, k_any_id));
  const std::optional<double> reduction_error = read_reduction(reader);
  reader.finish();
  return std::make_shared<NastranSource>(deck, std::move(options), reduction_error);
}

}  // namespace mottle::study
