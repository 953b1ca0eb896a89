#include "study/models/nastran/field_units.hpp"

#include <fmt/format.h>

#include <set>

namespace mottle::study {

std::string field_unit(const std::string& card, const std::string& field, const UnitNames& units) {
  const std::string name = field.substr(0, field.find('('));  // "A(B)" at a station of a beam
  static const std::set<std::string> k_inertias = {"I1", "I2", "I12", "J"};
  static const std::set<std::string> k_springs = {"PELAS", "CELAS2", "CELAS4", "PBUSH"};
  if (card.starts_with("MAT")) return name.starts_with("NU") ? "-" : name == "RHO" ? units.density : units.pressure;
  if (name.starts_with("THETA")) return "deg";
  if (k_springs.contains(card)) {
    const bool is_rotation = name.size() == 2 && name[1] > '3';
    if (name.front() == 'B') return is_rotation ? units.rotational_damping : units.damping;
    return is_rotation ? units.rotational_stiffness : units.stiffness;
  }
  if (card == "PGAP") return units.stiffness;
  if (card == "PVISC") return name == "CR" ? units.rotational_damping : units.damping;
  if (card == "PDAMP" || card == "CDAMP2" || card == "CDAMP4") return units.damping;
  if (name == "M" || card == "CONM1") return units.mass;
  if (card == "CONM2" && name.front() == 'I') return fmt::format("{} {}^2", units.mass, units.length);
  if (k_inertias.contains(name)) return fmt::format("{}^4", units.length);
  if (name == "A") return fmt::format("{}^2", units.length);
  if (name == "NSM")
    return fmt::format("{}/{}{}", units.mass, units.length,
                       card == "PSHELL" || card == "PSHEAR" || card.starts_with("PCOMP") ? "^2" : "");
  return units.length;
}

}  // namespace mottle::study
