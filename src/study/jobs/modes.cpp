#include "mottle/study/jobs/modes.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/clock.hpp"
#include "mottle/core/error.hpp"
#include "mottle/dynamics/modes/mac.hpp"
#include "mottle/formats/tables/csv.hpp"
#include "mottle/study/input/text_file.hpp"
#include "mottle/study/results/run_folder.hpp"
#include "study/jobs/job_files.hpp"
#include "study/jobs/solved_deck.hpp"
#include "study/results/modes_json.hpp"

namespace mottle::study {
namespace {

/// Shapes to compare with, at degrees of freedom that both sides have.
struct Shapes {
  std::vector<std::string> names;  ///< of the other side's modes
  Eigen::MatrixXd own, other;      ///< [common degree of freedom x mode]
};

Shapes shapes_of_table(const SolvedDeck& solved, const std::filesystem::path& file) {
  const CsvTable table = parse_csv(read_text_file(file), file.string());
  const int column = table.find("dof");
  if (column < 0) throw FormatError(file.string(), 1, "has no column 'dof' with names like 101:+Z");
  Shapes result;
  std::vector<int> slots;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const std::string& name = table.rows[row][static_cast<std::size_t>(column)];
    slots.push_back(solved.structure->find_degree_of_freedom(name));
    if (slots.back() < 0) {
      throw FormatError(file.string(), table.lines[row], solved.structure->unknown_degree_of_freedom(name));
    }
  }
  result.own = solved.structure->displacements(solved.modes.vectors, slots);
  for (std::size_t other = 0; other < table.header.size(); ++other) {
    if (static_cast<int>(other) == column) continue;
    result.names.push_back(table.header[other]);
    result.other.conservativeResize(static_cast<Eigen::Index>(table.rows.size()), result.other.cols() + 1);
    result.other.rightCols(1) = numbers_of_column(table, static_cast<int>(other));
  }
  require(!result.names.empty() && !slots.empty(),
          "{}: holds no shape: a column 'dof' and one column for each mode are needed", file.string());
  return result;
}

/// Nodes of both decks, by their places there; those of the first whose translations are free.
struct CommonNodes {
  std::vector<Eigen::Index> here = {}, there = {};
};

CommonNodes common_nodes(const FiniteElementStructure& own, const FiniteElementStructure& other) {
  CommonNodes common;
  std::vector<bool> is_taken(own.model().nodes.size(), false);
  for (const Equation& equation : own.assembled().equations) {
    const auto node = static_cast<std::size_t>(equation.node);
    if (equation.component > 2 || is_taken[node]) continue;
    is_taken[node] = true;
    const int there = other.model().find_node(own.model().nodes[node].id);
    if (there < 0 ||
        other.model().nodes[static_cast<std::size_t>(there)].is_scalar != own.model().nodes[node].is_scalar)
      continue;
    common.here.push_back(equation.node);
    common.there.push_back(there);
  }
  return common;
}

/// Translations of nodes along the basic axes, whatever their displacement systems are, and values of scalar points
/// [3 node x mode].
Eigen::MatrixXd basic_translations(const SolvedDeck& solved, const std::vector<Eigen::Index>& nodes) {
  const FiniteElementStructure& structure = *solved.structure;
  Eigen::MatrixXd result(3 * static_cast<Eigen::Index>(nodes.size()), solved.modes.vectors.cols());
  for (Eigen::Index mode = 0; mode < result.cols(); ++mode) {
    const auto shape = solved.modes.vectors.col(mode);
    const Eigen::MatrixX3d moved = node_displacements(structure, shape);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const auto row = 3 * static_cast<Eigen::Index>(k);
      result.col(mode).segment<3>(row) = moved.row(nodes[k]).transpose();
      if (!structure.model().nodes[static_cast<std::size_t>(nodes[k])].is_scalar) continue;
      result(row, mode) = structure.displacements(shape, {static_cast<int>(6 * nodes[k])})(0);
    }
  }
  return result;
}

Shapes shapes_of_deck(const SolvedDeck& solved, const ModesSettings& settings) {
  const SolvedDeck other = solve_deck(*settings.compare, {.ignore_cards = settings.ignore_cards},
                                      static_cast<int>(solved.modes.values.size()), settings.stop);
  const CommonNodes common = common_nodes(*solved.structure, *other.structure);
  require(!common.here.empty(), "{} and {} have no grid point in common", settings.model.string(),
          settings.compare->string());
  Shapes result{{}, basic_translations(solved, common.here), basic_translations(other, common.there)};
  for (const double frequency : other.frequencies) {
    result.names.push_back(fmt::format("{}: {:.5g} {}", result.names.size() + 1, frequency, other.frequency_unit));
  }
  return result;
}

ModeComparison compare(const Shapes& shapes) {
  ModeComparison result{shapes.names, Eigen::MatrixXd(shapes.own.cols(), shapes.other.cols()), {}, shapes.own.rows()};
  Eigen::MatrixXd& mac = result.mac;
  for (Eigen::Index c = 0; c < mac.cols(); ++c) {
    std::vector<Eigen::Index> measured;  // each shape is compared where it was measured
    for (Eigen::Index d = 0; d < shapes.other.rows(); ++d) {
      if (!std::isnan(shapes.other(d, c))) measured.push_back(d);
    }
    mac.col(c) = modal_assurance_criterion(shapes.own(measured, Eigen::all), shapes.other(measured, c));
  }
  const bool is_wide = mac.rows() <= mac.cols();
  const std::vector<int> pairs = optimal_assignment(is_wide ? mac : Eigen::MatrixXd(mac.transpose()));
  result.partner.assign(static_cast<std::size_t>(mac.rows()), -1);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const std::size_t own = is_wide ? k : static_cast<std::size_t>(pairs[k]);
    result.partner[own] = static_cast<Eigen::Index>(is_wide ? pairs[k] : static_cast<int>(k));
  }
  return result;
}

ModesOutcome find_modes_here(const ModesSettings& settings) {
  const double start = steady_seconds();
  ModesOutcome outcome{.settings = settings};
  const auto deck = std::make_shared<const SolvedDeck>(
      solve_deck(settings.model, {settings.ignore_cards, settings.subcase}, settings.modes, settings.stop));
  outcome.deck = deck;
  outcome.seconds = steady_seconds() - start;
  if (settings.compare) {
    const std::string extension = settings.compare->extension().string();
    const bool is_table = extension == ".csv" || extension == ".CSV";
    outcome.comparison =
        compare(is_table ? shapes_of_table(*deck, *settings.compare) : shapes_of_deck(*deck, settings));
  }
  return outcome;
}

}  // namespace

ModesOutcome find_modes(const ModesSettings& settings, const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> read{settings.model};
  if (settings.compare) read.push_back(*settings.compare);
  require_own(folder, modes_names(), read);
  return without_earlier(folder, results_not_read(folder, modes_names(), read),
                         [&] { return find_modes_here(settings); });
}

}  // namespace mottle::study
