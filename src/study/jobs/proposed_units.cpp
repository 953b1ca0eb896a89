#include "study/jobs/proposed_units.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "mottle/model/units.hpp"
#include "mottle/stats/moments/robust.hpp"

namespace mottle::study {
namespace {

/// A metal's modulus and density in each system.
struct Usual {
  const char* units;
  double modulus, density;
};
constexpr Usual k_usual[] = {
    {"SI", 7e10, 2.7e3}, {"mm-t-s", 7e4, 2.7e-9}, {"mm-kg-ms", 70.0, 2.7e-6}, {"in-lbf-s", 1e7, 2.5e-4}};

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
  return propose_units(moduli, densities);
}

ProposedUnits propose_units(const std::vector<double>& moduli, const std::vector<double>& densities) {
  const auto median_of = [](const std::vector<double>& values) {
    return median(Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  };
  const double modulus = median_of(moduli);
  const double density = median_of(densities);
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
