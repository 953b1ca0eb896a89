#include "study/jobs/proposed_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "study/input/first_few.hpp"
#include "study/proposal/explanatory_numbers.hpp"
#include "study/proposal/proposal_model.hpp"

namespace mottle::study {
namespace {

constexpr std::size_t k_most = 12;

std::vector<Eigen::Index> indices_of(const std::vector<CandidateNumber>& candidates,
                                     const std::vector<std::string>& wanted) {
  std::vector<std::string> known;
  for (const CandidateNumber& candidate : candidates) known.push_back(candidate.parameter.target);
  std::vector<Eigen::Index> indices;
  for (const std::string& name : wanted) {
    const auto found = std::ranges::find(known, capitals(name));
    require(found != known.end(), "{}", unknown_name_message("target", name, known));
    indices.push_back(std::distance(known.begin(), found));
  }
  return indices;
}

/// Those that can be seen beside the noise of a frequency; the others would cost time and explain nothing.
std::vector<CandidateNumber> visible_candidates(const std::vector<CandidateNumber>& all, const ProposedOutputs& outputs,
                                                const std::vector<Eigen::Index>& wanted) {
  constexpr double k_least = 1e-4;  // of a frequency
  constexpr std::size_t k_listed = 80;
  std::vector<std::pair<double, std::size_t>> sizes;
  for (std::size_t j = 0; j < all.size(); ++j) {
    double largest = 0.0;
    for (const int mode : outputs.modes) {
      const double change = std::abs(all[j].sensitivity(mode - 1) * all[j].parameter.spread);
      if (!std::isnan(change)) largest = std::max(largest, change);
    }
    const bool is_wanted = std::ranges::count(wanted, static_cast<Eigen::Index>(j)) > 0;
    if (largest >= k_least || is_wanted) sizes.emplace_back(is_wanted ? HUGE_VAL : largest, j);
  }
  std::ranges::stable_sort(sizes, [](const auto& a, const auto& b) { return a.first > b.first; });
  sizes.resize(std::min(sizes.size(), k_listed));
  std::ranges::sort(sizes, {}, &std::pair<double, std::size_t>::second);
  std::vector<CandidateNumber> visible;
  for (const auto& [size, j] : sizes) visible.push_back(all[j]);
  return visible;
}

/// Selects about the deck's numbers, then about the mean that the chosen ones explain.
ExplanatoryNumbers select_about_means(const ProposalModel& model, Eigen::Index count, std::size_t most,
                                      const std::vector<Eigen::Index>& wanted) {
  constexpr int k_rounds = 6;
  constexpr double k_close = 0.1;  // prior standard deviations
  constexpr double k_farthest = 2.5;
  Eigen::VectorXd point = Eigen::VectorXd::Zero(count);
  ExplanatoryNumbers found;
  for (int round = 0; round < k_rounds; ++round) {
    const std::vector<Eigen::Index> start = wanted.empty() ? found.chosen : wanted;
    found = select_explanatory(model.linearise(point), most, start, !wanted.empty());
    const Eigen::VectorXd next = found.mean.cwiseMax(-k_farthest).cwiseMin(k_farthest);
    const bool is_close = (next - point).cwiseAbs().maxCoeff() < k_close;
    if (!model.can_move() || is_close) break;
    point = next;
  }
  return found;
}

/// Why each number that is no parameter is none.
class LeftOutReasons {
 public:
  LeftOutReasons(const std::vector<CandidateNumber>& all, SensitiveNumbers seen) : all_(all), seen_(std::move(seen)) {}
  /// @param gain  of ln likelihood with one more; nan: not known
  std::string of(Eigen::Index j, double gain, bool is_full) const {
    const Eigen::Index alike = seen_.most_alike(j);
    const bool explains = gain > least_gain(static_cast<Eigen::Index>(all_.size()));
    if (!seen_.is_seen(j) && !explains) return "changes the outputs less than the tests scatter";
    if (!seen_.is_told_apart(j)) {
      return fmt::format("the outputs can hardly tell it from {}",
                         alike < 0 ? "the others" : all_[static_cast<std::size_t>(alike)].parameter.name);
    }
    if (std::isnan(gain)) return "changes less, and more parameters than half of the outputs are hard to tell apart";
    if (explains && is_full)
      return fmt::format("explains more (ln likelihood {:+.1f}), but the outputs can test no more parameters", gain);
    return fmt::format("explains little beside the parameters (ln likelihood {:+.1f})", std::max(gain, 0.0));
  }

 private:
  const std::vector<CandidateNumber>& all_;
  SensitiveNumbers seen_;
};

struct Choice {
  std::vector<Eigen::Index> chosen = {};
  Eigen::VectorXd losses = {}, gains = {};  ///< nan: not known [number]
  bool is_full = false;
};

Choice choose_sensitive(const std::vector<CandidateNumber>& all, const ProposedOutputs& outputs,
                        std::vector<Eigen::Index> wanted) {
  const Eigen::VectorXd unknown = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(all.size()), std::nan(""));
  Choice choice{.chosen = std::move(wanted), .losses = unknown, .gains = unknown};
  if (!choice.chosen.empty()) return choice;
  SensitiveNumbers seen(all, outputs);
  const std::size_t most = std::clamp<std::size_t>(outputs.modes.size() / 2, 1, k_most);
  for (Eigen::Index next = seen.next(); next >= 0 && seen.chosen().size() < most; next = seen.next()) seen.choose(next);
  choice.chosen = seen.chosen();
  return choice;
}

/// None chosen: nothing needs an explanation.
Choice choose_explanatory(const InitOutcome& outcome, const std::vector<CandidateNumber>& all,
                          const ProposedOutputs& outputs, const std::vector<Eigen::Index>& wanted,
                          std::vector<std::string>& notes) {
  const Eigen::VectorXd unknown = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(all.size()), std::nan(""));
  Choice choice{.losses = unknown, .gains = unknown};
  const std::vector<CandidateNumber> visible = visible_candidates(all, outputs, wanted);
  if (visible.empty()) return choice;
  const ProposalModel model(outcome, visible, outputs);
  std::vector<Eigen::Index> places;
  for (const CandidateNumber& candidate : visible) {
    const auto place = std::ranges::find(all, candidate.parameter.target,
                                         [](const CandidateNumber& item) { return item.parameter.target; });
    places.push_back(place - all.begin());
  }
  std::vector<Eigen::Index> wanted_visible;
  for (const Eigen::Index j : wanted) wanted_visible.push_back(std::ranges::find(places, j) - places.begin());
  const auto most = static_cast<std::size_t>(std::clamp<Eigen::Index>(model.output_count() - 2, 1, k_most));
  const ExplanatoryNumbers found =
      select_about_means(model, static_cast<Eigen::Index>(visible.size()), most, wanted_visible);
  for (std::size_t i = 0; i < found.chosen.size(); ++i) {
    choice.chosen.push_back(places[static_cast<std::size_t>(found.chosen[i])]);
    choice.losses(choice.chosen.back()) = found.losses[i];
  }
  choice.gains(places) = found.gains;
  choice.is_full = found.chosen.size() >= most;
  if (!model.left_out().empty()) {
    std::vector<std::string> numbers;
    for (const int number : model.left_out()) numbers.push_back(fmt::format("{}", number));
    notes.push_back(fmt::format(
        "Specimens far from the others do not count in the choice of parameters: {}. They are in the study; look at "
        "them before you believe their parameters.",
        join(numbers)));
  }
  return choice;
}

}  // namespace

ProposedParameters propose_parameters(const InitOutcome& outcome, const std::vector<Target>& targets,
                                      const ProposedOutputs& outputs) {
  const std::vector<std::string> names = outcome.settings.targets.value_or(std::vector<std::string>{});
  const std::vector<CandidateNumber> all = candidate_numbers(targets, outputs.modes, outputs.groups, names.empty());
  const std::vector<Eigen::Index> wanted = indices_of(all, names);
  ProposedParameters proposed;
  Choice choice;
  if (outcome.specimens > 0) choice = choose_explanatory(outcome, all, outputs, wanted, proposed.notes);
  if (choice.chosen.empty()) choice = choose_sensitive(all, outputs, wanted);
  SensitiveNumbers seen(all, outputs);
  for (const Eigen::Index j : choice.chosen) {
    seen.choose(j);
    proposed.list.push_back(all[static_cast<std::size_t>(j)].parameter);
    proposed.list.back().explained = choice.losses(j);
  }
  const LeftOutReasons reasons(all, std::move(seen));
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto j = static_cast<Eigen::Index>(i);
    if (std::ranges::count(choice.chosen, j) > 0) continue;
    proposed.list.push_back(all[i].parameter);
    proposed.list.back().left_out = reasons.of(j, choice.gains(j), choice.is_full);
  }
  return proposed;
}

}  // namespace mottle::study
