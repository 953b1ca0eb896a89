#include "study/tests/unit_errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "mottle/core/text.hpp"
#include "mottle/dynamics/modes/mode_set.hpp"
#include "study/tests/tested_frequencies.hpp"

namespace mottle::study {
namespace {

constexpr double k_two_pi = 2.0 * std::numbers::pi;
constexpr std::array k_unit_factors = {
    UnitFactor{k_two_pi, "2 pi", "are the tests in rad/s? Divide them by 2 pi."},
    UnitFactor{1.0 / k_two_pi, "1/(2 pi)",
               "is it the model that gives rad/s, or were the tests divided by 2 pi twice?"},
    UnitFactor{60.0, "60", "are the tests in 1/min (rpm)? Divide them by 60."},
    UnitFactor{1.0 / 60.0, "1/60", "is it the model that gives 1/min, or were the tests divided by 60 twice?"},
    UnitFactor{1000.0, "1000",
               "are the tests in mHz, or the model's moduli in MPa where its lengths and masses want Pa?"},
    UnitFactor{1.0 / 1000.0, "1/1000",
               "are the tests in kHz, or the model's moduli in Pa where its lengths and masses want MPa?"}};

/// What parameters that are still to be updated may move a frequency by, beside the unit.
constexpr double k_near = 1.5;

/// Natural frequencies of modes, by number; empty where the model gives none there.
Eigen::VectorXd frequencies_at(const StructureModel& model, const std::vector<int>& modes_by_number,
                               const Eigen::VectorXd& parameters) {
  try {
    const ModeSet modes = model.solver().modes_at(parameters, model.highest_mode());
    if (modes.eigenvalues.size() < model.highest_mode() || !modes.eigenvalues.allFinite()) return {};
    const double scale = modes.eigenvalues.cwiseAbs().maxCoeff();
    Eigen::VectorXd frequencies(static_cast<Eigen::Index>(modes_by_number.size()));
    for (std::size_t k = 0; k < modes_by_number.size(); ++k) {
      frequencies(static_cast<Eigen::Index>(k)) =
          natural_frequency_hz(modes.eigenvalues(modes_by_number[k] - 1), scale);
    }
    return frequencies;
  } catch (const InvalidInput&) {
  } catch (const SystemFailure&) {
  }
  return {};
}

/// Means of the tested frequencies, nan where never measured; a factor on all changes no ratio between them.
Eigen::VectorXd means_of(const TestedFrequencies& frequencies) {
  Eigen::VectorXd means(frequencies.count());
  for (Eigen::Index k = 0; k < means.size(); ++k) {
    const Eigen::ArrayXd column = frequencies.values.col(k).array();
    means(k) = column.isNaN().select(0.0, column).sum() / static_cast<double>((!column.isNaN()).count());
  }
  return means;
}

/// ln of tested over computed, of the frequencies that are positive in both.
std::vector<double> log_ratios(const Eigen::VectorXd& tested, const Eigen::VectorXd& computed) {
  std::vector<double> ratios;
  for (Eigen::Index k = 0; k < computed.size(); ++k) {
    if (tested(k) > 0.0 && computed(k) > 0.0) ratios.push_back(std::log(tested(k) / computed(k)));
  }
  return ratios;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Quantile of a parameter's prior within what is physically possible.
double possible_quantile(const ParameterSpace& space, Eigen::Index i, double probability) {
  const auto index = static_cast<std::size_t>(i);
  const Distribution& prior = space.prior().marginals()[index];
  const double impossible = prior.cdf(space.parameters()[index].limit.lower);
  return prior.quantile(impossible + probability * (1.0 - impossible));
}

/// The softest (stiffest) model that the prior of the first `parameters` allows (candidates of a diagnosis follow
/// them); empty where it gives no frequencies.
Eigen::VectorXd extreme_frequencies(const StudyModel& made, Eigen::Index parameters, const std::vector<int>& modes,
                                    const Eigen::VectorXd& tested, bool is_soft) {
  constexpr double k_tail = 0.001;
  const Eigen::VectorXd mean = made.space->prior().mean();
  const double middle = mean_of(log_ratios(tested, frequencies_at(*made.model, modes, mean)));
  Eigen::VectorXd corner = mean;
  for (Eigen::Index i = 0; i < parameters; ++i) {
    Eigen::VectorXd upper = mean;
    upper(i) = possible_quantile(*made.space, i, 1.0 - k_tail);
    const std::vector<double> ratios = log_ratios(tested, frequencies_at(*made.model, modes, upper));
    if (ratios.empty()) return {};
    const bool is_softened = mean_of(ratios) > middle;
    corner(i) = is_softened == is_soft ? upper(i) : possible_quantile(*made.space, i, k_tail);
  }
  return frequencies_at(*made.model, modes, corner);
}

/// "f1: 1 against 0.204, f2: ..." of the first few.
std::string listed(const StructureModel& model, const std::vector<int>& modes, const Eigen::VectorXd& tested,
                   const Eigen::VectorXd& computed) {
  constexpr Eigen::Index k_listed = 3;
  std::vector<std::string> parts;
  for (Eigen::Index k = 0; k < std::min(k_listed, computed.size()); ++k) {
    parts.push_back(fmt::format("f{} {:.4g} against {:.4g} {}", modes[static_cast<std::size_t>(k)], tested(k),
                                computed(k), model.selection().units.frequency));
  }
  return join(parts) + (computed.size() > k_listed ? ", ..." : "");
}

}  // namespace

const UnitFactor* find_unit_factor(const std::vector<double>& ratios) {
  for (const UnitFactor& factor : k_unit_factors) {
    const bool is_rare = factor.value == 60.0 || factor.value == 1.0 / 60.0;  // one frequency alone fits many factors
    if (is_rare && ratios.size() < 2) continue;
    const auto near = std::count_if(ratios.begin(), ratios.end(), [&](double ratio) {
      return std::abs(ratio - std::log(factor.value)) <= std::log(k_near);
    });
    if (!ratios.empty() && 4 * static_cast<std::size_t>(near) >= 3 * ratios.size()) return &factor;
  }
  return nullptr;
}

void refuse_unit_errors(const Study& study, const StudyModel& made, const StudyTests& tests) {
  const StructureModel& model = *made.model;
  const TestedFrequencies frequencies = tested_frequencies(model, tests.data);
  const std::vector<int>& modes = frequencies.modes;
  const Eigen::VectorXd tested = means_of(frequencies);
  Eigen::VectorXd computed = reference_frequencies(model, modes);
  if (find_unit_factor(log_ratios(tested, computed)) == nullptr) return;
  computed = frequencies_at(model, modes, made.space->prior().mean());  // modes may be numbered at other parameters
  const std::vector<double> ratios = log_ratios(tested, computed);
  const UnitFactor* const factor = find_unit_factor(ratios);
  if (factor == nullptr) return;
  const auto parameters = static_cast<Eigen::Index>(study.parameters.list.size());
  const std::vector<double> left =
      log_ratios(tested, extreme_frequencies(made, parameters, modes, tested, factor->value < 1.0));
  const bool can_prior_give = left.empty() || (factor->value < 1.0 ? mean_of(left) >= 0.0 : mean_of(left) <= 0.0);
  if (can_prior_give) return;
  throw InvalidInput(located(
      study, "test.file",
      fmt::format("{}: the frequencies are {:.4g} times the model's at the prior's mean ({}), and no "
                  "parameters that the prior allows give them. The factor is near {}, which a wrong unit makes: "
                  "{} If the model is really so far off, widen the prior.",
                  tests.file, std::exp(mean_of(ratios)), listed(model, modes, tested, computed), factor->name,
                  factor->remedy)));
}

}  // namespace mottle::study
