#include "study/jobs/candidates.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/formats/nastran/model.hpp"
#include "study/input/study_sections.hpp"
#include "study/input/toml_writer.hpp"

namespace mottle {

namespace {

/// A number of the model that a candidate may stand for.
struct Number {
  std::string target;
  std::string kind;  ///< numbers of one kind are of one size: "spring", "PELAS:K"
  double value = 0.0;
  bool is_usual = false;  ///< a candidate by default
};

std::string capitals(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  return text;
}

std::vector<Number> numbers_of_system(const MassSpringSystem& system) {
  std::vector<Number> numbers;
  for (const Connector& spring : system.springs)
    numbers.push_back({"spring:" + spring.name, "spring", spring.value, true});
  for (const PointMass& mass : system.masses) numbers.push_back({"mass:" + mass.name, "mass", mass.mass, false});
  for (const Connector& damper : system.dampers) {
    numbers.push_back({"damper:" + damper.name, "damper", damper.value, false});
  }
  return numbers;
}

/// Whether a card's number is one that models are usually wrong in.
bool is_usual_field(const CardField& field) {
  static const std::map<std::string, std::set<std::string>> k_usual = {{"MAT1", {"E", "G", "RHO"}},
                                                                       {"PSHELL", {"T"}},
                                                                       {"PBAR", {"A", "I1", "I2", "J"}},
                                                                       {"PBEAM", {"A", "I1", "I2", "J"}},
                                                                       {"PROD", {"A", "J"}},
                                                                       {"CONROD", {"A", "J"}},
                                                                       {"PTUBE", {"A", "J"}},
                                                                       {"PELAS", {"K"}},
                                                                       {"CELAS2", {"K"}},
                                                                       {"CELAS4", {"K"}},
                                                                       {"PMASS", {"M"}},
                                                                       {"CMASS2", {"M"}},
                                                                       {"CMASS4", {"M"}},
                                                                       {"CONM2", {"M"}},
                                                                       {"PBUSH", {"K1", "K2", "K3", "K4", "K5", "K6"}}};
  if (field.card == "PBARL" || field.card == "PBEAML") return field.name.starts_with("DIM");
  const auto found = k_usual.find(field.card);
  return found != k_usual.end() && found->second.contains(field.name);
}

/// Parts of matrices at the values at which they were written.
std::vector<Number> numbers_of_parts(const std::vector<StudyMatrixPart>& parts) {
  std::vector<Number> numbers;
  for (const StudyMatrixPart& part : parts) {
    const double value = part.nominal.value_or(1.0);
    if (!part.stiffness.empty()) numbers.push_back({"K:" + part.name, "K", value, true});
    if (!part.mass.empty()) numbers.push_back({"M:" + part.name, "M", value, false});
  }
  return numbers;
}

std::vector<Number> numbers_of_deck(const StudyModelSource& source) {
  const NastranModel deck = read_nastran_model(source.deck, {.ignore_cards = source.ignore_cards});
  std::vector<Number> numbers;
  for (const CardField& field : deck.model.fields) {
    numbers.push_back({fmt::format("{}:{}:{}", field.card, field.id, field.name),
                       fmt::format("{}:{}", field.card, field.name), field.value,
                       is_usual_field(field) && field.value != 0.0});
  }
  return numbers;
}

/// Size of a number; of a zero the median of its kind, 1 where the kind has none.
double size_of(const Number& number, const std::vector<Number>& numbers) {
  if (number.value != 0.0) return std::abs(number.value);
  std::vector<double> sizes;
  for (const Number& other : numbers) {
    if (other.kind == number.kind && other.value != 0.0) sizes.push_back(std::abs(other.value));
  }
  if (sizes.empty()) return 1.0;
  std::sort(sizes.begin(), sizes.end());
  return sizes[sizes.size() / 2];
}

/// "k3" of "spring:k3", the whole of "MAT1:2:E"; the whole target where the short name is taken.
std::string name_of(const std::string& target, const std::set<std::string>& taken) {
  const std::size_t colon = target.find(':');
  const bool is_short = target.rfind(':') == colon;
  const std::string name = is_short ? target.substr(colon + 1) : target;
  return taken.contains(name) ? target : name;
}

class Resolver {
 public:
  explicit Resolver(const Study& study) : study_(study) {
    using Kind = StudyModelSource::Kind;
    const Kind kind = study.model.kind;
    require(kind != Kind::command, "diagnose: is not for a model by command: its numbers are not known here");
    // A CalculiX deck names no numbers of its own accord: its candidates are tables with target and distribution.
    if (kind == Kind::mass_spring) numbers_ = numbers_of_system(study.model.system);
    if (kind == Kind::matrices) numbers_ = numbers_of_parts(study.model.parts);
    if (kind == Kind::nastran) numbers_ = numbers_of_deck(study.model);
    for (const StudyParameter& parameter : study.parameters.list) {
      names_.insert(parameter.name);
      for (const std::string& target : parameter.targets) owned_[key_of(target)] = parameter.name;
    }
  }

  StudyParameter resolve(StudyParameter candidate) {
    for (const std::string& target : candidate.targets) refuse_owned(target);
    if (candidate.name.empty()) {
      const Number& number = find(candidate.targets.front());
      const double size = size_of(number, numbers_);
      candidate.targets = {number.target};
      candidate.name = name_of(number.target, names_);
      candidate.distribution = {
          .kind = DistributionKind::normal, .mean = number.value, .std = study_.diagnose.spread * size};
    }
    candidate.may_vanish = candidate.distribution.mean == 0.0;
    require(names_.insert(candidate.name).second, "{}: a parameter or another candidate is called '{}' too", k_key,
            candidate.name);
    for (const std::string& target : candidate.targets) owned_[key_of(target)] = candidate.name;
    return candidate;
  }

  /// What is taken for a candidate where the study names none.
  std::vector<StudyParameter> usual() {
    std::vector<StudyParameter> candidates;
    for (const Number& number : numbers_) {
      if (!number.is_usual || owned_.contains(key_of(number.target))) continue;
      StudyParameter candidate;
      candidate.targets = {number.target};
      candidates.push_back(resolve(std::move(candidate)));
    }
    return candidates;
  }

  /// Every number, masses too; dampers only where an output sees them.
  FixedNumbers all(std::size_t most) {
    FixedNumbers found;
    std::vector<double> sizes;
    for (const Number& number : numbers_) {
      const bool is_seen = number.kind != "damper" || !study_.outputs.damping.empty();
      const bool is_taken = number.is_usual || study_.model.kind != StudyModelSource::Kind::nastran;
      if (!is_seen || !is_taken || owned_.contains(key_of(number.target))) continue;
      if (++found.total > most) continue;
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

  std::string key_of(const std::string& target) const {
    return study_.model.kind == StudyModelSource::Kind::nastran ? capitals(target) : target;
  }

  void refuse_owned(const std::string& target) const {
    const auto owner = owned_.find(key_of(target));
    require(owner == owned_.end(), "{}: '{}' is what {} acts on already", k_key, target,
            owner == owned_.end() ? "" : owner->second);
  }

  const Number& find(const std::string& target) const {
    std::vector<std::string> known;
    for (const Number& number : numbers_) {
      if (number.target == key_of(target)) return number;
      known.push_back(number.target);
    }
    constexpr std::size_t k_listed = 12;
    const std::string nearest = nearest_name(target, known);
    const bool is_cut = known.size() > k_listed;
    if (is_cut) known.resize(k_listed);
    throw InvalidInput(
        fmt::format("{}: unknown target '{}'{} Known: {}{}; give a table with a distribution for numbers "
                    "of the geometry",
                    k_key, target, nearest.empty() ? "." : fmt::format("; did you mean '{}'?", nearest), join(known),
                    is_cut ? ", ..." : ""));
  }

  const Study& study_;
  std::vector<Number> numbers_;
  std::set<std::string> names_;
  std::map<std::string, std::string> owned_;
};

}  // namespace

std::vector<StudyParameter> resolve_candidates(const Study& study) {
  try {
    Resolver resolver(study);
    std::vector<StudyParameter> candidates;
    for (const StudyParameter& candidate : study.diagnose.candidates) candidates.push_back(resolver.resolve(candidate));
    if (candidates.empty()) candidates = resolver.usual();
    require(!candidates.empty(), "diagnose.candidates: the model has nothing left that no parameter acts on");
    return candidates;
  } catch (const FormatError&) {
    throw;  // names the deck's own file and line
  } catch (const InvalidInput& error) {
    throw InvalidInput(located(study, error.what()));
  }
}

FixedNumbers fixed_numbers(const Study& study, std::size_t most) {
  return Resolver(study).all(most);
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

}  // namespace mottle
