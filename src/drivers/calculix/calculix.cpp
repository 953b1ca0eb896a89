#include "mottle/drivers/calculix/calculix.hpp"

#include <algorithm>
#include <map>

#include "drivers/calculix/calculix_program.hpp"
#include "drivers/calculix/own_modes.hpp"
#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"
#include "mottle/drivers/calculix/separable_fit.hpp"

namespace mottle::drivers {
namespace {

/// What a parameter sets.
struct Setting {
  std::vector<CalculixNumber> numbers;
  bool is_factor = false;
};

std::vector<Setting> find_settings(const CalculixDeck& deck, const std::vector<ParameterTargets>& parameters) {
  std::vector<Setting> settings;
  std::map<std::pair<std::size_t, std::size_t>, std::string> owners;
  for (const ParameterTargets& parameter : parameters) {
    Setting& setting = settings.emplace_back();
    setting.is_factor = parameter.is_factor;
    const Subject subject = subject_parameter(parameter.parameter);
    for (const std::string& target : parameter.targets) {
      std::vector<CalculixNumber> numbers;
      try {
        numbers = find_calculix_numbers(deck, target);
      } catch (const FormatError&) {
        throw;
      } catch (const InvalidInput& error) {
        throw SubjectError(subject, fmt::format("it acts on nothing: {}", error.what()));
      }
      const bool is_zero =
          std::ranges::all_of(numbers, [](const CalculixNumber& number) { return number.value == 0.0; });
      require_of(!parameter.is_factor || !is_zero, subject,
                 "a factor on '{}', whose nominal value is 0, acts on nothing", target);
      for (const CalculixNumber& number : numbers) {
        require_of(parameter.is_factor || number.temperatures == 1, subject,
                   "'{}' ({}) has a value at each of {} temperatures; relative = true multiplies all of them, "
                   "{{{{name}}}} in the deck in place of one of them sets it alone",
                   target, deck.where(number.line), number.temperatures);
        const auto [owner, is_new] = owners.emplace(std::pair{number.line, number.begin}, parameter.parameter);
        require_of(is_new, subject, "target '{}' ({}) is already tied to parameter '{}'", target,
                   deck.where(number.line), owner->second);
        require_of(!parameter.is_factor || !number.is_placeholder, subject,
                   "'{}' has no value in the deck that a factor could multiply", target);
        setting.numbers.push_back(number);
      }
    }
    require_of(!setting.numbers.empty(), subject, "it has no target, so it acts on nothing");
  }
  return settings;
}

double nominal_of(const Setting& setting, double fallback) {
  if (setting.is_factor) return 1.0;
  const double first = setting.numbers.front().value;
  const bool is_one = std::all_of(setting.numbers.begin(), setting.numbers.end(),
                                  [&](const CalculixNumber& number) { return number.value == first; });
  return is_one ? first : fallback;
}

std::vector<CalculixChange> changes_at(const std::vector<Setting>& settings, const Eigen::VectorXd& values) {
  std::vector<CalculixChange> changes;
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const double x = values(static_cast<Eigen::Index>(i));
    for (const CalculixNumber& number : settings[i].numbers) {
      changes.push_back({number, settings[i].is_factor ? x * number.value : x});
    }
  }
  return changes;
}

/// How many modes are compared: CalculiX's solver works with four times as many vectors, of which it must have fewer
/// than equations.
int modes_of(const MatrixModel& model) {
  return static_cast<int>(std::clamp<Eigen::Index>(model.pencil.stiffness.pattern.rows() / 5, 1, 10));
}

/// Throws NotSeparable where the matrices do not give the modes that the solver has itself; the end of the note if they
/// do.
std::string compare_modes(const MatrixModel& model, CalculixProgram& solver, const std::string& text) {
  const Eigen::VectorXd own = solver.eigenvalues(text);
  const OwnModesComparison comparison = compare_with_own_modes(model.pencil, model.reference, own);
  if (!comparison.failure.empty()) throw NotSeparable(comparison.failure);
  if (own.size() == 0) return "; CalculiX found no modes itself to compare with";
  if (comparison.compared == 0) {
    return fmt::format(
        "; the {} modes that CalculiX finds itself are rigid-body motions, there is nothing to compare with",
        own.size());
  }
  return fmt::format("; their {} lowest frequencies are CalculiX's own to {:.1e}", own.size(), comparison.error);
}

}  // namespace

MatrixModel calculix_model(const CalculixDeck& deck, const std::vector<ParameterTargets>& parameters,
                           const Eigen::VectorXd& fallback, const CalculixSettings& settings) {
  const std::vector<Setting> moved = find_settings(deck, parameters);
  if (const std::string reason = needs_earlier_steps(deck); !reason.empty()) throw NotSeparable(reason);
  for (const ParameterTargets& parameter : parameters) {
    for (const std::string& target : parameter.targets) {
      if (!calculix_field(target).starts_with("NU")) continue;
      throw NotSeparable(
          fmt::format("parameter '{}': '{}' enters the matrices by no powers", parameter.parameter, target));
    }
  }
  MatrixModel model;
  model.reference.resize(fallback.size());
  model.limits.resize(parameters.size());
  std::vector<FitAxis> axes;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const auto p = static_cast<Eigen::Index>(i);
    model.reference(p) = nominal_of(moved[i], fallback(p));
    require_of(model.reference(p) != 0.0, subject_parameter(parameters[i].parameter),
               "its nominal value is 0; CalculiX cannot be run there");
    const auto& targets = parameters[i].targets;
    axes.push_back({parameters[i].parameter, model.reference(p),
                    std::any_of(targets.begin(), targets.end(),
                                [](const std::string& target) { return calculix_field(target) == "T"; })});
  }
  CalculixProgram solver(settings, deck);
  SeparableFit fit = fit_separable(axes, [&](const Eigen::VectorXd& values) {
    return solver.matrices(matrix_storage_deck(deck, changes_at(moved, values)));
  });
  model.pencil = std::move(fit.pencil);
  model.notes.push_back(fmt::format(
      "CalculiX: matrices from {} decks ({} runs, {} from the cache); for a deck that was not used for the fit "
      "they agree to {:.1e} of their diagonal",
      fit.runs, solver.runs(), solver.reused(), fit.error));
  model.notes.back() +=
      compare_modes(model, solver, modes_deck(deck, changes_at(moved, model.reference), modes_of(model)));
  return model;
}

SolverCommand calculix_command(const CalculixDeck& deck, const std::vector<ParameterTargets>& parameters,
                               const CalculixSettings& settings) {
  const std::vector<Setting> moved = find_settings(deck, parameters);
  std::vector<CalculixReplacement> replacements;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    for (const CalculixNumber& number : moved[i].numbers) {
      const std::string factor = moved[i].is_factor ? fmt::format("*{}", number_text(number.value)) : "";
      replacements.push_back({number, fmt::format("{{{{{}{}:%20.13e}}}}", parameters[i].parameter, factor)});
    }
  }
  CalculixProgram(settings, deck).require_known_cards(deck_without_steps(deck));
  SolverCommand command;
  command.templates = {{deck.files.front(), "model.inp", deck_with_replacements(deck, replacements)}};
  command.command.arguments = {settings.program, "model"};
  command.environment = one_thread();
  command.timeout = settings.timeout;
  command.parallel = settings.parallel;
  command.frequencies = {.file = "model.dat", .format = FrequencyRule::Format::calculix};
  if (writes_displacements(deck)) command.shapes = {.file = "model.frd", .format = ShapeRule::Format::calculix};
  return command;
}

}  // namespace mottle::drivers
