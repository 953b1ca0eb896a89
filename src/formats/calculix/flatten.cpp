#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <optional>

#include "formats/calculix/abaqus.hpp"
#include "formats/calculix/abaqus_cards.hpp"
#include "formats/calculix/abaqus_parts.hpp"
#include "formats/calculix/steps.hpp"
#include "formats/matrices/matrix_text.hpp"
#include "mottle/core/text.hpp"

namespace mottle::formats {
namespace {

std::vector<std::string> fields_of(std::string_view line) {
  std::vector<std::string> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t comma = std::min(line.find(',', begin), line.size());
    fields.emplace_back(trim_blanks(line.substr(begin, comma - begin)));
    begin = comma + 1;
  }
  return fields;
}

/// *NSET has NSET in front, *ELSET has ELSET: CalculiX 2.20 counts no sets that are named behind GENERATE.
std::string text_of(const Keyword& keyword) {
  std::string text = fmt::format("*{}", keyword.name);
  const auto put = [&](const std::string& name, const std::string& value) {
    text += value.empty() ? fmt::format(", {}", name) : fmt::format(", {}={}", name, value);
  };
  for (const auto& [name, value] : keyword.parameters) {
    if (name == keyword.name) put(name, value);
  }
  for (const auto& [name, value] : keyword.parameters) {
    if (name != keyword.name) put(name, value);
  }
  return text;
}

std::string stiffness(const std::string& line) {
  std::vector<std::string> fields = fields_of(line);
  if (fields[0].find('{') == std::string::npos) fields[0] = with_decimal_point(fields[0]);
  return fmt::format("{}", fmt::join(fields, ", "));
}

const AbaqusCard* card_named(std::string_view keyword) {
  const auto found = std::ranges::find(k_abaqus_cards, keyword, &AbaqusCard::keyword);
  return found == k_abaqus_cards.end() ? nullptr : &*found;
}

/// Writes the cards of a deck in CalculiX's terms, sorted by the places that CalculiX wants them in.
class Writer {
 public:
  Writer(const CalculixDeck& deck, const AbaqusModel& model) : deck_(deck), model_(model) {}

  std::vector<std::string> write() {
    for (const Instance& instance : model_.instances) {
      for (const AbaqusBlock& block : instance.blocks) put(block, &instance);
    }
    for (const AbaqusBlock& block : model_.model) put(block, nullptr);
    std::vector<std::string> lines;
    for (std::vector<std::string>* place : {&mesh_, &model_cards_, &sections_, &steps_}) {
      lines.insert(lines.end(), place->begin(), place->end());
    }
    return lines;
  }

 private:
  /// @param scope  the instance that the card is of; null: the assembly or the model
  void put(const AbaqusBlock& block, const Instance* scope) {
    const std::string& name = block.keyword.name;
    if (name == "STEP") begin_step(block.keyword);
    if (is_in_step_ && name == "FREQUENCY") begin_modes();
    if (output_cards().contains(name)) return;
    const AbaqusCard* card = card_named(name);
    if (card == nullptr && scope != nullptr) {
      refuse(deck_, block.line, fmt::format("*{} inside a part is not read; give the structure without parts", name));
    }
    if (card != nullptr && !card->turns && scope != nullptr && scope->is_turned) {
      refuse(deck_, block.line,
             fmt::format("*{} has a direction, and instance {} is rotated; give the part in its final place", name,
                         scope->name));
    }
    const CardPlace place = card == nullptr ? CardPlace::model : card->place;
    std::vector<std::string>& lines = is_in_step_                 ? steps_
                                      : place == CardPlace::mesh  ? mesh_
                                      : place == CardPlace::model ? model_cards_
                                                                  : sections_;
    if (name == "END STEP" && has_modes_) lines.insert(lines.end(), {"*NODE FILE", "U"});
    if (card == nullptr) {
      lines.push_back(block.text);
      if (name != "STEP") lines.insert(lines.end(), block.data.begin(), block.data.end());  // its title
    } else {
      put_card(block, *card, scope, lines);
    }
    if (name != "END STEP") return;
    is_in_step_ = has_modes_ = false;
  }

  void begin_step(const Keyword& step) {
    is_preloaded_ = is_preloaded_ || step_is_nonlinear_;
    is_in_step_ = true;
    step_is_nonlinear_ = is_nonlinear(step);
    step_line_ = steps_.size();
  }

  /// Modes are those of the preloaded state where a step before is geometrically nonlinear, and only there, whatever
  /// this one says; in CalculiX where this one is a PERTURBATION.
  void begin_modes() {
    has_modes_ = true;
    step_is_nonlinear_ = false;
    steps_[step_line_] = is_preloaded_ ? "*STEP, PERTURBATION" : "*STEP";
  }

  void put_card(const AbaqusBlock& block, const AbaqusCard& card, const Instance* scope,
                std::vector<std::string>& lines) const {
    const std::string& name = card.keyword == "SHELL GENERAL SECTION" ? general_section(block) : block.keyword.name;
    const Instance* within = scope;  // of the data
    Keyword keyword = block.keyword;
    keyword.name = name;
    if (auto nodes = keyword.parameters.extract("TIE NSET"); nodes) {
      nodes.key() = "NSET";
      keyword.parameters.insert(std::move(nodes));
    }
    require_known_parameters(block, card, keyword);
    if (const auto instance = keyword.parameters.find("INSTANCE"); instance != keyword.parameters.end()) {
      within = &model_.instance(deck_, block.line, instance->second);
    }
    for (const char* ignored : {"INSTANCE", "INTERNAL", "UNSORTED", "CONTROLS"}) keyword.parameters.erase(ignored);
    for (auto& [parameter, value] : keyword.parameters) {
      if (parameter == "REF NODE") value = model_.reference_node(deck_, block.line, value, scope);
      if (naming_parameters().contains(parameter)) value = model_.set_name(value, scope);
    }
    rename_element(keyword);
    lines.push_back(text_of(keyword));
    bool continues = false;
    for (std::size_t k = 0; k < block.data.size(); ++k) {
      const std::string& line = block.data[k];
      if (name == "NODE") {
        lines.push_back(node(line, block, k, scope));
      } else if (name == "KINEMATIC") {
        put_coupled(line, lines);
      } else if (name == "SPRING") {
        lines.push_back(k + 1 == block.data.size() ? stiffness(line) : line);
      } else if (name == "BOUNDARY") {
        put_support(line, block, scope, lines);
      } else {
        lines.push_back(data_line(line, block, pattern_of(block, card, line, continues), card.cycle, within));
      }
      continues = trim_blanks(line).ends_with(',');
    }
    if (name == "KINEMATIC" && block.data.empty()) lines.push_back("1, 3");
  }

  /// Nodes of solids, to which CalculiX expands shells too, have no rotations, and CalculiX takes none here.
  static void put_coupled(const std::string& line, std::vector<std::string>& lines) {
    const std::vector<std::string> fields = fields_of(line);
    long long first = 0;
    long long last = 0;
    if (!parse_whole(fields[0], first)) return lines.push_back(line);
    if (fields.size() < 2 || !parse_whole(fields[1], last)) last = first;
    if (first <= 3) lines.push_back(fmt::format("{}, {}", first, std::min(last, 3LL)));
  }

  /// CalculiX goes past others with a warning, whatever they mean.
  void require_known_parameters(const AbaqusBlock& block, const AbaqusCard& card, const Keyword& keyword) const {
    if (card.parameters.empty()) return;
    const std::vector<std::string> known = fields_of(card.parameters);
    for (const auto& each : keyword.parameters) {
      if (std::ranges::find(known, each.first) != known.end()) continue;
      refuse(
          deck_, block.line,
          fmt::format("CalculiX does not take {} of *{}, only {}; say the same by cards that it has, or leave it out",
                      each.first, block.keyword.name, join(known)));
    }
  }

  /// With a material it is a shell section that is integrated before the analysis.
  const std::string& general_section(const AbaqusBlock& block) const {
    static const std::string k_name = "SHELL SECTION";
    if (block.keyword.parameters.contains("MATERIAL") && !block.data.empty()) return k_name;
    refuse(deck_, block.line,
           "*SHELL GENERAL SECTION without MATERIAL gives a stiffness matrix, which CalculiX has no card for; give "
           "thickness and material");
  }

  static void rename_element(Keyword& keyword) {
    const auto type = keyword.parameters.find("TYPE");
    if (keyword.name != "ELEMENT" || type == keyword.parameters.end()) return;
    const auto known = std::ranges::find(k_element_names, type->second, &ElementName::abaqus);
    if (known != k_element_names.end()) type->second = known->calculix;
  }

  static std::string_view pattern_of(const AbaqusBlock& block, const AbaqusCard& card, const std::string& line,
                                     bool continues) {
    const auto& parameters = block.keyword.parameters;
    if (card.keyword == "ELEMENT" && continues) return "n";
    if (card.keyword == "SURFACE" && parameters.contains("TYPE") && parameters.at("TYPE") == "NODE") return "n.";
    if (card.keyword == "NSET" && parameters.contains("GENERATE")) return "mm.";
    if (card.keyword == "ELSET" && parameters.contains("GENERATE")) return "ee.";
    if (card.keyword == "EQUATION" && fields_of(line).size() <= 2 && line.find('.') == std::string::npos &&
        (fields_of(line).size() == 1 || fields_of(line)[1].empty())) {
      return ".";  // the number of terms
    }
    return card.fields;
  }

  std::string data_line(const std::string& line, const AbaqusBlock& block, std::string_view pattern, std::size_t cycle,
                        const Instance* scope) const {
    if (pattern == ".") return line;
    std::vector<std::string> fields = fields_of(line);
    for (std::size_t k = 0; k < fields.size(); ++k) {
      const std::size_t last = pattern.size() - std::min(cycle, pattern.size());
      const char kind = k < pattern.size() ? pattern[k] : pattern[last + (k - last) % (pattern.size() - last)];
      if (kind != '.') fields[k] = model_.reference(deck_, block.line, fields[k], kind, scope);
    }
    return fmt::format("{}", fmt::join(fields, ", "));
  }

  std::string node(const std::string& line, const AbaqusBlock& block, std::size_t index, const Instance* scope) const {
    std::vector<std::string> fields = fields_of(line);
    fields[0] = model_.reference(deck_, block.line, fields[0], 'n', scope);
    if (scope == nullptr || !scope->is_moved()) return fmt::format("{}", fmt::join(fields, ", "));
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    for (std::size_t k = 1; k < std::min<std::size_t>(fields.size(), 4); ++k) {
      if (!fields[k].empty() && !parse_fortran(fields[k], place(static_cast<Eigen::Index>(k) - 1))) {
        refuse(deck_, block.line + index + 1,
               fmt::format("'{}' is not a number, and instance {} moves this node", fields[k], scope->name));
      }
    }
    place = scope->rotation * (place + scope->translation - scope->axis_point) + scope->axis_point;
    return fmt::format("{}, {:.12e}, {:.12e}, {:.12e}", fields[0], place(0), place(1), place(2));
  }

  void put_support(const std::string& line, const AbaqusBlock& block, const Instance* scope,
                   std::vector<std::string>& lines) const {
    std::vector<std::string> fields = fields_of(line);
    const auto named =
        fields.size() < 2
            ? k_named_supports.end()
            : std::find_if(k_named_supports.begin(), k_named_supports.end(),
                           [&](const NamedSupport& support) { return support.name == capitals(fields[1]); });
    if (named == k_named_supports.end()) {
      lines.push_back(data_line(line, block, "n.", 1, scope));
      return;
    }
    const std::string nodes = model_.reference(deck_, block.line, fields[0], 'n', scope);
    for (const auto& range : named->ranges) {
      if (range[0] > 0) lines.push_back(fmt::format("{}, {}, {}", nodes, range[0], range[1]));
    }
  }

  const CalculixDeck& deck_;
  const AbaqusModel& model_;
  std::vector<std::string> mesh_, model_cards_, sections_, steps_;
  std::size_t step_line_ = 0;  ///< of the open step, in steps_
  bool is_in_step_ = false;
  bool step_is_nonlinear_ = false;
  bool is_preloaded_ = false;
  bool has_modes_ = false;
};

}  // namespace

FlatDeck flatten(const CalculixDeck& deck, const std::vector<std::string>& lines) {
  const AbaqusModel model = read_abaqus_model(deck, lines);
  return {Writer(deck, model).write(), model.notes()};
}

std::vector<std::string> element_notes(const CalculixDeck& deck) {
  if (is_abaqus_deck(deck)) {
    std::vector<std::string> lines;
    for (const CalculixDeck::Line& line : deck.lines) lines.push_back(line.text);
    return read_abaqus_model(deck, lines).notes();
  }
  std::vector<std::string> notes;
  for (const char* type : {"S4R", "B31R"}) {
    const bool has_some = std::ranges::any_of(deck.lines, [&](const CalculixDeck::Line& line) {
      const std::optional<Keyword> keyword = keyword_of(line.text);
      return keyword && keyword->name == "ELEMENT" && keyword->parameters.contains("TYPE") &&
             keyword->parameters.at("TYPE") == type;
    });
    if (!has_some) continue;
    notes.push_back(fmt::format(
        "{} has no stiffness in bending but for hourglass control in CalculiX: frequencies depend on the mesh alone; "
        "use {}.",
        type, std::string_view(type) == "S4R" ? "S4 or S8R" : "B31 or B32R"));
  }
  return notes;
}

}  // namespace mottle::formats
