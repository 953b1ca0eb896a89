#include "mottle/model/parameters/field_targets.hpp"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <limits>
#include <map>
#include <set>

#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"

namespace mottle::model {
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
  require_of(has_parts && error == std::errc() && stop == end, subject_parameter(parameter),
             "target '{}' is not CARD:ID:FIELD, like MAT1:2:E or PELAS:160:K", target);
  name.card = capitals(target.substr(0, first));
  name.field = capitals(target.substr(second + 1));
  return name;
}

/// Calls `action` with the elements of the kind to which a card belongs, if that card has geometry numbers, and with
/// their description.
template <typename Lists, typename Action>
void with_geometry(Lists& lists, const std::string& card, const Action& action) {
  for_each_list(lists, [&](auto& list) {
    const auto& geometry = traits_of(list).geometry;
    if (std::count(geometry.cards.begin(), geometry.cards.end(), card) > 0) action(list, geometry);
  });
}

/// The names of a card's geometry numbers, in the order of their numbers.
std::vector<std::string> geometry_names(const std::string& card) {
  if (card == "GRID") return {"X", "Y", "Z"};
  const ElementLists kinds;
  std::vector<std::string> names;
  with_geometry(kinds, card, [&](const auto&, const auto& geometry) { names = geometry.names; });
  return names;
}

template <typename Elements, typename Claim>
int index_where(const Elements& elements, const Claim& claim) {
  const auto found = std::find_if(elements.begin(), elements.end(), claim);
  return found == elements.end() ? -1 : static_cast<int>(found - elements.begin());
}

int geometry_index(const FiniteElementModel& model, const TargetName& name) {
  if (name.card == "GRID") return model.find_node(name.id);
  int index = -1;
  with_geometry(model.element_lists, name.card, [&](const auto& list, const auto&) {
    index = index_where(list, [&](const auto& e) { return e.id == name.id && e.k_traits.card(e) == name.card; });
  });
  return index;
}

/// The ids of all nodes or elements of a card that has geometry numbers.
std::vector<std::string> geometry_ids(const FiniteElementModel& model, const std::string& card) {
  std::vector<std::string> ids;
  if (card == "GRID") {
    for (const Node& node : model.nodes) {
      if (!node.is_scalar) ids.push_back(std::to_string(node.id));
    }
  }
  with_geometry(model.element_lists, card, [&](const auto& list, const auto&) {
    for (const auto& element : list) {
      if (element.k_traits.card(element) == card) ids.push_back(std::to_string(element.id));
    }
  });
  return ids;
}

double& geometry_number(FiniteElementModel& model, const GeometryTarget& target) {
  const auto index = static_cast<std::size_t>(target.index);
  if (target.card == "GRID") return model.nodes[index].position(target.number);
  double* number = nullptr;
  with_geometry(model.element_lists, target.card,
                [&](auto& list, const auto& geometry) { number = &geometry.at(list[index], target.number); });
  assert(number != nullptr);
  return *number;
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
  const std::vector<std::string> of_geometry = geometry_names(name.card);
  if (!of_geometry.empty()) {
    if (geometry_index(model, name) >= 0) {
      names.insert(names.end(), of_geometry.begin(), of_geometry.end());
    } else {
      ids = geometry_ids(model, name.card);
    }
  }
  const auto fault_of = [&](const std::string& fault) {
    return SubjectError(subject_parameter(parameter), "it acts on nothing: " + fault);
  };
  if (!names.empty()) {
    const std::string owner = fmt::format("number of {} {}", name.card, name.id);
    throw fault_of(unknown_name_message(owner, name.field, names));
  }
  if (!ids.empty()) {
    const bool is_cut = ids.size() > k_listed_names;
    if (is_cut) ids.resize(k_listed_names);
    throw fault_of(
        fmt::format("the deck has no {} {}; it has {}{}", name.card, name.id, join(ids), is_cut ? ", ..." : ""));
  }
  throw fault_of(unknown_name_message("card", name.card, {cards.begin(), cards.end()}));
}

/// Adds a geometry number to the fields; k_no_field where the name is none.
FieldIndex geometry_field(FiniteElementModel& model, const TargetName& name, FieldTargets& targets) {
  const std::vector<std::string> names = geometry_names(name.card);
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
  const std::vector<std::string> of_geometry = geometry_names(field.card);
  const bool is_geometry = std::count(of_geometry.begin(), of_geometry.end(), name) > 0;
  const bool is_product =
      is_one_of({"I12", "I21", "I31", "I32"}) || (field.card == "CONM1" && name.size() == 3 && name[1] != name[2]);
  if (is_geometry || is_product) return {.lower = k_none, .excludes_lower = true};
  if (name == "NU" && !is_factor) return {.lower = -1.0, .excludes_lower = true};
  const bool may_vanish =
      name == "NSM" || field.card == "PDAMP" || field.card == "CDAMP2" || field.card == "PVISC" || name.front() == 'B';
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
    const Subject subject = subject_parameter(parameter.parameter);
    require_of(!parameter.targets.empty(), subject, "it has no target, so it acts on nothing");
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
      require_of(is_new, subject, "target '{}' is already tied to parameter '{}'", target, previous->second);
      const CardField& found = model.fields[static_cast<std::size_t>(field)];
      require_of(!parameter.is_factor || found.value != 0.0, subject,
                 "a factor on '{}', whose nominal value is 0, acts on nothing", target);
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

}  // namespace mottle::model
