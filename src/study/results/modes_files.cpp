// The files and the summary of `mottle modes`.
#include "mottle/core/error.hpp"
#include "mottle/fem/assembly/mass_properties.hpp"
#include "mottle/formats/tables/csv.hpp"
#include "mottle/formats/uff/uff.hpp"
#include "mottle/formats/vtu.hpp"
#include "mottle/study/jobs/modes.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "mottle/study/results/run_folder.hpp"
#include "study/jobs/solved_deck.hpp"
#include "study/results/modes_json.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {
namespace {

std::vector<ShownMode> shown_modes(const SolvedDeck& solved) {
  std::vector<ShownMode> shown;
  for (Eigen::Index r = 0; r < solved.modes.values.size(); ++r) {
    shown.push_back(
        {static_cast<int>(r) + 1, solved.frequencies(r), solved.modes.residuals(r), "", solved.modes.vectors.col(r)});
  }
  return shown;
}

void write_tables(const RunFolder& folder, const SolvedDeck& solved) {
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
UffFile universal_file(const ModesOutcome& outcome) {
  UffFile file;
  const GridShapes shapes = grid_shapes(outcome);
  for (std::size_t k = 0; k < shapes.nodes.size(); ++k) {
    const Eigen::Vector3d position = shapes.positions.row(static_cast<Eigen::Index>(k)).transpose();
    file.nodes.push_back({.id = shapes.nodes[k], .color = 11, .position = position});
  }
  for (Eigen::Index r = 0; r < outcome.frequencies().size(); ++r) {
    UffShape shape{.mode = static_cast<int>(r) + 1,
                   .frequency = outcome.frequencies()(r),
                   .modal_mass = 1.0,
                   .nodes = shapes.nodes};
    shape.titles[0] = fmt::format("Mode {}", r + 1);
    shape.values = shapes.displacements[static_cast<std::size_t>(r)].cast<std::complex<double>>();
    file.shapes.push_back(std::move(shape));
  }
  return file;
}

/// MAC against the other modes, for the page.
Json mac_json(const ModeComparison& comparison, const ModesOutcome& outcome) {
  const Eigen::VectorXd& frequencies = outcome.deck->frequencies;
  Json rows = Json::array();
  for (Eigen::Index r = 0; r < frequencies.size(); ++r)
    rows.push_back(fmt::format("{}: {:.5g} {}", r + 1, frequencies(r), outcome.deck->frequency_unit));
  return {{"rows", rows},
          {"columns", comparison.names},
          {"row_title", "model"},
          {"column_title", outcome.settings.compare->filename().string()},
          {"values", to_json_rows(comparison.mac)}};
}

/// Structure, modes and seconds, in lines.
std::vector<std::string> head_lines(const SolvedDeck& deck) {
  const Eigen::VectorXd none;
  std::vector<std::string> head = deck.structure->description(none);
  head.push_back(fmt::format("{} modes, none missed: {} eigenvalues lie below {:.6g} {} by the inertia of K - s M",
                             deck.modes.values.size(), deck.modes.counted_below, deck.modes.counted_at,
                             deck.frequency_unit == "kHz" ? "(rad/ms)^2" : "(rad/s)^2"));
  head.push_back(
      fmt::format("read in {:.3g} s, assembled in {:.3g} s, solved in {:.3g} s, of which factorised in {:.3g} s",
                  deck.read_seconds, deck.assembly_seconds, deck.solution_seconds, deck.modes.factor_seconds));
  for (const std::string& note : deck.notes) head.push_back("note: " + note);
  return head;
}

void add_mode_lines(const ModesOutcome& outcome, std::vector<std::string>& lines) {
  const SolvedDeck& deck = *outcome.deck;
  lines.push_back(fmt::format("{:<6} {:>14} {:>12}", "mode", "frequency " + deck.frequency_unit, "residual"));
  for (Eigen::Index r = 0; r < deck.frequencies.size(); ++r) {
    lines.push_back(fmt::format("{:<6} {:>14.7g} {:>12.2e}", r + 1, deck.frequencies(r), deck.modes.residuals(r)));
  }
  if (!outcome.comparison) return;
  const ModeComparison& comparison = *outcome.comparison;
  lines.push_back(fmt::format("paired with {} by MAC at {} degrees of freedom:", outcome.settings.compare->string(),
                              comparison.degrees_of_freedom));
  for (Eigen::Index r = 0; r < comparison.mac.rows(); ++r) {
    const Eigen::Index c = comparison.partner[static_cast<std::size_t>(r)];
    if (c < 0) continue;
    lines.push_back(fmt::format("  mode {:<3} - {:<16} MAC {:.3f}", r + 1,
                                comparison.names[static_cast<std::size_t>(c)], comparison.mac(r, c)));
  }
}

Json page_json(const ModesOutcome& outcome) {
  const std::string name = outcome.settings.model.filename().string();
  Json page = {
      {"kind", "modes"},
      {"title", name},
      {"mottle", version()},
      {"source", name},
      {"summary", head_lines(*outcome.deck)},
      {"modes", drawing_json(*outcome.deck->structure, shown_modes(*outcome.deck), outcome.deck->frequency_unit)}};
  if (outcome.comparison) page["mac"] = mac_json(*outcome.comparison, outcome);
  return page;
}

}  // namespace

const Eigen::VectorXd& ModesOutcome::frequencies() const {
  return deck->frequencies;
}

const Eigen::VectorXd& ModesOutcome::residuals() const {
  return deck->modes.residuals;
}

GridShapes grid_shapes(const ModesOutcome& outcome) {
  const SolvedDeck& solved = *outcome.deck;
  const std::vector<Node>& nodes = solved.structure->model().nodes;
  GridShapes shapes;
  std::vector<Eigen::Index> rows;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (nodes[k].is_scalar) continue;
    shapes.nodes.push_back(nodes[k].id);
    rows.push_back(static_cast<Eigen::Index>(k));
  }
  shapes.positions.resize(static_cast<Eigen::Index>(rows.size()), 3);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    shapes.positions.row(static_cast<Eigen::Index>(k)) = nodes[static_cast<std::size_t>(rows[k])].position.transpose();
  }
  for (Eigen::Index r = 0; r < solved.frequencies.size(); ++r) {
    const Eigen::MatrixX3d moved = node_displacements(*solved.structure, solved.modes.vectors.col(r));
    shapes.displacements.emplace_back(moved(rows, Eigen::all));
  }
  return shapes;
}

void write_results(const ModesOutcome& outcome, const std::filesystem::path& path) {
  const RunFolder folder(path);
  write_tables(folder, *outcome.deck);
  if (outcome.settings.writes_universal_file) folder.write("modes.uff", format_uff(universal_file(outcome)));
  folder.write("modes.json", one_line(page_json(outcome)));
}

RunSummary summarise(const ModesOutcome& outcome, const std::filesystem::path& folder) {
  const SolvedDeck& deck = *outcome.deck;
  RunSummary summary{.status = "done", .lines = head_lines(deck)};
  add_mode_lines(outcome, summary.lines);
  Json json = {{"command", "modes"},
               {"model", outcome.settings.model.string()},
               {"equations", deck.structure->mode_count()},
               {"mass", to_json(mass_properties(deck.structure->model()).mass)},
               {"frequency_unit", deck.frequency_unit},
               {"frequencies", to_json(deck.frequencies)},
               {"residuals", to_json(deck.modes.residuals)},
               {"counted_below", deck.modes.counted_below},
               {"automatic_constraints", deck.structure->assembled().automatic_constraints.size()},
               {"seconds", outcome.seconds},
               {"timings_s",
                {{"reading", deck.read_seconds},
                 {"assembly", deck.assembly_seconds},
                 {"solution", deck.solution_seconds},
                 {"factorisation", deck.modes.factor_seconds}}},
               {"folder", folder.string()}};
  if (outcome.comparison) json["mac"] = mac_json(*outcome.comparison, outcome);
  summary.json = one_line(json);
  return summary;
}

}  // namespace mottle::study
