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
#include "study/jobs/proposed_units.hpp"
#include "study/jobs/repeated_modes.hpp"
#include "study/models/nastran/field_units.hpp"

namespace mottle::study {
namespace {

/// The values of the modes that are no rigid-body motions, nan of those.
Eigen::RowVectorXd of_elastic(const SolvedDeck& solved, const Eigen::RowVectorXd& values) {
  const Eigen::RowVectorXd frequencies = solved.frequencies.transpose();
  return (frequencies.array() == 0.0).select(std::numeric_limits<double>::quiet_NaN(), values.array());
}

/// Energies of the modes and, behind them, of the sums of every two that have one frequency.
struct ModeEnergies {
  std::vector<ModeGroup> groups;  ///< of one frequency
  FieldEnergies fields;           ///< [field x mode, then pair]
};

/// PARAM,WTMASS multiplies what is a mass on the cards.
std::string unit_of(const CardField& field, const FiniteElementModel& model, const UnitNames& units) {
  const std::string unit = field_unit(field.card, field.name, units);
  const bool is_mass = field.name == "RHO" || field.name == "M" || field.name == "NSM" || field.card == "CONM1" ||
                       (field.card == "CONM2" && field.name.starts_with("I"));
  return is_mass && model.settings.mass_factor != 1.0 ? unit + " / WTMASS" : unit;
}

Target target_of(const SolvedDeck& solved, const ModeEnergies& energies, Eigen::Index index, const UnitNames& units) {
  const CardField& field = solved.structure->model().fields[static_cast<std::size_t>(index)];
  const FieldEnergies& of = energies.fields;
  const auto principal = [&](const Eigen::RowVectorXd& values) {
    return principal_values(values, solved.frequencies.size(), energies.groups);
  };
  return {.name = fmt::format("{}:{}:{}", field.card, field.id, field.name),
          .unit = unit_of(field, solved.structure->model(), units),
          .value = field.value,
          .elements = of.elements(index),
          .strain = of_elastic(solved, principal(of.strain.row(index).cwiseQuotient(of.total_strain))),
          .kinetic = principal(of.kinetic.row(index).cwiseQuotient(of.total_kinetic)),
          .sensitivity =
              of_elastic(solved, principal(0.5 * (of.strain_derivative.row(index).cwiseQuotient(of.total_strain) -
                                                  of.kinetic_derivative.row(index).cwiseQuotient(of.total_kinetic))))};
}

/// Gives the pairs the energies of the whole model that their group's modes have: mass-normalised, all the same.
void take_totals_of_groups(const std::vector<ModeGroup>& groups, Eigen::Index modes, Eigen::RowVectorXd& totals) {
  Eigen::Index pair = modes;
  for (const auto& [first, count] : groups) {
    const double mean = totals.segment(first, count).mean();
    totals.segment(first, count).setConstant(mean);
    const Eigen::Index pairs = count * (count - 1) / 2;
    totals.segment(pair, pairs).setConstant(mean);
    pair += pairs;
  }
}

/// Energies of the modes; their strain derivatives hold what a static reduction (ASET, OMIT) adds as it follows K:
///   U' = D(phi) + (D(phi + lambda w) - D(phi - lambda w)) / 2,   D(u) = u' dK u / 2
ModeEnergies energies_of(const SolvedDeck& solved) {
  const FiniteElementModel& model = solved.structure->model();
  const AssembledModel& assembled = solved.structure->assembled();
  const Eigen::Index modes = solved.frequencies.size();
  ModeEnergies found{.groups = modes_of_one_frequency(solved.frequencies), .fields = {}};
  const auto with_pairs = [&](const Eigen::MatrixXd& of_modes) {
    const Eigen::MatrixXd pairs = sums_of_pairs(of_modes, found.groups);
    Eigen::MatrixXd both(of_modes.rows(), modes + pairs.cols());
    both << of_modes, pairs;
    return both;
  };
  const Eigen::MatrixXd shapes = with_pairs(solved.modes.vectors);
  FieldEnergies& energies = found.fields = field_energies(model, assembled.expansion * shapes);
  if (has_omitted_mass(assembled.mass, assembled.is_omitted)) {
    const Eigen::VectorXd none;
    const Eigen::MatrixXd followers = with_pairs(static_followers(assembled.stiffness.at(none), assembled.mass.at(none),
                                                                  assembled.is_omitted, solved.modes.vectors) *
                                                 solved.modes.values.asDiagonal());
    energies.strain_derivative +=
        0.5 * (field_energies(model, assembled.expansion * (shapes + followers)).strain_derivative -
               field_energies(model, assembled.expansion * (shapes - followers)).strain_derivative);
  }
  take_totals_of_groups(found.groups, modes, energies.total_strain);
  take_totals_of_groups(found.groups, modes, energies.total_kinetic);
  return found;
}

/// Whether a repeated frequency among the modes asked for may go on beyond those that were solved.
bool is_group_cut(const std::vector<ModeGroup>& groups, const SolvedDeck& solved) {
  if (groups.empty() || solved.frequencies.size() < solved.asked + k_modes_beyond) return false;
  const auto [first, count] = groups.back();
  return first < solved.asked && first + count == solved.frequencies.size();
}

std::string units_note(const std::string& units, const std::string& reason) {
  return fmt::format("units: {} ({}); --units names others", units, reason);
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
  const ModeEnergies energies = energies_of(solved);
  TargetsOutcome outcome{.settings = settings, .frequencies = solved.frequencies, .notes = solved.notes};
  if (is_group_cut(energies.groups, solved)) {
    outcome.notes.emplace_back(
        "The last modes share their frequency with modes beyond, of which not all were solved: "
        "what is said of them depends on how many. Ask for more with --modes.");
  }
  if (!settings.units) {
    const ProposedUnits guess = propose_units(model);
    outcome.settings.units = guess.units;
    outcome.notes.push_back(units_note(guess.units, guess.reason));
  }
  const UnitNames units = unit_names(*outcome.settings.units);
  const Eigen::Index shown = with_whole_group(solved.asked, solved.frequencies, energies.groups);
  for (Eigen::Index index = 0; index < energies.fields.elements.size(); ++index) {
    const CardField& field = model.fields[static_cast<std::size_t>(index)];
    Target target = target_of(solved, energies, index, units);
    for (Eigen::RowVectorXd* values : {&target.strain, &target.kinetic, &target.sensitivity}) {
      values->conservativeResize(shown);
    }
    const bool is_wanted =
        settings.lists_all || (is_design_number(field) && field.value != 0.0 && changes_modes(target));
    if (is_wanted) {
      outcome.targets.push_back(std::move(target));
    } else {
      ++outcome.left_out;
    }
  }
  outcome.frequencies.conservativeResize(shown);
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
  TargetsOutcome outcome{.settings = settings,
                         .frequencies = std::move(solved.frequencies),
                         .targets = std::move(solved.targets),
                         .left_out = static_cast<int>(listed.size() - solved.targets.size()),
                         .notes = std::move(solved.notes)};
  if (!settings.units) outcome.notes.push_back(units_note(*draft.settings.units, draft.units_reason));
  outcome.settings.units = draft.settings.units;
  return outcome;
}

}  // namespace

TargetsOutcome find_targets(const TargetsSettings& settings) {
  if (model_kind_of(settings.model) == "calculix") return targets_of_calculix(settings);
  return targets_of(solve_deck(settings.model, {settings.ignore_cards, settings.subcase}, settings.modes, settings.stop,
                               k_modes_beyond),
                    settings);
}

}  // namespace mottle::study
