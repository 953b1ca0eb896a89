#include "study/tests/pair_by_frequency.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/dynamics/modes/mode_set.hpp"
#include "study/tests/table_values.hpp"

namespace mottle::study {
namespace {

constexpr double k_no_partner = 1.5;    // ratio of frequencies
constexpr double k_far = 0.15;          // relative
constexpr double k_indifferent = 0.01;  // relative

/// Sums of squares of the best assignments of the first i tested and j model modes.
Eigen::MatrixXd best_sums(const Eigen::MatrixXd& squares) {
  const double none = std::pow(std::log(k_no_partner), 2);
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(squares.rows() + 1, squares.cols() + 1);
  for (Eigen::Index i = 1; i < sums.rows(); ++i) {
    sums(i, 0) = static_cast<double>(i) * none;
    for (Eigen::Index j = 1; j < sums.cols(); ++j) {
      sums(i, j) = std::min({sums(i - 1, j - 1) + squares(i - 1, j - 1), sums(i - 1, j) + none, sums(i, j - 1)});
    }
  }
  return sums;
}

/// Partner of each tested mode in the best assignment, -1: none.
std::vector<int> best_partners(const Eigen::MatrixXd& squares) {
  const Eigen::MatrixXd sums = best_sums(squares);
  std::vector<int> partners(static_cast<std::size_t>(squares.rows()), -1);
  Eigen::Index i = squares.rows();
  Eigen::Index j = squares.cols();
  while (i > 0 && j > 0) {
    if (sums(i, j) == sums(i, j - 1)) {
      --j;
    } else if (sums(i, j) == sums(i - 1, j - 1) + squares(i - 1, j - 1)) {
      partners[static_cast<std::size_t>(--i)] = static_cast<int>(--j);
    } else {
      --i;
    }
  }
  return partners;
}

/// Mean of the frequencies that a column has, of eigenvalues sqrt(lambda) / (2 pi); nan: none.
double mean_of(const CsvTable& table, int column, bool are_eigenvalues) {
  Eigen::ArrayXd values = measured_numbers(table, column, true).array();
  if (are_eigenvalues) values = values.sqrt() / (2.0 * std::numbers::pi);
  const auto count = static_cast<double>((!values.isNaN()).count());
  return values.isNaN().select(0.0, values).sum() / count;
}

/// Frequencies of the reference in the study's unit, as many as the tests could have.
Eigen::VectorXd reference_frequencies(const StructureModel& model, std::size_t tests, bool solves) {
  const int wanted = model.highest_mode() + static_cast<int>(tests);
  const int there = static_cast<int>(std::min<Eigen::Index>(wanted, model.structure().mode_count()));
  if (!solves || there <= model.reference_modes().eigenvalues.size()) {
    return natural_frequencies_hz(model.reference_modes().eigenvalues);
  }
  return natural_frequencies_hz(model.solver().modes_at(model.reference_parameters(), there).eigenvalues);
}

/// ln(model / test)^2 [test x mode]; infinite of rigid-body modes.
Eigen::MatrixXd squares_of(const Eigen::VectorXd& tests, const Eigen::VectorXd& model) {
  Eigen::MatrixXd squares(tests.size(), model.size());
  for (Eigen::Index i = 0; i < tests.size(); ++i) {
    for (Eigen::Index j = 0; j < model.size(); ++j) {
      squares(i, j) =
          model(j) > 0.0 ? std::pow(std::log(model(j) / tests(i)), 2) : std::numeric_limits<double>::infinity();
    }
  }
  return squares;
}

/// Mean square of the best assignment.
double misfit(const Eigen::VectorXd& tests, const Eigen::VectorXd& model) {
  return best_sums(squares_of(tests, model))(tests.size(), model.size()) / static_cast<double>(tests.size());
}

/// Tests in another unit find partners among higher or lower modes, where a model has many: refused where they fit it
/// badly as they are and far better by a factor of units.
void require_unit_of_model(const CsvTable& table, const Eigen::VectorXd& tests, const Eigen::VectorXd& model) {
  struct Unit {
    double factor;
    const char* text;
  };
  constexpr double k_minute = 60.0;
  static const Unit k_units[] = {{0.5 / std::numbers::pi, "rad/s"},
                                 {2.0 * std::numbers::pi, "radians against cycles"},
                                 {1.0 / k_minute, "1/min"},
                                 {k_minute, "minutes against seconds"},
                                 {1000.0, "kHz"},
                                 {0.001, "Hz where the model has kHz"}};
  const bool is_few = tests.size() < 4;
  const double bad = std::pow(std::log(is_few ? 1.35 : 1.08), 2);  // few modes fit many things
  constexpr double k_better = 9.0;
  const double as_given = misfit(tests, model);
  if (as_given < bad || tests.size() < 2) return;
  for (const Unit& unit : k_units) {
    const double scaled = misfit(unit.factor * tests, model);
    if (k_better * scaled > as_given) continue;
    throw FormatError(
        table.file, 1,
        fmt::format(
            "the frequencies differ from the model's by {:.0f} % as they are, and by {:.2g} % if they are "
            "multiplied by {:.6g} ({}): convert the columns, or set the study's units. If they are right, name the "
            "columns after the model's modes and say test.pairing = \"named\"",
            100.0 * std::sqrt(as_given), 100.0 * std::sqrt(scaled), unit.factor, unit.text));
  }
}

}  // namespace

std::optional<NumberedTitle> numbered_title(const std::string& title) {
  for (const QuantityKind kind :
       {QuantityKind::frequency, QuantityKind::damping_ratio, QuantityKind::eigenvalue, QuantityKind::shape_ratio}) {
    const std::string stem = traits_of(kind).stem;
    if (!title.starts_with(stem)) continue;
    NumberedTitle result{stem, 0, ""};
    const char* const end = title.data() + title.size();
    const auto [rest, error] = std::from_chars(title.data() + stem.size(), end, result.number);
    result.rest.assign(rest, end);
    const std::string_view ends_of_number = traits_of(kind).has_location ? ":" : " _[(";
    const bool ends = result.rest.empty() || ends_of_number.find(result.rest.front()) != std::string_view::npos;
    if (error == std::errc() && result.number > 0 && ends) return result;
  }
  return std::nullopt;
}

std::vector<FrequencyPair> pair_in_order(const Eigen::VectorXd& tests, const Eigen::VectorXd& model) {
  Eigen::MatrixXd squares = squares_of(tests, model);
  const std::vector<int> partners = best_partners(squares);
  const double best = best_sums(squares)(squares.rows(), squares.cols());
  std::vector<FrequencyPair> pairs;
  for (Eigen::Index i = 0; i < tests.size(); ++i) {
    FrequencyPair pair{.test = static_cast<int>(i), .mode = partners[static_cast<std::size_t>(i)]};
    if (pair.mode >= 0) {
      pair.difference = model(pair.mode) / tests(i) - 1.0;
      const double kept = std::exchange(squares(i, pair.mode), std::numeric_limits<double>::infinity());
      const double second = best_sums(squares)(squares.rows(), squares.cols());
      if (second - best < k_indifferent * k_indifferent) {
        pair.rival = best_partners(squares)[static_cast<std::size_t>(i)];
        pair.is_doubtful = true;
      }
      squares(i, pair.mode) = kept;
      pair.is_doubtful = pair.is_doubtful || std::abs(pair.difference) > k_far;
    }
    pairs.push_back(pair);
  }
  return pairs;
}

FrequencyPairing::FrequencyPairing(const CsvTable& table, const StructureModel& model, bool solves) {
  std::vector<std::pair<double, int>> tests;  // mean, number
  for (const QuantityKind kind : {QuantityKind::frequency, QuantityKind::eigenvalue}) {
    for (std::size_t column = 0; column < table.header.size(); ++column) {
      const std::optional<NumberedTitle> title = numbered_title(table.header[column]);
      if (!title || title->stem != traits_of(kind).stem) continue;
      if (std::ranges::find(tests, title->number, &std::pair<double, int>::second) != tests.end()) continue;
      const double mean = mean_of(table, static_cast<int>(column), kind == QuantityKind::eigenvalue);
      if (!std::isnan(mean)) tests.emplace_back(mean, title->number);
    }
  }
  if (table.rows.empty()) throw FormatError(table.file, 0, "holds no specimen: there is no row under the header");
  if (tests.empty()) {
    throw FormatError(table.file, 1,
                      fmt::format("has no column of frequencies (f1, f2, ...), which test.pairing = \"frequency\" "
                                  "needs; the columns are {}",
                                  join(table.header)));
  }
  std::ranges::sort(tests);
  means_.resize(static_cast<Eigen::Index>(tests.size()));
  for (std::size_t k = 0; k < tests.size(); ++k) {
    means_(static_cast<Eigen::Index>(k)) = tests[k].first;
    numbers_.push_back(tests[k].second);
  }
  frequencies_ = reference_frequencies(model, tests.size(), solves);
  require_unit_of_model(table, means_, frequencies_);
  pairs_ = pair_in_order(means_, frequencies_);
}

void FrequencyPairing::renumber(CsvTable& table, const StructureModel& model) const {
  for (std::size_t column = table.header.size(); column-- > 0;) {
    const std::optional<NumberedTitle> title = numbered_title(table.header[column]);
    if (!title) continue;
    const auto found = std::ranges::find(numbers_, title->number);
    const int mode = found == numbers_.end() ? -1 : pairs_[static_cast<std::size_t>(found - numbers_.begin())].mode;
    const bool is_used = mode >= 0 && std::ranges::any_of(model.measured(), [&](const Quantity& output) {
                           return traits_of(output.kind).stem == title->stem && output.number == mode + 1;
                         });
    if (is_used) {
      table.header[column] = fmt::format("{}{}{}", title->stem, mode + 1, title->rest);
      continue;
    }
    table.header.erase(table.header.begin() + static_cast<std::ptrdiff_t>(column));
    for (auto& row : table.rows) row.erase(row.begin() + static_cast<std::ptrdiff_t>(column));
  }
}

std::vector<std::string> FrequencyPairing::notes(const StructureModel& model) const {
  std::vector<std::string> pairs;
  std::vector<std::string> doubtful;
  std::vector<std::string> unused;
  for (const FrequencyPair& pair : pairs_) {
    if (pair.mode < 0 || pair.mode >= model.highest_mode() || !model.is_output(pair.mode)) {
      unused.push_back(fmt::format("f{}", numbers_[static_cast<std::size_t>(pair.test)]));
      continue;
    }
    const std::string text =
        fmt::format("f{} is the model's f{} ({:+.1f} %)", numbers_[static_cast<std::size_t>(pair.test)], pair.mode + 1,
                    100.0 * pair.difference);
    pairs.push_back(text);
    const std::string rival = pair.rival < 0 ? "" : fmt::format(", or f{}", pair.rival + 1);
    if (pair.is_doubtful) doubtful.push_back(text + rival);
  }
  std::vector<std::string> notes{fmt::format(
      "The tests' modes are paired with the model's by their frequencies, in ascending order (the model's frequency "
      "against the tests' mean in brackets): {}. Frequencies alone cannot show that modes have changed places.",
      join(pairs))};
  if (!doubtful.empty()) {
    notes.push_back(
        fmt::format("Doubtful pairs, more than 15 % apart or with another mode as near, used nevertheless: "
                    "{}.",
                    join(doubtful)));
  }
  if (!unused.empty()) {
    notes.push_back(fmt::format("Modes of the tests that are not used, by the tests' own numbers: {}.", join(unused)));
  }
  return notes;
}

bool FrequencyPairing::is_named_after_output(const FrequencyPair& pair, const StructureModel& model) const {
  return number_of(pair) <= model.highest_mode() && model.is_output(number_of(pair) - 1);
}

std::vector<FrequencyPair> FrequencyPairing::other_than_named(const StructureModel& model) const {
  std::vector<FrequencyPair> others;
  for (const FrequencyPair& pair : pairs_) {
    if (!is_named_after_output(pair, model)) continue;
    if (pair.mode < 0 || pair.is_doubtful) return {};
    const double difference = frequencies_(number_of(pair) - 1) / means_(pair.test) - 1.0;
    if (pair.mode != number_of(pair) - 1 && std::abs(difference) > k_far) others.push_back(pair);
  }
  return others;
}

std::string FrequencyPairing::note_on_names(const StructureModel& model, const TestedFrequencies& at_means) const {
  std::vector<std::string> others;
  for (const FrequencyPair& pair : other_than_named(model)) {
    const auto mode = std::ranges::find(at_means.modes, number_of(pair));
    const double moved =
        mode == at_means.modes.end() ? std::nan("") : at_means.values(0, mode - at_means.modes.begin());
    const double own = std::isnan(moved) ? frequencies_(number_of(pair) - 1) : moved;
    if (std::abs(own / means_(pair.test) - 1.0) <= k_far) continue;
    others.push_back(fmt::format("f{} ({:.4g} {}) is mode {} ({:.4g}), not {} ({:.4g})", number_of(pair),
                                 means_(pair.test), model.selection().units.frequency, pair.mode + 1,
                                 frequencies_(pair.mode), number_of(pair), own));
  }
  if (others.empty()) return {};
  return fmt::format(
      "Columns of the tests may be other modes of the model than their numbers say. By frequency {}. {}; \"order\" "
      "says that the numbers are right.",
      join(others), how_to_take(model));
}

/// What makes the pairs those of the study and is not refused for an output without column.
std::string FrequencyPairing::how_to_take(const StructureModel& model) const {
  const bool has_all = std::ranges::all_of(model.measured(), [&](const Quantity& output) {
    return !numbered_title(output.name()) ||
           std::ranges::find(pairs_, output.number - 1, &FrequencyPair::mode) != pairs_.end();
  });
  if (has_all) return "test.pairing = \"frequency\" pairs them so";
  std::vector<std::string> modes;
  for (const FrequencyPair& pair : pairs_) {
    if (is_named_after_output(pair, model)) modes.push_back(fmt::format("{}", pair.mode + 1));
  }
  return fmt::format("outputs.frequencies = [{}] with test.pairing = \"frequency\" takes them so", join(modes));
}

}  // namespace mottle::study
