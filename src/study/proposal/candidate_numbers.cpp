#include "study/proposal/candidate_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "mottle/core/text.hpp"

namespace mottle::study {
namespace {

struct Knowledge {
  double spread = 0.0;
  const char* reason = "";
  double preference = 0.0;
};

/// How far a number of that kind is commonly off, by what it stands for.
Knowledge knowledge_of(const std::string& card, const std::string& name) {
  static const std::set<std::string> k_springs = {"PELAS", "CELAS2", "CELAS4", "PBUSH", "PGAP", "*SPRING"};
  if (k_springs.contains(card)) return {0.3, "stiffnesses of joints and supports are seldom known better", 3.0};
  if (name == "RHO" || card == "*DENSITY")
    return {0.03, "densities are known, but paint, glue and fasteners are in them too", 0.0};
  if (name == "E" || name == "G" || name.starts_with("E") || name.starts_with("G")) {
    return {0.1, "moduli are known better, but simplified joints and holes are in them too", 0.5};
  }
  if (name == "M" || card == "CONM1" || card == "*MASS" || name == "NSM")
    return {0.1, "masses of equipment and cables", 1.0};
  if (name == "J" || name == "A" || name.starts_with("I")) return {0.1, "properties of simplified sections", 2.0};
  return {0.05, "tolerances of dimensions", 0.0};
}

/// Parts of a target's name: "MAT1", "1", "E"; of CalculiX "*SPRING", "BOLTS", "".
struct TargetName {
  explicit TargetName(const std::string& target) {
    const std::size_t first = target.find(':');
    const std::size_t last = target.rfind(':');
    card = target.substr(0, first);
    const bool has_field = first != last || !target.starts_with('*');
    field = has_field ? target.substr(last + 1) : "";
    owner = target.substr(first + 1, first == last ? std::string::npos : last - first - 1);
    if (first == last && has_field) owner.clear();
  }
  std::string card, owner, field;
};

/// "E_MAT1_2" of "MAT1:2:E"; "E_STEEL" of "*ELASTIC:STEEL:E", "SPRING_BOLTS" of "*SPRING:BOLTS".
std::string name_of(const std::string& target) {
  const TargetName parts(target);
  if (parts.card.starts_with('*')) {
    return fmt::format("{}_{}", parts.field.empty() ? parts.card.substr(1) : parts.field, parts.owner);
  }
  return fmt::format("{}_{}_{}", parts.field, parts.card, parts.owner);
}

/// "M_CONM2_7001_7002", "K_PELAS_1_and_3_more".
std::string name_of_twins(const InitParameter& parameter) {
  if (parameter.twins.empty()) return parameter.name;
  if (parameter.twins.size() == 1) return fmt::format("{}_{}", parameter.name, TargetName(parameter.twins[0]).owner);
  return fmt::format("{}_and_{}_more", parameter.name, parameter.twins.size());
}

/// Whether two numbers are of one kind and value, and change all modes alike within `k_alike` of the larger change.
bool are_twins(const Target& one, const Target& other) {
  constexpr double k_alike = 0.05;
  const TargetName a(one.name), b(other.name);
  if (a.card != b.card || a.field != b.field || one.value != other.value) return false;
  const Eigen::ArrayXd first = one.sensitivity.transpose().array().isNaN().select(0.0, one.sensitivity.transpose());
  const Eigen::ArrayXd second =
      other.sensitivity.transpose().array().isNaN().select(0.0, other.sensitivity.transpose());
  const double size = std::max(first.matrix().norm(), second.matrix().norm());
  return size > 0.0 && (first - second).matrix().norm() <= k_alike * size;
}

/// Whether the modes of one frequency move apart, by more than rounding.
bool splits(const Target& target, const std::vector<ModeGroup>& groups) {
  constexpr double k_rounding = 1e-3;  // of the largest sensitivity
  return std::ranges::any_of(groups, [&](const ModeGroup& group) {
    if (group.first + group.count > target.sensitivity.size()) return false;
    const Eigen::RowVectorXd values = target.sensitivity.segment(group.first, group.count);
    return values.allFinite() && values.maxCoeff() - values.minCoeff() > k_rounding * target.largest_sensitivity();
  });
}

CandidateNumber describe(const Target& target) {
  const TargetName parts(target.name);
  const Knowledge knowledge = knowledge_of(parts.card, parts.field);
  return {.parameter = {.target = target.name,
                        .name = name_of(target.name),
                        .unit = target.unit,
                        .value = target.value,
                        .elements = target.elements,
                        .spread = knowledge.spread,
                        .spread_reason = knowledge.reason},
          .preference = knowledge.preference,
          .sensitivity = target.sensitivity};
}

void finish(const std::vector<int>& modes, CandidateNumber& candidate) {
  InitParameter& parameter = candidate.parameter;
  parameter.name = name_of_twins(parameter);
  for (const int mode : modes) {
    const double sensitivity = candidate.sensitivity(mode - 1);
    if (std::isnan(sensitivity) || std::abs(sensitivity) <= std::abs(parameter.sensitivity)) continue;
    parameter.sensitivity = sensitivity;
    parameter.mode = mode;
  }
}

}  // namespace

std::vector<CandidateNumber> candidate_numbers(const std::vector<Target>& targets, const std::vector<int>& modes,
                                               const std::vector<ModeGroup>& groups, bool may_tie) {
  std::vector<CandidateNumber> candidates;
  std::vector<const Target*> firsts;
  for (const Target& target : targets) {
    const auto twin = std::ranges::find_if(firsts, [&](const Target* first) { return are_twins(*first, target); });
    if (!may_tie || twin == firsts.end() || splits(target, groups)) {
      candidates.push_back(describe(target));
      firsts.push_back(&target);
      continue;
    }
    CandidateNumber& first = candidates[static_cast<std::size_t>(twin - firsts.begin())];
    first.parameter.twins.push_back(target.name);
    first.parameter.elements += target.elements;
    first.sensitivity += target.sensitivity;
  }
  for (CandidateNumber& candidate : candidates) finish(modes, candidate);
  return candidates;
}

}  // namespace mottle::study
