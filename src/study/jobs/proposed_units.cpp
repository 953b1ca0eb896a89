#include "study/jobs/proposed_units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "mottle/model/units.hpp"

namespace mottle::study {
namespace {

/// A metal's modulus and density in each system.
struct Usual {
  const char* units;
  double modulus, density;
};
constexpr Usual k_usual[] = {
    {"SI", 7e10, 2.7e3}, {"mm-t-s", 7e4, 2.7e-9}, {"mm-kg-ms", 70.0, 2.7e-6}, {"in-lbf-s", 1e7, 2.5e-4}};

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::ranges::sort(values);
  return values[values.size() / 2];
}

double distance(double value, double usual) {
  return std::isnan(value) ? 0.0 : std::abs(std::log(value / usual));
}

}  // namespace

ProposedUnits propose_units(const FiniteElementModel& model) {
  std::vector<double> moduli;
  std::vector<double> densities;
  for (const CardField& field : model.fields) {
    if (!field.card.starts_with("MAT") || field.value <= 0.0) continue;
    if (field.name == "E" || field.name == "E1") moduli.push_back(field.value);
    if (field.name == "RHO") densities.push_back(model.settings.mass_factor * field.value);
  }
  return propose_units(std::move(moduli), std::move(densities));
}

ProposedUnits propose_units(std::vector<double> moduli, std::vector<double> densities) {
  const double modulus = median(std::move(moduli));
  const double density = median(std::move(densities));
  if (std::isnan(modulus) && std::isnan(density)) return {"SI", "the deck has no material to guess from"};
  constexpr double k_far = 5.0;  // a metal or plastic is no further from its own system
  const auto from = [&](const Usual& usual) {
    return distance(modulus, usual.modulus) + distance(density, usual.density);
  };
  const auto nearest = std::ranges::min_element(k_usual, {}, from);
  const UnitNames names = unit_names(nearest->units);
  std::string reason;
  if (!std::isnan(modulus)) reason += fmt::format("E = {:.3g} {}", modulus, names.pressure);
  if (!std::isnan(density))
    reason += fmt::format("{}RHO = {:.3g} {}", reason.empty() ? "" : ", ", density, names.density);
  return {nearest->units,
          fmt::format(
              "GUESSED from {}; {}", reason,
              from(*nearest) > k_far ? "NO SYSTEM FITS these together, so units are not to be relied on" : "check it")};
}

}  // namespace mottle::study
