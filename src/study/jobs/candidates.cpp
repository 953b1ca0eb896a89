#include "study/jobs/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/study/models/model_source.hpp"
#include "study/input/key_error.hpp"

namespace mottle::study {

namespace {

/// Size of a number; of a zero the median of its kind, 1 where the kind has none.
double size_of(const ModelNumber& number, const std::vector<ModelNumber>& numbers) {
  if (number.value != 0.0) return std::abs(number.value);
  std::vector<double> sizes;
  for (const ModelNumber& other : numbers) {
    if (other.kind == number.kind && other.value != 0.0) sizes.push_back(std::abs(other.value));
  }
  if (sizes.empty()) return 1.0;
  std::sort(sizes.begin(), sizes.end());
  return sizes[sizes.size() / 2];
}

/// "k3" of "spring:k3", the whole of "MAT1:2:E" and "*DENSITY:STEEL"; the whole target where the short name is taken.
std::string name_of(const std::string& target, const std::set<std::string>& taken) {
  const std::size_t colon = target.find(':');
  const bool is_short = target.rfind(':') == colon && !target.starts_with('*');
  const std::string name = is_short ? target.substr(colon + 1) : target;
  return taken.contains(name) ? target : name;
}

class Resolver {
 public:
  explicit Resolver(const Study& study) : study_(study) {
    require_key(study.model->has_targets(), "diagnose",
                "is not for a model by command: its numbers are not known here");
    numbers_ = study.model->numbers();  // of none the candidates are tables with target and distribution
    for (const StudyParameter& parameter : study.parameters.list) {
      names_.insert(parameter.name);
      for (const std::string& target : parameter.targets) owned_[key_of(target)] = parameter.name;
    }
  }

  StudyParameter resolve(StudyParameter candidate) {
    for (const std::string& target : candidate.targets) refuse_owned(target);
    if (candidate.name.empty()) {
      const ModelNumber& number = find(candidate.targets.front());
      const double size = size_of(number, numbers_);
      candidate.targets = {number.target};
      candidate.name = name_of(number.target, names_);
      candidate.distribution = {
          .kind = DistributionKind::normal, .mean = number.value, .std = study_.diagnose.spread * size};
    }
    candidate.may_vanish = candidate.distribution.mean == 0.0;
    require_key(names_.insert(candidate.name).second, k_key, "a parameter or another candidate is called '{}' too",
                candidate.name);
    for (const std::string& target : candidate.targets) owned_[key_of(target)] = candidate.name;
    return candidate;
  }

  /// The candidates where the study names none.
  std::vector<StudyParameter> usual() {
    std::vector<StudyParameter> candidates;
    for (const ModelNumber& number : numbers_) {
      if (!number.is_usual || owned_.contains(key_of(number.target))) continue;
      StudyParameter candidate;
      candidate.targets = {number.target};
      candidates.push_back(resolve(std::move(candidate)));
    }
    return candidates;
  }

  /// Every number, masses too; dampers only where an output sees them.
  FixedNumbers all(std::size_t max_count) {
    FixedNumbers found;
    std::vector<double> sizes;
    for (const ModelNumber& number : numbers_) {
      const bool is_seen = number.kind != "damper" || !study_.outputs.damping.empty();
      if (!is_seen || !number.is_doubtful || owned_.contains(key_of(number.target))) continue;
      if (++found.total > max_count) continue;
      StudyParameter candidate;
      candidate.targets = {number.target};
      found.list.push_back(resolve(std::move(candidate)));
      sizes.push_back(number.value != 0.0 ? number.value : size_of(number, numbers_));
    }
    found.sizes = Eigen::Map<const Eigen::VectorXd>(sizes.data(), static_cast<Eigen::Index>(sizes.size()));
    return found;
  }

 private:
  static constexpr const char* k_key = "diagnose.candidates";

  std::string key_of(const std::string& target) const { return study_.model->target_key(target); }

  void refuse_owned(const std::string& target) const {
    const auto owner = owned_.find(key_of(target));
    require_key(owner == owned_.end(), k_key, "'{}' is what {} acts on already", target,
                owner == owned_.end() ? "" : owner->second);
  }

  const ModelNumber& find(const std::string& target) const {
    std::vector<std::string> known;
    for (const ModelNumber& number : numbers_) {
      if (number.target == key_of(target)) return number;
      known.push_back(number.target);
    }
    constexpr std::size_t k_listed = 12;
    const std::string nearest = nearest_name(target, known);
    const bool is_cut = known.size() > k_listed;
    if (is_cut) known.resize(k_listed);
    throw KeyError(k_key, fmt::format("unknown target '{}'{} Known: {}{}; give a table with a distribution for numbers "
                                      "of the geometry",
                                      target, nearest.empty() ? "." : fmt::format("; did you mean '{}'?", nearest),
                                      join(known), is_cut ? ", ..." : ""));
  }

  const Study& study_;
  std::vector<ModelNumber> numbers_;
  std::set<std::string> names_;
  std::map<std::string, std::string> owned_;
};

/// Nothing where the model does not have one value for all targets.
std::optional<double> model_value(const ModelSource& model, const std::vector<ModelNumber>& numbers,
                                  const StudyParameter& candidate) {
  std::set<double> values;
  for (const std::string& target : candidate.targets) {
    const auto number = std::ranges::find(numbers, model.target_key(target), &ModelNumber::target);
    if (number == numbers.end() || !number->is_single) return std::nullopt;
    values.insert(number->value);
  }
  if (values.size() != 1) return std::nullopt;
  return *values.begin();
}

/// Bounds within the support of the prior too: a value that this rules out is none.
void keep_to_support(StudyParameter& candidate) {
  const Distribution prior(candidate.distribution);
  candidate.lower_bound = std::max(candidate.lower_bound, prior.lower());
  candidate.upper_bound = std::min(candidate.upper_bound, prior.upper());
}

bool may_be(const StudyParameter& candidate, double value) {
  if (value < candidate.lower_bound || value > candidate.upper_bound) return false;
  return std::isfinite(candidate.transform.from_variable(value));
}

}  // namespace

std::vector<StudyParameter> resolve_candidates(const Study& study) {
  try {
    Resolver resolver(study);
    std::vector<StudyParameter> candidates;
    for (const StudyParameter& candidate : study.diagnose.candidates) candidates.push_back(resolver.resolve(candidate));
    if (candidates.empty()) candidates = resolver.usual();
    require_key(!candidates.empty(), "diagnose.candidates", "the model has nothing left that no parameter acts on");
    return candidates;
  } catch (const InvalidInput& error) {
    throw InvalidInput(located(study, error));
  }
}

std::vector<StudyParameter> about_model_values(const Study& study, std::vector<StudyParameter> candidates) {
  const std::vector<ModelNumber> numbers = study.model->numbers();
  for (StudyParameter& candidate : candidates) {
    const std::optional<double> value =
        candidate.is_factor ? std::optional(1.0) : model_value(*study.model, numbers, candidate);
    const Distribution given(candidate.distribution);
    keep_to_support(candidate);
    if (!value || *value == given.mean() || !may_be(candidate, *value)) continue;
    candidate.distribution = {.kind = DistributionKind::normal, .mean = *value, .std = given.standard_deviation()};
    candidate.may_vanish = *value == 0.0;
  }
  return candidates;
}

FixedNumbers fixed_numbers(const Study& study, std::size_t max_count) {
  return Resolver(study).all(max_count);
}

Study with_candidates(const Study& study, const std::vector<StudyParameter>& candidates) {
  Study more = study;
  const auto given = static_cast<Eigen::Index>(study.parameters.list.size());
  const auto all = given + static_cast<Eigen::Index>(candidates.size());
  more.parameters.list.insert(more.parameters.list.end(), candidates.begin(), candidates.end());
  more.parameters.correlation = Eigen::MatrixXd::Identity(all, all);
  more.parameters.correlation.topLeftCorner(given, given) = study.parameters.correlation;
  return more;
}

}  // namespace mottle::study
