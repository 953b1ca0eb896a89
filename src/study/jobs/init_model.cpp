#include "study/jobs/init_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"
#include "mottle/dynamics/modes/mode_set.hpp"
#include "mottle/formats/calculix/deck.hpp"
#include "mottle/model/solvers/reduced_solver.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "mottle/study/models/model_source.hpp"
#include "study/jobs/deck_targets.hpp"
#include "study/jobs/proposed_units.hpp"
#include "study/jobs/repeated_modes.hpp"
#include "study/results/init_text.hpp"

namespace mottle::study {
namespace {

void propose_units_of(InitOutcome& outcome, const ProposedUnits& units) {
  if (outcome.settings.units) return;
  outcome.settings.units = units.units;
  outcome.units_reason = units.reason;
}

InitModel solve_nastran(InitOutcome& outcome, int modes) {
  InitSettings& settings = outcome.settings;
  const SolvedDeck solved =
      solve_deck(settings.model, {.ignore_cards = settings.ignore_cards}, modes, nullptr, k_modes_beyond);
  propose_units_of(outcome, propose_units(solved.structure->model()));
  TargetsOutcome targets = targets_of(solved, {.model = settings.model, .units = settings.units});
  return {std::move(targets.frequencies), std::move(targets.targets), solved.structure->mode_count()};
}

/// Numbers that follow a target in a deck: the first of them.
double value_of(const CalculixDeck& deck, const std::string& target) {
  return find_calculix_numbers(deck, target).front().value;
}

ProposedUnits units_of(const CalculixDeck& deck, const std::vector<std::string>& targets) {
  std::vector<double> moduli;
  std::vector<double> densities;
  for (const std::string& target : targets) {
    if (target.starts_with("*ELASTIC:")) moduli.push_back(value_of(deck, target));
    if (target.starts_with("*DENSITY:")) densities.push_back(value_of(deck, target));
  }
  return propose_units(moduli, densities);
}

/// Slopes of the modes of a group, of one frequency f0 but for the rounding of a solver's matrices, in ascending order:
/// the frequencies split into f0 + s_k h above and f0 - s_(m-k) h below, each time in ascending order.
Eigen::MatrixXd split_slopes(const ModeGroup& group, const Eigen::VectorXd& frequencies, const Eigen::MatrixXd& above,
                             const Eigen::MatrixXd& below, double step) {
  const auto [first, count] = group;
  const auto own = frequencies.segment(first, count);
  const Eigen::MatrixXd up = above.middleRows(first, count).colwise() - own;
  const Eigen::MatrixXd down = below.middleRows(first, count).colwise() - own;
  return (up - down.colwise().reverse()) / (2.0 * step);
}

/// Frequencies with each parameter a step above and below the deck's own values [mode x parameter].
struct Moved {
  Eigen::MatrixXd above, below;
};

Moved frequencies_about(const StructureModel& model, double step) {
  const Eigen::VectorXd& ones = model.reference_parameters();
  const Eigen::Index q = ones.size();
  Eigen::MatrixXd points = ones.transpose().replicate(2 * q, 1);
  points.topRows(q).diagonal().array() += step;
  points.bottomRows(q).diagonal().array() -= step;
  const Eigen::MatrixXd outputs = model.evaluate(points, {}).outputs;
  return {outputs.topRows(q).transpose(), outputs.bottomRows(q).transpose()};
}

/// The same in ascending order, whatever shape they have: those of one frequency have none of their own to be followed
/// by.
Moved ascending_frequencies_about(const StructureModel& model, Eigen::Index modes, double step) {
  const Eigen::VectorXd& ones = model.reference_parameters();
  Moved moved{Eigen::MatrixXd(modes, ones.size()), Eigen::MatrixXd(modes, ones.size())};
  const auto frequencies_at = [&](const Eigen::VectorXd& point) {
    const Eigen::VectorXd eigenvalues = model.solver().modes_at(point, static_cast<int>(modes)).eigenvalues.head(modes);
    return natural_frequencies_hz(eigenvalues.cwiseMax(0.0));
  };
  for (Eigen::Index j = 0; j < ones.size(); ++j) {
    const Eigen::VectorXd change = step * Eigen::VectorXd::Unit(ones.size(), j);
    moved.above.col(j) = frequencies_at(ones + change);
    moved.below.col(j) = frequencies_at(ones - change);
  }
  return moved;
}

constexpr double k_step = 1e-3;

/// A step with which no mode of the group passes its neighbours: these move by half of it at most, each its way.
double step_of(const ModeGroup& group, const Eigen::VectorXd& frequencies) {
  constexpr double k_fraction = 0.2;
  constexpr double k_least = 1e-7;
  const Eigen::Index next = group.first + group.count;
  double gap = k_step / k_fraction;
  if (group.first > 0) gap = std::min(gap, 1.0 - frequencies(group.first - 1) / frequencies(group.first));
  if (next < frequencies.size()) gap = std::min(gap, frequencies(next) / frequencies(next - 1) - 1.0);
  return std::clamp(k_fraction * gap, k_least, k_step);
}

/// d ln f / d ln p at the deck's own values, where every parameter is a factor; central differences where the model has
/// no derivative or modes have one frequency [mode x parameter].
Eigen::MatrixXd relative_sensitivities(const StructureModel& model, const Eigen::VectorXd& frequencies) {
  const bool has_derivatives = model.derivatives() != nullptr;
  const std::vector<ModeGroup> groups = modes_of_one_frequency(frequencies);
  const Eigen::Index q = model.reference_parameters().size();
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Constant(frequencies.size(), q, std::nan(""));
  if (has_derivatives) slopes = model.jacobian(model.reference_parameters());
  if (!slopes.allFinite()) {
    const Moved moved = frequencies_about(model, k_step);
    slopes = slopes.array().isFinite().select(slopes, (moved.above - moved.below) / (2.0 * k_step));
  }
  for (const ModeGroup& group : groups) {
    if (frequencies(group.first) == 0.0) continue;  // of rigid-body modes nothing is said
    // Runs of a solver are those that were made.
    const double step = has_derivatives ? step_of(group, frequencies) : k_step;
    const Moved moved =
        has_derivatives ? ascending_frequencies_about(model, frequencies.size(), step) : frequencies_about(model, step);
    slopes.middleRows(group.first, group.count) = split_slopes(group, frequencies, moved.above, moved.below, step);
  }
  const double none = std::numeric_limits<double>::quiet_NaN();
  const Eigen::VectorXd scales = (frequencies.array() > 0.0).select(frequencies.cwiseInverse(), none);
  return scales.asDiagonal() * slopes;
}

/// A study of the whole deck, every number a parameter.
Study study_of_all(const InitOutcome& outcome, const std::vector<std::string>& targets) {
  InitOutcome draft{.settings = outcome.settings, .kind = outcome.kind};
  draft.settings.tests.clear();
  draft.modes = {{.mode = 1}};
  for (std::size_t j = 0; j < targets.size(); ++j) {
    draft.parameters.push_back({.target = targets[j], .name = fmt::format("p{}", j + 1), .spread = 0.1});
  }
  return read_study_text(study_text_of(draft), outcome.settings.study);
}

/// Frequencies of the reference, 0 of what is a rigid motion within the rounding of a solver's matrices.
Eigen::VectorXd elastic_frequencies(const StructureModel& model, Eigen::Index modes) {
  constexpr double k_rigid = 1e-6;  // of the highest eigenvalue
  const Eigen::VectorXd eigenvalues = model.reference_modes().eigenvalues.head(modes);
  const Eigen::VectorXd frequencies = natural_frequencies_hz(eigenvalues.cwiseMax(0.0));
  return (eigenvalues.array() <= k_rigid * eigenvalues.maxCoeff()).select(0.0, frequencies);
}

struct CalculixParts {
  Study study;  ///< whose parameters are `targets`
  std::vector<std::string> targets;
  ModelParts parts;
};

CalculixParts make_parts(const InitOutcome& outcome, std::vector<std::string> targets) {
  Study study = study_of_all(outcome, targets);
  CalculixParts made{.study = std::move(study), .targets = std::move(targets), .parts = {}};
  std::vector<Distribution> priors;
  for (const StudyParameter& parameter : made.study.parameters.list) priors.emplace_back(parameter.distribution);
  made.parts = made.study.model->make(list_targets(made.study.parameters), JointDistribution(std::move(priors)),
                                      {.cache = outcome.settings.cache});
  return made;
}

/// Without thicknesses, unless they are wanted, where only these keep the matrices from being made once for all: a
/// study without them takes seconds, one with them a run for each sample.
CalculixParts make_separable_parts(const InitOutcome& outcome, const std::vector<std::string>& targets) {
  const auto is_thickness = [](const std::string& target) { return capitals(target).starts_with("*SHELL SECTION:"); };
  CalculixParts all = make_parts(outcome, targets);
  std::vector<std::string> others = targets;
  std::erase_if(others, is_thickness);
  const std::vector<std::string> wanted = outcome.settings.targets.value_or(std::vector<std::string>{});
  const bool may_leave_out =
      !others.empty() && others.size() < targets.size() && !std::ranges::any_of(wanted, is_thickness);
  if (all.parts.sparse || !may_leave_out) return all;
  CalculixParts without = make_parts(outcome, others);
  if (!without.parts.sparse) return all;
  std::vector<std::string> left_out = targets;
  std::erase_if(left_out, [&](const std::string& target) { return !is_thickness(target); });
  without.parts.notes.push_back(
      fmt::format("Thicknesses are left out: with them each sample is a run of CalculiX, without them its matrices are "
                  "made once. `mottle init --targets` and `mottle targets --all` take them: {}.",
                  join(left_out)));
  return without;
}

/// The modes asked for, or more where these cut a repeated frequency. Modes that nobody asked for may fail.
Eigen::Index modes_to_solve(const Solver& solver, Eigen::Index asked) {
  const Eigen::Index most = solver.structure().mode_count();
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(solver.structure().parameter_count());
  try {
    for (Eigen::Index beyond = k_modes_beyond;; beyond *= 4) {
      const Eigen::Index there = std::min(asked + beyond, most);
      const Eigen::VectorXd values = solver.modes_at(ones, static_cast<int>(there)).eigenvalues;
      const Eigen::VectorXd frequencies = natural_frequencies_hz(values.cwiseMax(0.0));
      const Eigen::Index whole = with_whole_group(asked, frequencies, modes_of_one_frequency(frequencies));
      if (whole < there || there == most) return whole;
    }
  } catch (const ModelFailure&) {
  } catch (const InvalidInput&) {
  }
  return asked;
}

InitModel solve_calculix(InitOutcome& outcome, int modes) {
  const InitSettings& settings = outcome.settings;
  const CalculixDeck deck = read_calculix_deck(settings.model);
  const std::vector<std::string> listed = list_calculix_targets(deck);
  require(!listed.empty(),
          "{}: has no number that a parameter could set; there are *ELASTIC, *DENSITY, *SPRING, *MASS and *SHELL "
          "SECTION, or {{{{name}}}} in place of any",
          settings.model.string());
  propose_units_of(outcome, units_of(deck, listed));
  auto [study, names, parts] = make_separable_parts(outcome, listed);
  if (!parts.solver) parts.solver = make_sparse_solver(std::move(parts.sparse), std::nullopt);
  InitModel solved;
  solved.mode_count = parts.solver->structure().mode_count();
  solved.notes = std::move(parts.notes);
  const Eigen::Index count = modes_to_solve(*parts.solver, std::min<Eigen::Index>(modes, solved.mode_count));
  OutputSelection outputs{.units = unit_names(*settings.units)};
  for (int mode = 1; mode <= count; ++mode) outputs.frequencies.push_back(mode);
  const StructureModel model(std::move(parts.solver), outputs, Eigen::VectorXd::Ones(parts.reference.size()));
  solved.frequencies = elastic_frequencies(model, count);
  const Eigen::MatrixXd sensitivities = relative_sensitivities(model, solved.frequencies);
  for (std::size_t j = 0; j < names.size(); ++j) {
    solved.targets.push_back({.name = names[j],
                              .unit = study.model->target_unit(names[j], outputs.units),
                              .value = value_of(deck, names[j]),
                              .sensitivity = sensitivities.col(static_cast<Eigen::Index>(j)).transpose()});
  }
  constexpr double k_nothing = 1e-6;  // % per %: rounding of the matrices as they are written
  std::erase_if(solved.targets, [](const Target& target) { return target.largest_sensitivity() < k_nothing; });
  std::ranges::stable_sort(solved.targets, [](const Target& a, const Target& b) {
    return a.largest_sensitivity() > b.largest_sensitivity();
  });
  return solved;
}

}  // namespace

std::string model_kind_of(const std::filesystem::path& model) {
  const std::string extension = capitals(model.extension().string());
  const std::vector<std::string> nastran{".BDF", ".DAT", ".NAS", ".BLK", ".DECK"};
  if (std::ranges::count(nastran, extension) > 0) return "nastran";
  if (read_file(model).find("{{") != std::string::npos) return "command";
  return extension == ".INP" ? "calculix" : "nastran";
}

InitModel solve_for_proposal(InitOutcome& outcome, int modes) {
  InitModel solved = outcome.kind == "calculix" ? solve_calculix(outcome, modes) : solve_nastran(outcome, modes);
  require(!solved.targets.empty(), "{}: no number of the deck changes its lowest {} modes",
          outcome.settings.model.string(), modes);
  return solved;
}

}  // namespace mottle::study
