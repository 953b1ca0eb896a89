#include "study/tests/squared_frequencies.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace mottle::study {
namespace {

const double k_log_two_pi = std::log(2.0 * std::numbers::pi);

const std::array k_of_frequencies = {
    MistakenPower{"eigenvalues, (2 pi f)^2",
                  "Give sqrt(lambda) / (2 pi), or name the columns lambda1, lambda2, ... and list the modes in "
                  "outputs.eigenvalues in place of outputs.frequencies.",
                  [](double value) { return 0.5 * value - k_log_two_pi; }},
    MistakenPower{"squares of frequencies", "Give their square roots.", [](double value) { return 0.5 * value; }}};

/// Tests of eigenvalues come as sqrt(lambda) / (2 pi).
const std::array k_of_eigenvalues = {
    MistakenPower{"frequencies, not eigenvalues (2 pi f)^2",
                  "Name the columns f1, f2, ... and list the modes in outputs.frequencies in place of "
                  "outputs.eigenvalues.",
                  [](double value) { return 2.0 * (value + k_log_two_pi); }},
    MistakenPower{"angular frequencies 2 pi f, not eigenvalues",
                  "Give their squares, or divide them by 2 pi and list the modes in outputs.frequencies.",
                  [](double value) { return 2.0 * value + k_log_two_pi; }}};

struct Misfit {
  double mean_square = 0.0;
  double near = 0.0;  // fraction within the factor
};

Misfit misfit_of(const std::vector<double>& tested, const std::vector<double>& computed,
                 double (*log_frequency)(double), double log_factor) {
  const auto count = static_cast<double>(tested.size());
  Misfit misfit;
  for (std::size_t k = 0; k < tested.size(); ++k) {
    const double off = (log_frequency != nullptr ? log_frequency(tested[k]) : tested[k]) - computed[k];
    misfit.mean_square += off * off / count;
    if (std::abs(off) <= log_factor) misfit.near += 1.0 / count;
  }
  return misfit;
}

}  // namespace

const MistakenPower* find_mistaken_power(const std::vector<double>& tested, const std::vector<double>& computed,
                                         bool are_eigenvalues, double unit_misfit) {
  constexpr double k_three_quarters = 0.75 - 1e-9;
  constexpr double k_better = 9.0;
  const double log_factor = std::log(tested.size() > 1 ? 1.5 : 1.2);
  if (tested.empty()) return nullptr;
  const double limit = std::min(unit_misfit, misfit_of(tested, computed, nullptr, log_factor).mean_square / k_better);
  const MistakenPower* found = nullptr;
  double least = limit;
  for (const MistakenPower& power : are_eigenvalues ? k_of_eigenvalues : k_of_frequencies) {
    const Misfit misfit = misfit_of(tested, computed, power.log_frequency, log_factor);
    if (misfit.near < k_three_quarters || !(misfit.mean_square < least)) continue;
    least = misfit.mean_square;
    found = &power;
  }
  return found;
}

}  // namespace mottle::study
