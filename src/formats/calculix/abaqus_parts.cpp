#include "formats/calculix/abaqus_parts.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <optional>

#include "formats/calculix/abaqus.hpp"
#include "formats/calculix/abaqus_cards.hpp"
#include "formats/matrices/matrix_text.hpp"
#include "mottle/core/text.hpp"

namespace mottle::formats {
namespace {

constexpr long long k_largest_number = 2147483647;  // of a node or element

std::vector<AbaqusBlock> blocks_of(const std::vector<std::string>& lines) {
  std::vector<AbaqusBlock> blocks;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (is_comment(lines[i])) continue;
    if (const std::optional<Keyword> keyword = keyword_of(lines[i])) {
      blocks.push_back({*keyword, i, lines[i]});
    } else if (!blocks.empty() && (!trim_blanks(lines[i]).empty() || blocks.back().keyword.name == "SPRING")) {
      blocks.back().data.push_back(lines[i]);  // of *SPRING a blank line stands for its degrees of freedom
    }
  }
  return blocks;
}

std::string parameter(const AbaqusBlock& block, const char* name) {
  const auto found = block.keyword.parameters.find(name);
  return found == block.keyword.parameters.end() ? "" : found->second;
}

std::vector<double> numbers_of(const CalculixDeck& deck, const AbaqusBlock& block, std::size_t index) {
  std::vector<double> numbers;
  const std::string_view line = index < block.data.size() ? std::string_view(block.data[index]) : std::string_view();
  for (std::size_t begin = 0; begin < line.size();) {
    const std::size_t comma = std::min(line.find(',', begin), line.size());
    const std::string_view field = trim_blanks(line.substr(begin, comma - begin));
    double value = 0.0;
    if (!field.empty() && !parse_fortran(field, value)) {
      refuse(deck, block.line, fmt::format("its placement has '{}', which is not a number", field));
    }
    numbers.push_back(value);
    begin = comma + 1;
  }
  return numbers;
}

/// x, y, z of the translation; then two points of an axis and an angle in degrees.
void place(Instance& instance, const CalculixDeck& deck, const AbaqusBlock& block) {
  std::vector<double> shift = numbers_of(deck, block, 0);
  shift.resize(3, 0.0);
  instance.translation = Eigen::Vector3d(shift[0], shift[1], shift[2]);
  const std::vector<double> turn = numbers_of(deck, block, 1);
  if (turn.empty()) return;
  if (turn.size() < 7) {
    refuse(deck, block.line, "its rotation needs seven numbers: two points of the axis and the angle in degrees");
  }
  const Eigen::Vector3d a(turn[0], turn[1], turn[2]);
  const Eigen::Vector3d axis = Eigen::Vector3d(turn[3], turn[4], turn[5]) - a;
  if (!(axis.norm() > 0.0)) refuse(deck, block.line, "the two points of its axis of rotation are one");
  instance.axis_point = a;
  instance.rotation = Eigen::AngleAxisd(turn[6] * std::numbers::pi / 180.0, axis.normalized()).toRotationMatrix();
  instance.is_turned = turn[6] != 0.0;
}

/// Nodes or elements that the cards `keyword` make have their numbers in front.
std::set<long long> numbers_of(const std::vector<AbaqusBlock>& blocks, std::string_view keyword) {
  std::set<long long> numbers;
  for (const AbaqusBlock& block : blocks) {
    if (block.keyword.name != keyword) continue;
    for (const std::string& line : block.data) {
      long long number = 0;
      const std::string_view text(line);
      if (parse_whole(trim_blanks(text.substr(0, text.find(','))), number)) numbers.insert(number);
    }
  }
  return numbers;
}

long long largest_number(const std::vector<AbaqusBlock>& blocks) {
  std::set<long long> numbers = numbers_of(blocks, "NODE");
  numbers.merge(numbers_of(blocks, "ELEMENT"));
  return numbers.empty() ? 0 : *numbers.rbegin();
}

bool is_number(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

bool is_abaqus_deck(const CalculixDeck& deck) {
  return std::ranges::any_of(deck.lines, [](const CalculixDeck::Line& line) {
    const std::optional<Keyword> keyword = keyword_of(line.text);
    if (!keyword) return false;
    const std::set<std::string_view> own = {"PART", "ASSEMBLY", "INSTANCE", "PREPRINT", "MONITOR"};
    const bool is_request = keyword->parameters.contains("FIELD") || keyword->parameters.contains("HISTORY");
    return own.contains(keyword->name) || (keyword->name == "OUTPUT" && is_request);
  });
}

const Instance& AbaqusModel::instance(const CalculixDeck& deck, std::size_t line, const std::string& name) const {
  const auto found = std::ranges::find(instances, name, &Instance::name);
  if (found == instances.end()) {
    std::vector<std::string> known;
    for (const Instance& each : instances) known.push_back(each.name);
    refuse(deck, line, unknown_name_message("instance", name, known));
  }
  return *found;
}

std::string AbaqusModel::set_name(const std::string& name, const Instance* scope) const {
  return scope == nullptr ? name : fmt::format("{}.{}", scope->name, name);
}

std::string AbaqusModel::reference(const CalculixDeck& deck, std::size_t line, const std::string& field, char kind,
                                   const Instance* scope) const {
  std::string name = capitals(field);
  if (name.empty()) return name;
  if (is_number(name)) {
    long long number = 0;
    if (!parse_whole(name, number) || number > k_largest_number) {
      refuse(deck, line, fmt::format("'{}' is no number of a node or element", name));
    }
    if (kind == 'n' && !(scope == nullptr ? nodes : scope->nodes).contains(number)) {
      refuse(deck, line,
             fmt::format("{} has no node {}", scope == nullptr ? "the assembly" : "instance " + scope->name, number));
    }
    return fmt::format("{}", number + (scope == nullptr ? offset : scope->offset));
  }
  const std::size_t dot = name.rfind('.');
  if (kind != 's' && dot != std::string::npos && is_number(std::string_view(name).substr(dot + 1))) {
    const auto owner = std::ranges::find(instances, name.substr(0, dot), &Instance::name);
    if (owner != instances.end()) return reference(deck, line, name.substr(dot + 1), kind, &*owner);
  }
  return set_name(name, scope);
}

std::string AbaqusModel::reference_node(const CalculixDeck& deck, std::size_t line, const std::string& value,
                                        const Instance* scope) const {
  std::string name = reference(deck, line, value, 'n', scope);
  if (is_number(name)) return name;
  const auto found = single_nodes.find(name);
  if (found == single_nodes.end()) refuse(deck, line, fmt::format("REF NODE={} is no set of one node", value));
  return found->second;
}

std::vector<std::string> AbaqusModel::notes() const {
  std::vector<std::string> notes;
  std::vector<std::string> left_out;
  std::set<std::string> types;
  std::vector<const AbaqusBlock*> all;
  for (const AbaqusBlock& block : model) all.push_back(&block);
  for (const Instance& each : instances) {
    for (const AbaqusBlock& block : each.blocks) all.push_back(&block);
  }
  for (const AbaqusBlock* block : all) {
    const std::string name = fmt::format("*{}", block->keyword.name);
    if (output_cards().contains(block->keyword.name) && std::ranges::find(left_out, name) == left_out.end()) {
      left_out.push_back(name);
    }
    if (block->keyword.name == "ELEMENT") types.insert(parameter(*block, "TYPE"));
  }
  if (!left_out.empty()) notes.push_back(fmt::format("Abaqus deck: left out {}.", join(left_out)));
  for (const ElementName& element : k_element_names) {
    if (types.contains(std::string(element.abaqus))) notes.push_back(fmt::format("Abaqus deck: {}.", element.note));
  }
  for (const Instance& each : instances) {
    if (each.offset == 0) continue;
    notes.push_back(fmt::format("Abaqus deck: nodes and elements of instance {} have {} added to their numbers.",
                                each.name, each.offset));
  }
  const bool has_own = largest_number(model) > 0;
  if (offset > 0 && has_own) {
    notes.push_back(
        fmt::format("Abaqus deck: nodes and elements of the assembly have {} added to their numbers.", offset));
  }
  return notes;
}

namespace {

/// Follows *PART, *ASSEMBLY and *INSTANCE through the deck.
class ModelReader {
 public:
  ModelReader(const CalculixDeck& deck, const std::vector<std::string>& lines)
      : deck_(deck), blocks_(blocks_of(lines)) {}

  AbaqusModel read() {
    for (const AbaqusBlock& block : blocks_) take(block);
    if (!open_.empty()) refuse(deck_, opened_at_, fmt::format("*{} has no *END {}", open_, open_));
    number();
    find_nodes();
    find_single_nodes();
    return std::move(model_);
  }

 private:
  void take(const AbaqusBlock& block) {
    const std::string& name = block.keyword.name;
    if (name == "ASSEMBLY" || name == "END ASSEMBLY") {
      if (!open_.empty()) refuse(deck_, block.line, fmt::format("*{} inside of a {}", name, open_));
    } else if (name == "PART" || name == "INSTANCE") {
      open(block);
    } else if (name == "END PART" || name == "END INSTANCE") {
      if (name != "END " + open_) refuse(deck_, block.line, fmt::format("*{} ends nothing that is open", name));
      open_.clear();
    } else if (open_ == "PART") {
      parts_[part_].push_back(block);
    } else if (open_ == "INSTANCE") {
      model_.instances.back().blocks.push_back(block);
    } else {
      model_.model.push_back(block);
    }
  }

  void open(const AbaqusBlock& block) {
    if (!open_.empty()) refuse(deck_, block.line, fmt::format("*{} inside of a {}", block.keyword.name, open_));
    open_ = block.keyword.name;
    opened_at_ = block.line;
    const std::string name = parameter(block, "NAME");
    if (name.empty()) refuse(deck_, block.line, fmt::format("*{} has no NAME", open_));
    if (open_ == "PART") {
      part_ = name;
      parts_[part_] = {};
      return;
    }
    const auto part = parts_.find(parameter(block, "PART"));
    if (part == parts_.end()) {
      std::vector<std::string> known;
      for (const auto& each : parts_) known.push_back(each.first);
      refuse(deck_, block.line, unknown_name_message("*PART", parameter(block, "PART"), known));
    }
    if (std::ranges::find(model_.instances, name, &Instance::name) != model_.instances.end()) {
      refuse(deck_, block.line, fmt::format("a second instance {}", name));
    }
    model_.instances.push_back({.name = name, .blocks = part->second});
    place(model_.instances.back(), deck_, block);
  }

  void number() {
    if (model_.instances.empty()) return;
    long long largest = std::max<long long>(largest_number(model_.model), 999);
    for (const Instance& instance : model_.instances) largest = std::max(largest, largest_number(instance.blocks));
    const auto count = static_cast<long long>(model_.instances.size());
    long long step = 1000;
    while (step <= largest && step < k_largest_number) step *= 10;
    if (largest > k_largest_number || count * step + largest > k_largest_number) {
      refuse(deck_, 0, fmt::format("{} instances with numbers up to {} cannot be numbered through", count, largest));
    }
    for (Instance& instance : model_.instances) {
      instance.offset = model_.offset;
      model_.offset += step;
    }
  }

  void find_nodes() {
    model_.nodes = numbers_of(model_.model, "NODE");
    for (Instance& instance : model_.instances) instance.nodes = numbers_of(instance.blocks, "NODE");
  }

  void find_single_nodes() {
    const auto keep = [&](const AbaqusBlock& block, const Instance* scope) {
      if (block.keyword.name != "NSET" || block.data.size() != 1) return;
      std::string text = capitals(block.data[0]);
      text.resize(std::min(text.find(','), text.size()));
      const std::string node(trim_blanks(text));
      const std::string rest(trim_blanks(std::string_view(block.data[0]).substr(text.size())));
      if (!is_number(node) || (!rest.empty() && rest != ",")) return;
      const std::string within = parameter(block, "INSTANCE");
      const Instance* owner = within.empty() ? scope : &model_.instance(deck_, block.line, within);
      model_.single_nodes[model_.set_name(parameter(block, "NSET"), scope)] =
          model_.reference(deck_, block.line, node, 'm', owner);  // its card is looked at later
    };
    for (const AbaqusBlock& block : model_.model) keep(block, nullptr);
    for (const Instance& instance : model_.instances) {
      for (const AbaqusBlock& block : instance.blocks) keep(block, &instance);
    }
  }

  const CalculixDeck& deck_;
  std::vector<AbaqusBlock> blocks_;
  AbaqusModel model_;
  std::map<std::string, std::vector<AbaqusBlock>> parts_;
  std::string open_;  ///< PART, INSTANCE or nothing
  std::string part_;
  std::size_t opened_at_ = 0;
};

}  // namespace

AbaqusModel read_abaqus_model(const CalculixDeck& deck, const std::vector<std::string>& lines) {
  return ModelReader(deck, lines).read();
}

}  // namespace mottle::formats
