#include "mottle/study/jobs/run_modes.hpp"

#include <algorithm>
#include <cmath>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/dynamics/modes/mac.hpp"
#include "mottle/dynamics/modes/mode_set.hpp"
#include "mottle/fem/assembly/mass_properties.hpp"
#include "mottle/formats/nastran/model.hpp"
#include "mottle/formats/tables/csv.hpp"
#include "mottle/formats/uff/uff.hpp"
#include "mottle/formats/vtu.hpp"
#include "mottle/model/solvers/exact_solver.hpp"
#include "mottle/model/structures/finite_element_structure.hpp"
#include "mottle/study/input/text_file.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "mottle/study/results/run_folder.hpp"
#include "study/results/modes_json.hpp"
#include "study/results/result_json.hpp"

namespace mottle {
namespace {

constexpr int k_usual_modes = 10;

/// A model with its modes.
struct SolvedModel {
  std::unique_ptr<ExactSolver> solver;
  const FiniteElementStructure* structure = nullptr;  ///< the solver's
  SparseModes modes;
  Eigen::VectorXd frequencies;  ///< Hz where the deck's time unit is the second
  std::vector<std::string> notes;
  double read_seconds = 0.0, assembly_seconds = 0.0, solution_seconds = 0.0;
};

SolvedModel solve_deck(const std::filesystem::path& deck, const std::set<std::string>& ignore_cards, int modes) {
  const double start = steady_seconds();
  NastranModel read = read_nastran_model(deck, {.ignore_cards = ignore_cards});
  SolvedModel solved;
  solved.read_seconds = steady_seconds() - start;
  solved.notes = std::move(read.notes);
  if (modes == 0) modes = read.model.settings.modes > 0 ? read.model.settings.modes : k_usual_modes;
  const Eigen::VectorXd none;
  try {
    auto structure =
        std::make_unique<FiniteElementStructure>(std::move(read.model), std::vector<ParameterTargets>{}, none);
    solved.structure = structure.get();
    solved.solver = std::make_unique<ExactSolver>(std::move(structure));
  } catch (const FormatError&) {
    throw;
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: {}", deck.string(), error.what()));
  }
  const double assembled = steady_seconds();
  solved.assembly_seconds = assembled - start - solved.read_seconds;
  solved.modes = solved.solver->solve_one(none, {.modes = modes, .counts_below = true});
  if (!solved.modes.failure.empty()) {
    throw InvalidInput(fmt::format("{}: {}", deck.string(), solved.solver->failure_text(solved.modes)));
  }
  if (!solved.modes.is_complete()) {
    throw SystemFailure(fmt::format("{}: {} modes were found below {:.6g} (rad/s)^2, the inertia of K - s M counts {}",
                                    deck.string(), solved.modes.values.size(), solved.modes.counted_at,
                                    solved.modes.counted_below));
  }
  solved.solution_seconds = steady_seconds() - assembled;
  const double scale = solved.modes.values.cwiseAbs().maxCoeff();
  solved.frequencies.resize(solved.modes.values.size());
  for (Eigen::Index r = 0; r < solved.frequencies.size(); ++r) {
    solved.frequencies(r) = natural_frequency_hz(solved.modes.values(r), scale);
  }
  return solved;
}

std::vector<ShownMode> shown_modes(const SolvedModel& solved) {
  std::vector<ShownMode> shown;
  for (Eigen::Index r = 0; r < solved.modes.values.size(); ++r) {
    shown.push_back(
        {static_cast<int>(r) + 1, solved.frequencies(r), solved.modes.residuals(r), "", solved.modes.vectors.col(r)});
  }
  return shown;
}

/// Shapes to compare with, at degrees of freedom that both sides have.
struct Comparison {
  std::vector<std::string> names;  ///< of the other side's modes
  Eigen::MatrixXd own, other;      ///< [common degree of freedom x mode]
};

Comparison compare_with_table(const SolvedModel& solved, const std::filesystem::path& file) {
  const CsvTable table = parse_csv(read_text_file(file), file.string());
  const int column = table.find("dof");
  if (column < 0) throw FormatError(file.string(), 1, "has no column 'dof' with names like 101:+Z");
  Comparison result;
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
          "{}: holds no shape: a column 'dof' and one column a mode are needed", file.string());
  return result;
}

Comparison compare_with_deck(const SolvedModel& solved, const ModesSettings& settings) {
  const SolvedModel other =
      solve_deck(*settings.compare, settings.ignore_cards, static_cast<int>(solved.modes.values.size()));
  std::vector<int> here;
  std::vector<int> there;
  for (const Equation& equation : solved.structure->assembled().equations) {
    if (equation.component > 2) continue;
    const int id = solved.structure->model().nodes[static_cast<std::size_t>(equation.node)].id;
    const int node = other.structure->model().find_node(id);
    if (node < 0) continue;
    here.push_back(6 * equation.node + equation.component);
    there.push_back(6 * node + equation.component);
  }
  require(!here.empty(), "{} and {} have no grid point in common", settings.model.string(), settings.compare->string());
  Comparison result{{},
                    solved.structure->displacements(solved.modes.vectors, here),
                    other.structure->displacements(other.modes.vectors, there)};
  for (const double frequency : other.frequencies) {
    result.names.push_back(fmt::format("{}: {:.5g} Hz", result.names.size() + 1, frequency));
  }
  return result;
}

Json mac_json(const Comparison& comparison, const std::filesystem::path& file, const Eigen::VectorXd& frequencies,
              std::vector<std::string>& lines) {
  Eigen::MatrixXd mac(comparison.own.cols(), comparison.other.cols());
  for (Eigen::Index c = 0; c < mac.cols(); ++c) {
    std::vector<Eigen::Index> measured;  // each shape is compared where it was measured
    for (Eigen::Index d = 0; d < comparison.other.rows(); ++d) {
      if (!std::isnan(comparison.other(d, c))) measured.push_back(d);
    }
    mac.col(c) = modal_assurance_criterion(comparison.own(measured, Eigen::all), comparison.other(measured, c));
  }
  Json rows = Json::array();
  for (Eigen::Index r = 0; r < mac.rows(); ++r) rows.push_back(fmt::format("{}: {:.5g} Hz", r + 1, frequencies(r)));
  const bool is_wide = mac.rows() <= mac.cols();
  const std::vector<int> pairs = optimal_assignment(is_wide ? mac : Eigen::MatrixXd(mac.transpose()));
  lines.push_back(fmt::format("paired with {} by MAC at {} degrees of freedom:", file.string(), comparison.own.rows()));
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const auto r = static_cast<Eigen::Index>(is_wide ? k : pairs[k]);
    const auto c = static_cast<Eigen::Index>(is_wide ? pairs[k] : k);
    lines.push_back(fmt::format("  mode {:<3} - {:<16} MAC {:.3f}", r + 1,
                                comparison.names[static_cast<std::size_t>(c)], mac(r, c)));
  }
  return {{"rows", rows},
          {"columns", comparison.names},
          {"row_title", "model"},
          {"column_title", file.filename().string()},
          {"values", to_json_rows(mac)}};
}

void write_tables(const RunFolder& folder, const SolvedModel& solved) {
  Eigen::MatrixXd table(solved.modes.values.size(), 3);
  table << Eigen::VectorXd::LinSpaced(table.rows(), 1, static_cast<double>(table.rows())), solved.frequencies,
      solved.modes.residuals;
  folder.write("modes.csv", format_csv({"mode", "frequency", "residual"}, table));
  std::vector<VtuField> fields;
  for (Eigen::Index r = 0; r < table.rows(); ++r) {
    fields.push_back({fmt::format("mode {} at {:.6g}", r + 1, solved.frequencies(r)),
                      node_displacements(*solved.structure, solved.modes.vectors.col(r))});
  }
  folder.write("modes.vtu", format_vtu(solved.structure->model(), fields));
}

/// Grid points and mass-normalised shapes, both in the basic system.
UffFile universal_file(const SolvedModel& solved) {
  UffFile file;
  const std::vector<Node>& nodes = solved.structure->model().nodes;
  std::vector<int> ids;
  std::vector<Eigen::Index> rows;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (nodes[k].is_scalar) continue;
    file.nodes.push_back({.id = nodes[k].id, .color = 11, .position = nodes[k].position});
    ids.push_back(nodes[k].id);
    rows.push_back(static_cast<Eigen::Index>(k));
  }
  for (Eigen::Index r = 0; r < solved.frequencies.size(); ++r) {
    UffShape shape{
        .mode = static_cast<int>(r) + 1, .frequency = solved.frequencies(r), .modal_mass = 1.0, .nodes = ids};
    shape.titles[0] = fmt::format("Mode {}", r + 1);
    const Eigen::MatrixXd moved = node_displacements(*solved.structure, solved.modes.vectors.col(r))(rows, Eigen::all);
    shape.values = moved.cast<std::complex<double>>();
    file.shapes.push_back(std::move(shape));
  }
  return file;
}

}  // namespace

RunSummary run_modes(const ModesSettings& settings) {
  const double start = steady_seconds();
  const SolvedModel solved = solve_deck(settings.model, settings.ignore_cards, settings.modes);
  const double done = steady_seconds() - start;
  RunSummary summary;
  summary.status = "done";
  const Eigen::VectorXd none;
  std::vector<std::string> head = solved.structure->description(none);
  head.push_back(
      fmt::format("{} modes, none missed: {} eigenvalues lie below {:.6g} (rad/s)^2 by the inertia of K - s M",
                  solved.modes.values.size(), solved.modes.counted_below, solved.modes.counted_at));
  head.push_back(
      fmt::format("read in {:.3g} s, assembled in {:.3g} s, solved in {:.3g} s, of which factorised in {:.3g} s",
                  solved.read_seconds, solved.assembly_seconds, solved.solution_seconds, solved.modes.factor_seconds));
  for (const std::string& note : solved.notes) head.push_back("note: " + note);
  Json page = {{"kind", "modes"},     {"title", settings.model.filename().string()},
               {"mottle", version()}, {"source", settings.model.filename().string()},
               {"summary", head},     {"modes", drawing_json(*solved.structure, shown_modes(solved))}};
  summary.lines = head;
  summary.lines.push_back(fmt::format("{:<6} {:>14} {:>12}", "mode", "frequency Hz", "residual"));
  for (Eigen::Index r = 0; r < solved.frequencies.size(); ++r) {
    summary.lines.push_back(
        fmt::format("{:<6} {:>14.7g} {:>12.2e}", r + 1, solved.frequencies(r), solved.modes.residuals(r)));
  }
  Json json = {{"command", "modes"},
               {"model", settings.model.string()},
               {"equations", solved.structure->mode_count()},
               {"mass", to_json(mass_properties(solved.structure->model()).mass)},
               {"frequencies", to_json(solved.frequencies)},
               {"residuals", to_json(solved.modes.residuals)},
               {"counted_below", solved.modes.counted_below},
               {"automatic_constraints", solved.structure->assembled().automatic_constraints.size()},
               {"seconds", done},
               {"timings_s",
                {{"reading", solved.read_seconds},
                 {"assembly", solved.assembly_seconds},
                 {"solution", solved.solution_seconds},
                 {"factorisation", solved.modes.factor_seconds}}},
               {"folder", settings.folder.string()}};
  if (settings.compare) {
    const std::string extension = settings.compare->extension().string();
    const Comparison comparison = extension == ".csv" || extension == ".CSV"
                                      ? compare_with_table(solved, *settings.compare)
                                      : compare_with_deck(solved, settings);
    page["mac"] = mac_json(comparison, *settings.compare, solved.frequencies, summary.lines);
    json["mac"] = page["mac"];
  }
  const RunFolder folder(settings.folder);
  write_tables(folder, solved);
  if (settings.writes_universal_file) folder.write("modes.uff", format_uff(universal_file(solved)));
  folder.write("modes.json", one_line(page));
  summary.json = one_line(json);
  return summary;
}

}  // namespace mottle
