#include "study/tests/rank_numbering.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "mottle/core/text.hpp"

namespace mottle::study {
namespace {

/// Whether the measured frequencies of every specimen ascend with the modes' numbers.
bool is_ranked(const std::vector<int>& modes, const Eigen::Ref<const Eigen::MatrixXd>& tests) {
  for (std::size_t i = 0; i < modes.size(); ++i) {
    for (std::size_t j = 0; j < modes.size(); ++j) {
      if (modes[i] >= modes[j]) continue;
      const auto lower = tests.col(static_cast<Eigen::Index>(i)).array();
      if ((lower > tests.col(static_cast<Eigen::Index>(j)).array()).any()) return false;
    }
  }
  return true;
}

constexpr std::string_view k_numbering =
    "The tests number their modes by rank of frequency, the model by shape (outputs.tracking = \"mac\")";
constexpr std::string_view k_remedy =
    "Measure shapes and set test.pairing = \"mac\" (outputs.tracking = \"order\" numbers both by rank, but such "
    "outputs have a kink where modes cross, which biases estimates too). If the columns of the tests are the "
    "model's modes already, say so: test.pairing = \"named\"";

struct Crossings {
  double part = 0.0;     ///< of the cloud
  std::string frequent;  ///< the note that most of these samples have
};

Crossings crossings_of(const IterationRecord& state) {
  std::map<std::string, int> counts;
  int crossed = 0;
  for (const SampleNote& note : state.notes) {
    if (note.text.find("crossed") == std::string::npos) continue;
    ++crossed;
    ++counts[note.text];
  }
  const Eigen::Index samples = state.cloud.samples.rows();
  if (crossed == 0 || samples == 0) return {};
  const auto most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return {static_cast<double>(crossed) / static_cast<double>(samples), most->first};
}

}  // namespace

std::optional<std::string> rank_note(const OutputSelection& selection, const Eigen::Ref<const Eigen::MatrixXd>& tests) {
  if (selection.tracking != ModeTracking::mac || selection.frequencies.size() < 2) return std::nullopt;
  if (!is_ranked(selection.frequencies, tests)) return std::nullopt;
  return fmt::format("{}: where modes cross a frequency is compared with another mode's. {}", k_numbering, k_remedy);
}

std::optional<std::string> rank_warning(const OutputSelection& selection,
                                        const Eigen::Ref<const Eigen::MatrixXd>& tests,
                                        const std::vector<IterationRecord>& history) {
  constexpr double k_rare = 0.01;
  if (history.empty() || !rank_note(selection, tests)) return std::nullopt;
  const Crossings first = crossings_of(history.front());
  const Crossings last = crossings_of(history.back());
  if (std::max(first.part, last.part) < k_rare) return std::nullopt;
  return fmt::format(
      "{}, and modes cross in {:.0f} % of the prior's cloud and {:.0f} % of the updated one ({}): there a test's "
      "frequency is compared with another mode's, which biases means and standard deviations. {}",
      k_numbering, 100.0 * first.part, 100.0 * last.part, last.part > 0.0 ? last.frequent : first.frequent, k_remedy);
}

std::optional<std::string> bend_warning(const OutputSelection& selection, const IterationRecord& state) {
  // For a normally distributed gap: 1 % of the samples lie beyond the crossing; the gap of modes by rank, |gap|, has
  // less.
  constexpr double k_apart = 2.33;  // means over standard deviations
  const Cloud::Valid valid = state.cloud.valid();
  if (selection.tracking != ModeTracking::order || valid.outputs.rows() < 2) return std::nullopt;
  for (std::size_t i = 0; i < selection.frequencies.size(); ++i) {
    for (std::size_t j = 0; j < selection.frequencies.size(); ++j) {
      if (selection.frequencies[j] != selection.frequencies[i] + 1) continue;
      const Eigen::VectorXd gap =
          valid.outputs.col(static_cast<Eigen::Index>(j)) - valid.outputs.col(static_cast<Eigen::Index>(i));
      const double standard_deviation = std::sqrt((gap.array() - gap.mean()).square().mean());
      if (!(gap.mean() < k_apart * standard_deviation)) continue;
      return fmt::format(
          "Modes {} and {} cross in the updated population: their frequencies are {:.3g} apart, which scatters by "
          "{:.3g}. Numbered by rank (outputs.tracking = \"order\") they have a kink where modes cross, and "
          "estimates of first order are biased. Measure shapes, set outputs.tracking = \"mac\" and test.pairing = "
          "\"mac\"",
          selection.frequencies[i], selection.frequencies[j], gap.mean(), standard_deviation);
    }
  }
  return std::nullopt;
}

}  // namespace mottle::study
