#include "mottle/study/jobs/targets.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/fem/assembly/field_energies.hpp"
#include "mottle/fem/assembly/static_reduction.hpp"
#include "mottle/formats/calculix/deck.hpp"
#include "mottle/formats/nastran/model.hpp"
#include "study/jobs/deck_targets.hpp"
#include "study/jobs/init_model.hpp"
#include "study/models/nastran/field_units.hpp"

namespace mottle::study {
namespace {

/// Replaces the columns of modes of one frequency by their mean.
void average_repeated(const Eigen::VectorXd& frequencies, Eigen::RowVectorXd& values) {
  constexpr double k_equal = 1e-6;  // relative; closer modes are mixed by the slightest change of the model
  for (Eigen::Index first = 0, next = 1; first < values.size(); first = next++) {
    while (next < values.size() && frequencies(next) - frequencies(next - 1) <= k_equal * frequencies(next)) ++next;
    values.segment(first, next - first).setConstant(values.segment(first, next - first).mean());
  }
}

/// The values of the modes that are no rigid-body motions, nan of those.
Eigen::RowVectorXd of_elastic(const SolvedDeck& solved, const Eigen::RowVectorXd& values) {
  const Eigen::RowVectorXd frequencies = solved.frequencies.transpose();
  return (frequencies.array() == 0.0).select(std::numeric_limits<double>::quiet_NaN(), values.array());
}

Target target_of(const SolvedDeck& solved, const FieldEnergies& energies, Eigen::Index index, const UnitNames& units) {
  const CardField& field = solved.structure->model().fields[static_cast<std::size_t>(index)];
  Target target{.name = fmt::format("{}:{}:{}", field.card, field.id, field.name),
                .unit = field_unit(field.card, field.name, units),
                .value = field.value,
                .elements = energies.elements(index),
                .strain = of_elastic(solved, energies.strain.row(index).cwiseQuotient(energies.total_strain)),
                .kinetic = energies.kinetic.row(index).cwiseQuotient(energies.total_kinetic),
                .sensitivity = of_elastic(
                    solved, 0.5 * (energies.strain_derivative.row(index).cwiseQuotient(energies.total_strain) -
                                   energies.kinetic_derivative.row(index).cwiseQuotient(energies.total_kinetic)))};
  average_repeated(solved.frequencies, target.sensitivity);
  return target;
}

/// Energies of the modes; their strain derivatives hold what a static reduction (ASET, OMIT) adds as it follows K:
///   U' = D(phi) + (D(phi + lambda w) - D(phi - lambda w)) / 2,   D(u) = u' dK u / 2
FieldEnergies energies_of(const SolvedDeck& solved) {
  const FiniteElementModel& model = solved.structure->model();
  const AssembledModel& assembled = solved.structure->assembled();
  const Eigen::MatrixXd& shapes = solved.modes.vectors;
  FieldEnergies energies = field_energies(model, assembled.expansion * shapes);
  if (!has_omitted_mass(assembled.mass, assembled.is_omitted)) return energies;
  const Eigen::VectorXd none;
  const Eigen::MatrixXd followers =
      static_followers(assembled.stiffness.at(none), assembled.mass.at(none), assembled.is_omitted, shapes) *
      solved.modes.values.asDiagonal();
  energies.strain_derivative +=
      0.5 * (field_energies(model, assembled.expansion * (shapes + followers)).strain_derivative -
             field_energies(model, assembled.expansion * (shapes - followers)).strain_derivative);
  return energies;
}

/// Whether a change of the number would be seen in the modes at all.
bool changes_modes(const Target& target) {
  constexpr double k_nothing = 1e-9;  // % per %: rounding of the sums over elements
  return target.largest_sensitivity() > k_nothing || target.kinetic.maxCoeff() > k_nothing;
}

}  // namespace

double Target::largest_sensitivity() const {
  double largest = 0.0;
  for (const double one : sensitivity) largest = std::max(largest, std::isnan(one) ? 0.0 : std::abs(one));
  return largest;
}

TargetsOutcome targets_of(const SolvedDeck& solved, const TargetsSettings& settings) {
  const FiniteElementModel& model = solved.structure->model();
  const FieldEnergies energies = energies_of(solved);
  TargetsOutcome outcome{.settings = settings, .frequencies = solved.frequencies, .notes = solved.notes};
  const UnitNames units = unit_names(settings.units);
  for (Eigen::Index index = 0; index < energies.elements.size(); ++index) {
    const CardField& field = model.fields[static_cast<std::size_t>(index)];
    Target target = target_of(solved, energies, index, units);
    const bool is_wanted =
        settings.lists_all || (is_design_number(field) && field.value != 0.0 && changes_modes(target));
    if (is_wanted) {
      outcome.targets.push_back(std::move(target));
    } else {
      ++outcome.left_out;
    }
  }
  std::ranges::stable_sort(outcome.targets, [](const Target& a, const Target& b) {
    return a.largest_sensitivity() > b.largest_sensitivity();
  });
  return outcome;
}

namespace {

constexpr int k_modes_of_calculix = 10;  // where none are asked for

/// Of a CalculiX deck, whose elements are not known here: no energies. Thicknesses may make each solution a run of
/// CalculiX and are listed then only where all numbers are asked for.
TargetsOutcome targets_of_calculix(const TargetsSettings& settings) {
  require(!settings.subcase && settings.ignore_cards.empty(),
          "{}: subcases and cards to leave out are those of Nastran decks; this is one of CalculiX",
          settings.model.string());
  InitOutcome draft{.settings = {.model = settings.model,
                                 .study = settings.model.parent_path() / "study.toml",
                                 .units = settings.units,
                                 .cache = settings.cache},
                    .kind = "calculix"};
  const std::vector<std::string> listed = list_calculix_targets(read_calculix_deck(settings.model));
  if (settings.lists_all) draft.settings.targets = listed;
  InitModel solved = solve_for_proposal(draft, settings.modes > 0 ? settings.modes : k_modes_of_calculix);
  const auto left_out = static_cast<int>(listed.size() - solved.targets.size());
  return {.settings = settings,
          .frequencies = std::move(solved.frequencies),
          .targets = std::move(solved.targets),
          .left_out = left_out,
          .notes = std::move(solved.notes)};
}

}  // namespace

TargetsOutcome find_targets(const TargetsSettings& settings) {
  if (model_kind_of(settings.model) == "calculix") return targets_of_calculix(settings);
  return targets_of(solve_deck(settings.model, {settings.ignore_cards, settings.subcase}, settings.modes), settings);
}

}  // namespace mottle::study
