#include "study/tests/doubtful_frequencies.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/stats/moments/robust.hpp"
#include "study/input/first_few.hpp"
#include "study/tests/tested_frequencies.hpp"

namespace mottle::study {
namespace {

constexpr double k_far_factor = 1.8;  // specimens of one kind of structure do not differ by that much in a frequency

/// ", as in rad/s": the unit whose factor a ratio is near.
std::string unit_hint(double ratio) {
  struct Unit {
    double factor;
    const char* text;
  };
  static constexpr std::array k_units = {Unit{2.0 * std::numbers::pi, "in rad/s"},
                                         Unit{0.5 / std::numbers::pi, "divided by 2 pi"},
                                         Unit{60.0, "in 1/min (rpm)"},
                                         Unit{1.0 / 60.0, "divided by 60"},
                                         Unit{1000.0, "in mHz"},
                                         Unit{0.001, "in kHz"}};
  constexpr double k_near = 1.1;
  for (const Unit& unit : k_units) {
    if (std::abs(std::log(ratio / unit.factor)) < std::log(k_near)) return fmt::format(", as {}", unit.text);
  }
  return "";
}

bool is_far(double ratio) {
  return ratio > 0.0 && std::isfinite(ratio) && std::abs(std::log(ratio)) >= std::log(k_far_factor);
}

std::string mistaken_values(const TestedFrequencies& tested, const TestData& tests, const Eigen::VectorXd& medians) {
  constexpr Eigen::Index k_fewest = 3;  // of two that differ, either may be the mistaken one
  std::vector<std::string> found;
  for (Eigen::Index s = 0; s < tests.values.rows() && tests.values.rows() >= k_fewest; ++s) {
    for (Eigen::Index k = 0; k < tested.count(); ++k) {
      const double ratio = tested.values(s, k) / medians(k);
      if (!is_far(ratio)) continue;
      found.push_back(fmt::format("{} of specimen {} ({:.3g} times{})", tested.names[static_cast<std::size_t>(k)],
                                  tests.number_of(s), ratio, unit_hint(ratio)));
    }
  }
  if (found.empty()) return {};
  return fmt::format("Frequencies far from those of the other specimens, used as they are: {}. Check them.",
                     first_few(found));
}

/// @param ratios  of the columns' medians to the model's
std::string mistaken_columns(const std::vector<std::string>& names, const Eigen::VectorXd& ratios) {
  constexpr Eigen::Index k_fewest = 3;  // of two that differ, either may be the mistaken one
  if (ratios.size() < k_fewest) return {};
  const double usual = median(ratios);
  std::vector<std::string> found;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const double ratio = ratios(static_cast<Eigen::Index>(k)) / usual;
    if (is_far(ratio)) found.push_back(fmt::format("{} ({:.3g} times{})", names[k], ratio, unit_hint(ratio)));
  }
  if (found.empty()) return {};
  return fmt::format(
      "Columns that are farther from the model than the others, used as they are: {}. Check their units and whether "
      "they are the model's modes of these numbers.",
      join(found));
}

/// Whether the columns are near the eigenvalues (2 pi f)^2 of the model, and nearer to them than to any multiple of its
/// frequencies.
std::string eigenvalue_columns(const Eigen::VectorXd& medians, const Eigen::VectorXd& reference) {
  constexpr double k_near = 2.25;  // of an eigenvalue: 1.5 of a frequency, which parameters may be off by
  constexpr double k_clearly = 0.5;
  const auto range = [](const Eigen::ArrayXd& values) { return values.maxCoeff() - values.minCoeff(); };
  const Eigen::ArrayXd to_frequencies = (medians.array() / reference.array()).log();
  const Eigen::ArrayXd to_eigenvalues =
      to_frequencies - (4.0 * std::pow(std::numbers::pi, 2) * reference.array()).log();
  if (medians.size() < 2 || !to_eigenvalues.allFinite()) return {};
  if (to_eigenvalues.abs().maxCoeff() > std::log(k_near)) return {};
  if (to_frequencies.abs().minCoeff() < std::log(k_far_factor)) return {};
  if (range(to_eigenvalues) > k_clearly * range(to_frequencies)) return {};
  return "The tested frequencies are near (2 pi f)^2 of the model's, as eigenvalues are: name their columns lambda1, "
         "lambda2, ... and ask for them by [outputs] eigenvalues, or give sqrt(lambda) / (2 pi).";
}

/// Pairs of columns whose medians, exchanged, are far nearer to the model's frequencies, a common factor apart.
std::string exchanged_columns(const std::vector<std::string>& names, const Eigen::VectorXd& medians,
                              const Eigen::VectorXd& reference) {
  constexpr double k_far = 0.05;     // of a frequency, root mean square of the two
  constexpr double k_nearer = 0.25;  // times as far, exchanged
  const Eigen::VectorXd ratios = medians.cwiseQuotient(reference);
  if (ratios.size() < 3 || !(ratios.array() > 0.0).all() || !ratios.allFinite()) return {};
  const double usual = std::log(median(ratios));
  const auto distance = [&](Eigen::Index tested, Eigen::Index model) {
    return std::log(medians(tested) / reference(model)) - usual;
  };
  std::vector<std::string> found;
  for (Eigen::Index i = 0; i < ratios.size(); ++i) {
    for (Eigen::Index j = i + 1; j < ratios.size(); ++j) {
      const double as_given = std::hypot(distance(i, i), distance(j, j)) / std::numbers::sqrt2;
      const double exchanged = std::hypot(distance(j, i), distance(i, j)) / std::numbers::sqrt2;
      if (as_given < k_far || exchanged > k_nearer * as_given) continue;
      found.push_back(fmt::format("{} and {}", names[static_cast<std::size_t>(i)], names[static_cast<std::size_t>(j)]));
    }
  }
  if (found.empty()) return {};
  return fmt::format(
      "Columns that are far nearer to the model's frequencies when they are exchanged, used as they are: {}. Look "
      "whether they are in the right order.",
      first_few(found));
}

/// " (f1 > f2)": the first pair of a specimen's frequencies that does not ascend; empty: there is none.
std::string first_reversal(const TestedFrequencies& tested, Eigen::Index specimen) {
  const std::vector<int>& modes = tested.modes;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    for (std::size_t j = 0; j < modes.size(); ++j) {
      const double lower = tested.values(specimen, static_cast<Eigen::Index>(i));
      const double upper = tested.values(specimen, static_cast<Eigen::Index>(j));
      if (modes[i] < modes[j] && lower > upper) return fmt::format(" ({} > {})", tested.names[i], tested.names[j]);
    }
  }
  return {};
}

std::string unordered_specimens(const TestedFrequencies& tested, const TestData& tests) {
  std::vector<std::string> found;
  for (Eigen::Index s = 0; s < tests.values.rows(); ++s) {
    const std::string pair = first_reversal(tested, s);
    if (!pair.empty()) found.push_back(fmt::format("{}{}", tests.number_of(s), pair));
  }
  if (found.empty()) return {};
  return fmt::format(
      "The model counts its modes by frequency (outputs.tracking = \"order\"), and the frequencies of {} of {} "
      "specimens "
      "do not ascend so: specimen {}. If columns are in another order, test.pairing = \"frequency\" finds it; if modes "
      "were told apart by shape, set outputs.tracking = \"mac\".",
      found.size(), tests.values.rows(), first_few(found));
}

}  // namespace

std::vector<TestDoubt> doubtful_frequencies(const StructureModel& model, const TestData& tests) {
  const TestedFrequencies tested = tested_frequencies(model, tests);
  if (tested.modes.empty()) return {};
  Eigen::VectorXd medians(tested.count());
  for (Eigen::Index k = 0; k < medians.size(); ++k) medians(k) = median(tested.values.col(k));
  const Eigen::VectorXd reference = reference_frequencies(model, tested.modes);
  const Eigen::VectorXd ratios = medians.cwiseQuotient(reference);
  std::vector<TestDoubt> doubts;
  if (model.selection().tracking == ModeTracking::order) {
    doubts.push_back({"mode-order", unordered_specimens(tested, tests)});
  }
  if (doubts.empty() || doubts.back().sentence.empty()) {
    doubts.push_back({"mode-order", exchanged_columns(tested.names, medians, reference)});
  }
  doubts.push_back({"mistaken-values", mistaken_values(tested, tests, medians)});
  doubts.push_back({"mistaken-columns", eigenvalue_columns(medians, reference)});
  if (doubts.back().sentence.empty()) doubts.push_back({"mistaken-columns", mistaken_columns(tested.names, ratios)});
  std::erase_if(doubts, [](const TestDoubt& doubt) { return doubt.sentence.empty(); });
  return doubts;
}

}  // namespace mottle::study
