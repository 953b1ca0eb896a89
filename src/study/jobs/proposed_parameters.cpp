#include "study/jobs/proposed_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"

namespace mottle::study {
namespace {

struct Spread {
  double value = 0.0;
  const char* reason = "";
};

/// How far a number of that kind is commonly off, by what it stands for.
Spread spread_of(const std::string& card, const std::string& name) {
  static const std::set<std::string> k_springs = {"PELAS", "CELAS2", "CELAS4", "PBUSH", "PGAP", "*SPRING"};
  if (k_springs.contains(card)) return {0.3, "stiffnesses of joints and supports are seldom known better"};
  if (name == "RHO" || card == "*DENSITY")
    return {0.03, "densities are known, but paint, glue and fasteners are in them too"};
  if (name == "E" || name == "G" || name.starts_with("E") || name.starts_with("G")) {
    return {0.1, "moduli are known better, but simplified joints and holes are in them too"};
  }
  if (name == "M" || card == "CONM1" || card == "*MASS" || name == "NSM")
    return {0.1, "masses of equipment and cables"};
  if (name == "J" || name.starts_with("I")) return {0.1, "properties of simplified sections"};
  return {0.05, "tolerances of dimensions"};
}

/// "E_MAT1_2" of "MAT1:2:E"; "E_STEEL" of "*ELASTIC:STEEL:E", "SPRING_BOLTS" of "*SPRING:BOLTS".
std::string name_of(const std::string& target) {
  const std::size_t first = target.find(':');
  const std::size_t last = target.rfind(':');
  const bool is_calculix = target.starts_with('*');
  if (is_calculix) {
    const std::string owner = target.substr(first + 1, first == last ? last : last - first - 1);
    return fmt::format("{}_{}", first == last ? target.substr(1, first - 1) : target.substr(last + 1), owner);
  }
  return fmt::format("{}_{}_{}", target.substr(last + 1), target.substr(0, first),
                     target.substr(first + 1, last - first - 1));
}

InitParameter describe(const Target& target, const std::vector<int>& modes) {
  const std::size_t first = target.name.find(':');
  const std::size_t last = target.name.rfind(':');
  const Spread spread = spread_of(target.name.substr(0, first),
                                  first == last && target.name.starts_with('*') ? "" : target.name.substr(last + 1));
  InitParameter parameter{.target = target.name,
                          .name = name_of(target.name),
                          .unit = target.unit,
                          .value = target.value,
                          .elements = target.elements,
                          .spread = spread.value,
                          .spread_reason = spread.reason};
  for (const int mode : modes) {
    const double sensitivity = target.sensitivity(mode - 1);
    if (std::isnan(sensitivity) || std::abs(sensitivity) <= std::abs(parameter.sensitivity)) continue;
    parameter.sensitivity = sensitivity;
    parameter.mode = mode;
  }
  return parameter;
}

/// Changes by one spread of each number, in scales of the outputs.
struct Changes {
  Eigen::MatrixXd known;    ///< [direction x number]
  Eigen::VectorXd unknown;  ///< sizes of those in unknown combinations of modes of one frequency [number]
};

/// @param spreads  [number]
Eigen::MatrixXd single_changes(const std::vector<Target>& targets, const ProposedOutputs& outputs,
                               const Eigen::VectorXd& spreads) {
  Eigen::MatrixXd changes(outputs.scales.size(), spreads.size());
  for (Eigen::Index j = 0; j < changes.cols(); ++j) {
    for (Eigen::Index k = 0; k < changes.rows(); ++k) {
      const int mode = outputs.modes[static_cast<std::size_t>(k)];
      const double sensitivity = targets[static_cast<std::size_t>(j)].sensitivity(mode - 1);
      changes(k, j) = std::isnan(sensitivity) ? 0.0 : sensitivity * spreads(j) / outputs.scales(k);
    }
  }
  return changes;
}

/// The outputs of a group become one row, of the mean of the group's eigenvalues, and the sizes of the rest.
void merge_group(const std::vector<Target>& targets, const ProposedOutputs& outputs, const ModeGroup& group,
                 const Eigen::VectorXd& spreads, Changes& changes) {
  std::vector<Eigen::Index> members;
  for (std::size_t k = 0; k < outputs.modes.size(); ++k) {
    if (group.contains(outputs.modes[k] - 1)) members.push_back(static_cast<Eigen::Index>(k));
  }
  if (members.empty()) return;
  const Eigen::VectorXd scales = outputs.scales(members);
  const double weight = std::sqrt(static_cast<double>(members.size())) / scales.mean();
  changes.known(members, Eigen::all).setZero();
  for (Eigen::Index j = 0; j < spreads.size(); ++j) {
    const Eigen::RowVectorXd values =
        targets[static_cast<std::size_t>(j)].sensitivity.segment(group.first, group.count);
    if (!values.allFinite()) continue;
    const double mean_square = (values.array() - values.mean()).square().mean();
    changes.known(members.front(), j) = weight * spreads(j) * values.mean();
    changes.unknown(j) = std::hypot(changes.unknown(j), weight * spreads(j) * std::sqrt(mean_square));
  }
}

Changes changes_of(const std::vector<Target>& targets, const std::vector<InitParameter>& parameters,
                   const ProposedOutputs& outputs) {
  Eigen::VectorXd spreads(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t j = 0; j < parameters.size(); ++j) spreads(static_cast<Eigen::Index>(j)) = parameters[j].spread;
  Changes changes{single_changes(targets, outputs, spreads), Eigen::VectorXd::Zero(spreads.size())};
  for (const ModeGroup& group : outputs.groups) merge_group(targets, outputs, group, spreads, changes);
  return changes;
}

/// Columns by pivoted orthogonalisation, the longest rest first.
class Selection {
 public:
  explicit Selection(Changes changes)
      : columns_(std::move(changes.known)), rest_(columns_), own_(std::move(changes.unknown)) {}

  double length(Eigen::Index j) const { return std::hypot(columns_.col(j).norm(), own_(j)); }
  /// Part of a column that the chosen ones cannot give, as a fraction of it.
  double independent(Eigen::Index j) const { return length(j) > 0.0 ? rest(j) / length(j) : 0.0; }

  void choose(Eigen::Index j) {
    chosen_.push_back(j);
    add_row_of(j);
    const double norm = rest_.col(j).norm();
    if (norm == 0.0) return;
    const Eigen::VectorXd direction = rest_.col(j) / norm;
    rest_ -= direction * (direction.transpose() * rest_).eval();
  }

  /// The candidate with the longest rest that satisfies both limits; -1: none.
  Eigen::Index next(double min_length, double min_independent) const {
    Eigen::Index best = -1;
    for (Eigen::Index j = 0; j < rest_.cols(); ++j) {
      if (length(j) < min_length || independent(j) < min_independent) continue;
      if (best < 0 || rest(j) > rest(best)) best = j;
    }
    return best;
  }

  /// The chosen column that is most like this one.
  Eigen::Index most_alike(Eigen::Index j) const {
    Eigen::Index best = -1;
    double largest = 0.0;
    for (const Eigen::Index other : chosen_) {
      const double cosine = std::abs(columns_.col(j).dot(columns_.col(other))) / (length(j) * length(other));
      if (best >= 0 && !(cosine > largest)) continue;
      largest = cosine;
      best = other;
    }
    return best;
  }

  const std::vector<Eigen::Index>& chosen() const { return chosen_; }

 private:
  double rest(Eigen::Index j) const { return std::hypot(rest_.col(j).norm(), own_(j)); }

  /// The direction of its own becomes one that others can get a part in.
  void add_row_of(Eigen::Index j) {
    if (own_(j) == 0.0) return;
    for (Eigen::MatrixXd* matrix : {&columns_, &rest_}) {
      matrix->conservativeResize(matrix->rows() + 1, Eigen::NoChange);
      matrix->bottomRows(1).setZero();
      (*matrix)(matrix->rows() - 1, j) = own_(j);
    }
    own_(j) = 0.0;
  }

  Eigen::MatrixXd columns_, rest_;
  Eigen::VectorXd own_;  // lengths in a direction that no other column has
  std::vector<Eigen::Index> chosen_;
};

void choose_wanted(const std::vector<Target>& targets, const std::vector<std::string>& wanted, Selection& selection) {
  std::vector<std::string> known;
  for (const Target& target : targets) known.push_back(target.name);
  for (const std::string& name : wanted) {
    const auto found = std::ranges::find(known, capitals(name));
    require(found != known.end(), "{}", unknown_name_message("target", name, known));
    selection.choose(std::distance(known.begin(), found));
  }
}

}  // namespace

std::vector<InitParameter> propose_parameters(const std::vector<Target>& targets, const ProposedOutputs& outputs,
                                              const std::vector<std::string>& wanted) {
  constexpr double k_seen = 1.0;
  constexpr double k_independent = 0.15;
  constexpr std::size_t k_most = 12;
  std::vector<InitParameter> all;
  for (const Target& target : targets) all.push_back(describe(target, outputs.modes));
  Selection selection(changes_of(targets, all, outputs));
  choose_wanted(targets, wanted, selection);
  const std::size_t most = std::clamp<std::size_t>(outputs.modes.size() / 2, 1, k_most);
  while (wanted.empty() && selection.chosen().size() < most) {
    const Eigen::Index next = selection.next(k_seen, k_independent);
    if (next < 0) break;
    selection.choose(next);
  }
  std::vector<InitParameter> proposed;
  for (const Eigen::Index j : selection.chosen()) proposed.push_back(all[static_cast<std::size_t>(j)]);
  for (std::size_t j = 0; j < all.size(); ++j) {
    const auto index = static_cast<Eigen::Index>(j);
    if (std::ranges::count(selection.chosen(), index) > 0) continue;
    InitParameter& other = all[j];
    const Eigen::Index alike = selection.most_alike(index);
    if (selection.length(index) < k_seen) {
      other.left_out = "changes the outputs less than the tests scatter";
    } else if (selection.independent(index) < k_independent) {
      other.left_out = fmt::format("the outputs can hardly tell it from {}",
                                   alike < 0 ? "the others" : all[static_cast<std::size_t>(alike)].name);
    } else {
      other.left_out = "changes less, and more parameters than half of the outputs are hard to tell apart";
    }
    proposed.push_back(std::move(other));
  }
  return proposed;
}

}  // namespace mottle::study
