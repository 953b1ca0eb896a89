#include "mottle/model/parameters/field_targets.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <map>
#include <set>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"

namespace mottle {
namespace {

constexpr std::size_t k_listed_names = 12;

struct TargetName {
  std::string card;
  int id = 0;
  std::string field;
};

TargetName split(const std::string& parameter, const std::string& target) {
  const std::size_t first = target.find(':');
  const std::size_t second = first == std::string::npos ? first : target.find(':', first + 1);
  TargetName name;
  const bool has_parts = second != std::string::npos;
  const char* begin = target.data() + (has_parts ? first + 1 : 0);
  const char* end = target.data() + (has_parts ? second : 0);
  const auto [stop, error] = std::from_chars(begin, end, name.id);
  require(has_parts && error == std::errc() && stop == end,
          "parameter '{}': target '{}' is not CARD:ID:FIELD, like MAT1:2:E or PELAS:160:K", parameter, target);
  name.card = target.substr(0, first);
  name.field = target.substr(second + 1);
  for (std::string* text : {&name.card, &name.field}) {
    std::transform(text->begin(), text->end(), text->begin(),
                   [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  }
  return name;
}

/// The names of a card's geometry numbers, in the order of their numbers.
const std::vector<std::string>& geometry_names(const std::string& card) {
  static const std::map<std::string, std::vector<std::string>> k_names = {
      {"GRID", {"X", "Y", "Z"}},
      {"CBAR", {"X1", "X2", "X3", "W1A", "W2A", "W3A", "W1B", "W2B", "W3B"}},
      {"CBEAM", {"X1", "X2", "X3", "W1A", "W2A", "W3A", "W1B", "W2B", "W3B"}},
      {"CONM2", {"X1", "X2", "X3"}},
      {"CQUAD4", {"ZOFFS"}},
      {"CTRIA3", {"ZOFFS"}}};
  static const std::vector<std::string> k_none;
  const auto found = k_names.find(card);
  return found == k_names.end() ? k_none : found->second;
}

template <typename Elements, typename Claim>
int index_where(const Elements& elements, const Claim& claim) {
  const auto found = std::find_if(elements.begin(), elements.end(), claim);
  return found == elements.end() ? -1 : static_cast<int>(found - elements.begin());
}

int geometry_index(const FiniteElementModel& model, const TargetName& name) {
  if (name.card == "GRID") return model.find_node(name.id);
  if (name.card == "CBAR" || name.card == "CBEAM") {
    return index_where(model.beams, [&](const BeamElement& e) { return e.card == name.card && e.id == name.id; });
  }
  if (name.card == "CONM2") {
    return index_where(model.point_masses,
                       [&](const PointMassElement& e) { return e.card == name.card && e.id == name.id; });
  }
  const int nodes = name.card == "CQUAD4" ? 4 : 3;
  return index_where(model.shells, [&](const ShellElement& e) { return e.node_count == nodes && e.id == name.id; });
}

/// The ids of all nodes or elements of a card that has geometry numbers.
std::vector<std::string> geometry_ids(const FiniteElementModel& model, const std::string& card) {
  std::vector<std::string> ids;
  const auto add = [&](const auto& elements, const auto& is_meant) {
    for (const auto& element : elements) {
      if (is_meant(element)) ids.push_back(std::to_string(element.id));
    }
  };
  if (card == "GRID") {
    add(model.nodes, [](const Node& node) { return !node.is_scalar; });
  } else if (card == "CONM2") {
    add(model.point_masses, [&](const PointMassElement& e) { return e.card == card; });
  } else if (card == "CBAR" || card == "CBEAM") {
    add(model.beams, [&](const BeamElement& e) { return e.card == card; });
  } else {
    add(model.shells, [&](const ShellElement& e) { return e.node_count == (card == "CQUAD4" ? 4 : 3); });
  }
  return ids;
}

double& geometry_number(FiniteElementModel& model, const GeometryTarget& target) {
  const auto index = static_cast<std::size_t>(target.index);
  if (target.card == "GRID") return model.nodes[index].position(target.number);
  if (target.card == "CONM2") return model.point_masses[index].offset(target.number);
  if (target.card == "CBAR" || target.card == "CBEAM") {
    BeamElement& beam = model.beams[index];
    if (target.number < 3) return beam.orientation(target.number);
    return beam.offsets[target.number < 6 ? 0 : 1](target.number % 3);
  }
  return model.shells[index].offset;
}

[[noreturn]] void refuse(const FiniteElementModel& model, const std::string& parameter, const TargetName& name) {
  std::set<std::string> cards;
  std::vector<std::string> ids;
  std::vector<std::string> names;
  for (const CardField& field : model.fields) {
    cards.insert(field.card);
    if (field.card != name.card) continue;
    if (ids.empty() || ids.back() != std::to_string(field.id)) ids.push_back(std::to_string(field.id));
    if (field.id == name.id) names.push_back(field.name);
  }
  const std::vector<std::string>& of_geometry = geometry_names(name.card);
  if (!of_geometry.empty()) {
    if (geometry_index(model, name) >= 0) {
      names.insert(names.end(), of_geometry.begin(), of_geometry.end());
    } else {
      ids = geometry_ids(model, name.card);
    }
  }
  const std::string start = fmt::format("parameter '{}': it acts on nothing: ", parameter);
  if (!names.empty()) {
    const std::string owner = fmt::format("number of {} {}", name.card, name.id);
    throw InvalidInput(start + unknown_name_message(owner, name.field, names));
  }
  if (!ids.empty()) {
    const bool is_cut = ids.size() > k_listed_names;
    if (is_cut) ids.resize(k_listed_names);
    throw InvalidInput(fmt::format("{}the deck has no {} {}; it has {}{}", start, name.card, name.id, join(ids),
                                   is_cut ? ", ..." : ""));
  }
  throw InvalidInput(start + unknown_name_message("card", name.card, {cards.begin(), cards.end()}));
}

/// Adds a geometry number to the fields; k_no_field where the name is none.
FieldIndex geometry_field(FiniteElementModel& model, const TargetName& name, FieldTargets& targets) {
  const std::vector<std::string>& names = geometry_names(name.card);
  const auto found = std::find(names.begin(), names.end(), name.field);
  if (found == names.end()) return k_no_field;
  const int index = geometry_index(model, name);
  if (index < 0) return k_no_field;
  GeometryTarget target{static_cast<FieldIndex>(model.fields.size()), name.card, index,
                        static_cast<int>(found - names.begin())};
  model.fields.push_back({name.card, name.id, name.field, geometry_number(model, target)});
  targets.geometry.push_back(target);
  return target.field;
}

/// What a number must be for the structure to exist; products of inertia and geometry may have any sign.
PhysicalLimit limit_of(const CardField& field, bool is_factor) {
  constexpr double k_none = -std::numeric_limits<double>::infinity();
  const std::string& name = field.name;
  const auto is_one_of = [&name](std::initializer_list<const char*> names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  const bool is_geometry = !geometry_names(field.card).empty() &&
                           std::count(geometry_names(field.card).begin(), geometry_names(field.card).end(), name) > 0;
  const bool is_product =
      is_one_of({"I12", "I21", "I31", "I32"}) || (field.card == "CONM1" && name.size() == 3 && name[1] != name[2]);
  if (is_geometry || is_product) return {.lower = k_none, .excludes_lower = true};
  if (name == "NU" && !is_factor) return {.lower = -1.0, .excludes_lower = true};
  const bool may_vanish = name == "NSM" || field.card == "PDAMP" || field.card == "CDAMP2" || name.front() == 'B';
  return {.lower = 0.0, .excludes_lower = !may_vanish};
}

PhysicalLimit stricter(const PhysicalLimit& a, const PhysicalLimit& b) {
  if (a.lower != b.lower) return a.lower > b.lower ? a : b;
  return {a.lower, a.excludes_lower || b.excludes_lower};
}

}  // namespace

FieldTargets find_field_targets(FiniteElementModel& model, const std::vector<ParameterTargets>& parameters) {
  FieldTargets targets;
  std::map<FieldIndex, std::string> owner;
  for (const ParameterTargets& parameter : parameters) {
    require(!parameter.targets.empty(), "parameter '{}': it has no target, so it acts on nothing", parameter.parameter);
    FieldParameter result{{}, parameter.is_factor};
    PhysicalLimit limit{.lower = -std::numeric_limits<double>::infinity(), .excludes_lower = true};
    for (const std::string& target : parameter.targets) {
      const TargetName name = split(parameter.parameter, target);
      FieldIndex field = index_where(model.fields, [&](const CardField& known) {
        return known.id == name.id && known.card == name.card && known.name == name.field;
      });
      if (field == k_no_field) field = geometry_field(model, name, targets);
      if (field == k_no_field) refuse(model, parameter.parameter, name);
      const auto [previous, is_new] = owner.emplace(field, parameter.parameter);
      require(is_new, "parameter '{}': target '{}' is already tied to parameter '{}'", parameter.parameter, target,
              previous->second);
      const CardField& found = model.fields[static_cast<std::size_t>(field)];
      require(!parameter.is_factor || found.value != 0.0,
              "parameter '{}': a factor on '{}', whose nominal value is 0, acts on nothing", parameter.parameter,
              target);
      result.fields.push_back(field);
      limit = stricter(limit, limit_of(found, parameter.is_factor));
    }
    targets.parameters.push_back(std::move(result));
    targets.limits.push_back(limit);
  }
  return targets;
}

FiniteElementModel model_at(const FiniteElementModel& model, const FieldTargets& targets,
                            const Eigen::Ref<const Eigen::VectorXd>& parameters) {
  FiniteElementModel moved = model;
  for (std::size_t p = 0; p < targets.parameters.size(); ++p) {
    const double x = parameters(static_cast<Eigen::Index>(p));
    for (const FieldIndex field : targets.parameters[p].fields) {
      double& value = moved.fields[static_cast<std::size_t>(field)].value;
      value = targets.parameters[p].is_factor ? x * value : x;
    }
  }
  for (const GeometryTarget& target : targets.geometry) geometry_number(moved, target) = moved.value(target.field);
  return moved;
}

}  // namespace mottle
