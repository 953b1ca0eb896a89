#include "mottle/model/units.hpp"

namespace mottle::model {

UnitNames unit_names(const std::string& units) {
  if (units == "mm-t-s")
    return {"N/mm", "t", "N s/mm", "Hz", "1/sqrt(t)", "mm", "MPa", "t/mm^3", "(rad/s)^2", "N mm/rad", "N mm s/rad"};
  if (units == "mm-kg-ms")
    return {"kN/mm", "kg",      "kN ms/mm",   "kHz",       "1/sqrt(kg)",  "mm",
            "GPa",   "kg/mm^3", "(rad/ms)^2", "kN mm/rad", "kN mm ms/rad"};
  if (units == "in-lbf-s") {
    return {"lbf/in", "lbf s^2/in",   "lbf s/in",  "Hz",         "1/sqrt(lbf s^2/in)", "in",
            "psi",    "lbf s^2/in^4", "(rad/s)^2", "lbf in/rad", "lbf in s/rad"};
  }
  return {};
}

UnitSizes unit_sizes(const std::string& units) {
  constexpr double k_inch = 0.0254;
  constexpr double k_pound_force = 4.4482216152605;
  if (units == "mm-t-s") return {1e-3, 1e3, 1.0};
  if (units == "mm-kg-ms") return {1e-3, 1.0, 1e3};
  if (units == "in-lbf-s") return {k_inch, k_pound_force / k_inch, 1.0};
  return {};
}

}  // namespace mottle::model
