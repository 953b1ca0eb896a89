#include "study/input/unit_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace mottle {
namespace {

/// Unit of a card's number, from what its name means on that card.
std::string field_unit(const std::string& card, const std::string& name, const UnitNames& units) {
  static const std::set<std::string> k_inertias = {"I1", "I2", "I12", "J"};
  static const std::set<std::string> k_springs = {"PELAS", "CELAS2", "CELAS4", "PBUSH"};
  if (card == "MAT1") return name == "NU" ? "-" : name == "RHO" ? units.density : units.pressure;
  if (k_springs.contains(card)) {
    const bool is_rotation = name.size() == 2 && name[1] > '3';
    const char* unit = name.front() == 'B' ? units.damping : units.stiffness;
    return is_rotation ? fmt::format("{} {}^2/rad", unit, units.length) : unit;
  }
  if (card == "PDAMP" || card == "CDAMP2" || card == "CDAMP4") return units.damping;
  if (name == "M" || card == "CONM1") return units.mass;
  if (card == "CONM2" && name.front() == 'I') return fmt::format("{} {}^2", units.mass, units.length);
  if (k_inertias.contains(name)) return fmt::format("{}^4", units.length);
  if (name == "A") return fmt::format("{}^2", units.length);
  if (name == "NSM") return fmt::format("{}/{}{}", units.mass, units.length, card == "PSHELL" ? "^2" : "");
  return units.length;
}

std::string calculix_unit(const std::string& target, const UnitNames& units) {
  static const std::map<std::string, const char* UnitNames::*> k_units = {{"*ELASTIC", &UnitNames::pressure},
                                                                          {"*DENSITY", &UnitNames::density},
                                                                          {"*SPRING", &UnitNames::stiffness},
                                                                          {"*MASS", &UnitNames::mass},
                                                                          {"*SHELL SECTION", &UnitNames::length}};
  std::string keyword = target.substr(0, target.find(':'));
  std::transform(keyword.begin(), keyword.end(), keyword.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  const auto found = k_units.find(keyword);
  return found == k_units.end() ? "" : units.*(found->second);
}

}  // namespace

UnitNames unit_names(const std::string& units) {
  if (units == "mm-t-s") return {"N/mm", "t", "N s/mm", "Hz", "1/sqrt(t)", "mm", "MPa", "t/mm^3"};
  if (units == "mm-kg-ms") return {"kN/mm", "kg", "kN ms/mm", "kHz", "1/sqrt(kg)", "mm", "GPa", "kg/mm^3"};
  if (units == "in-lbf-s") {
    return {"lbf/in", "lbf s^2/in", "lbf s/in", "Hz", "1/sqrt(lbf s^2/in)", "in", "psi", "lbf s^2/in^4"};
  }
  return {"N/m", "kg", "N s/m", "Hz", "1/sqrt(kg)", "m", "Pa", "kg/m^3"};
}

UnitSizes unit_sizes(const std::string& units) {
  constexpr double k_inch = 0.0254;
  constexpr double k_pound_force = 4.4482216152605;
  if (units == "mm-t-s") return {1e-3, 1e3, 1.0};
  if (units == "mm-kg-ms") return {1e-3, 1.0, 1e3};
  if (units == "in-lbf-s") return {k_inch, k_pound_force / k_inch, 1.0};
  return {};
}

std::string target_unit(const std::string& target, const UnitNames& units) {
  if (target.starts_with("mass:")) return units.mass;
  if (target.starts_with("damper:")) return units.damping;
  if (target.starts_with("spring:")) return units.stiffness;
  if (target.starts_with("K:") || target.starts_with("M:")) return "";  // what a user's matrices are scaled by
  std::string card = target.substr(0, target.find(':'));
  if (target.starts_with("{{")) return "";
  if (target.starts_with('*')) return calculix_unit(target, units);
  std::string name = target.substr(target.rfind(':') + 1);
  for (std::string* text : {&card, &name}) {
    std::transform(text->begin(), text->end(), text->begin(),
                   [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  }
  return field_unit(card, name, units);
}

}  // namespace mottle
