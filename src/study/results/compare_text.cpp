// What `mottle compare` prints.
#include <algorithm>
#include <cmath>

#include "mottle/study/jobs/compare.hpp"
#include "study/results/evidence_json.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {
namespace {

/// Lines of a table whose first column names the row; the others are as wide as their longest cell.
class Columns {
 public:
  explicit Columns(std::size_t count) : count_(count) {}

  void add(const std::string& name, std::vector<std::string> cells) { rows_.emplace_back(name, std::move(cells)); }
  void add_heading(const std::string& text) { rows_.emplace_back(text, std::vector<std::string>()); }

  std::vector<std::string> lines() const {
    std::size_t first = 0;
    std::vector<std::size_t> widths(count_, 0);
    for (const auto& [name, cells] : rows_) {
      if (cells.empty()) continue;
      first = std::max(first, name.size());
      for (std::size_t k = 0; k < cells.size(); ++k) widths[k] = std::max(widths[k], cells[k].size());
    }
    std::vector<std::string> lines;
    for (const auto& [name, cells] : rows_) {
      std::string line = cells.empty() ? name : fmt::format("{:<{}}", name, first);
      for (std::size_t k = 0; k < cells.size(); ++k) line += fmt::format("   {:<{}}", cells[k], widths[k]);
      lines.push_back(line.substr(0, line.find_last_not_of(' ') + 1));
    }
    return lines;
  }

 private:
  std::size_t count_;
  std::vector<std::pair<std::string, std::vector<std::string>>> rows_;
};

/// A row with a cell for each run.
template <typename Cell>
std::vector<std::string> each_run(const Comparison& comparison, const Cell& cell) {
  std::vector<std::string> cells;
  for (const ComparedRun& run : comparison.runs) cells.push_back(cell(run));
  return cells;
}

/// Names of a list of every run, each once, in the order of their first mention.
template <typename List>
std::vector<std::string> names_in(const Comparison& comparison, const List& list) {
  std::vector<std::string> names;
  for (const ComparedRun& run : comparison.runs) {
    for (const auto& item : list(run)) {
      if (std::ranges::count(names, item.name) == 0) names.push_back(item.name);
    }
  }
  return names;
}

template <typename Items, typename Text>
std::string cell_of(const Items& items, const std::string& name, const Text& text) {
  const auto found = std::ranges::find_if(items, [&](const auto& item) { return item.name == name; });
  return found == items.end() ? "-" : text(*found);
}

std::string with_interval(double value, double lower, double upper) {
  if (std::isnan(value)) return "-";
  const std::string text = fmt::format("{:.5g}", value);
  return std::isnan(lower) || std::isnan(upper) ? text : fmt::format("{} [{:.4g}, {:.4g}]", text, lower, upper);
}

void add_parameters(const Comparison& comparison, Columns& columns) {
  const auto list = [](const ComparedRun& run) -> const auto& {
    return run.parameters;
  };
  columns.add_heading("parameters: mean and standard deviation with 95 % intervals");
  for (const std::string& name : names_in(comparison, list)) {
    columns.add("  " + name, each_run(comparison, [&](const ComparedRun& run) {
                  return cell_of(run.parameters, name, [](const ComparedParameter& one) {
                    return with_interval(one.mean, one.mean_lower, one.mean_upper) +
                           (one.at_bound.empty() ? "" : fmt::format(", at the {} bound", one.at_bound));
                  });
                }));
    columns.add("    std", each_run(comparison, [&](const ComparedRun& run) {
                  return cell_of(run.parameters, name, [](const ComparedParameter& one) {
                    return with_interval(one.standard_deviation, one.std_lower, one.std_upper);
                  });
                }));
  }
}

/// "+1.23 %", or the difference where the tests' mean is zero.
std::string difference(double model, double test) {
  if (std::isnan(model) || std::isnan(test)) return "-";
  return test == 0.0 ? fmt::format("{:+.3g}", model - test) : fmt::format("{:+.3g} %", 100.0 * (model / test - 1.0));
}

void add_outputs(const Comparison& comparison, Columns& columns) {
  const auto list = [](const ComparedRun& run) -> const auto& {
    return run.outputs;
  };
  columns.add_heading("outputs: error of the mean after (before); scatter of model and noise over that of the tests");
  for (const std::string& name : names_in(comparison, list)) {
    columns.add("  " + name, each_run(comparison, [&](const ComparedRun& run) {
                  return cell_of(run.outputs, name, [](const ComparedOutput& one) {
                    const std::string scatter =
                        std::isnan(one.scatter_ratio) ? "" : fmt::format("; {:.2f}", one.scatter_ratio);
                    return fmt::format("{} ({}){}", difference(one.final_mean, one.test_mean),
                                       difference(one.initial_mean, one.test_mean), scatter);
                  });
                }));
  }
}

/// "0.987 [0.96, 0.995]"; near 1 what is left to it: "1 - 2.6e-06 [1 - 3e-06, 1 - 2e-06]".
std::string probability_text(const ModelProbability& model) {
  constexpr double k_near_one = 0.999;
  const auto text = [](double probability, double rest) {
    return probability > k_near_one ? fmt::format("1 - {:.2g}", rest) : fmt::format("{:.3g}", probability);
  };
  return fmt::format("{} [{}, {}]", text(model.probability, model.rest), text(model.lower, model.rest_of_lower),
                     text(model.upper, model.rest_of_upper));
}

bool is_best(const ModelProbability& model) {
  return model.log_bayes_factor == 0.0;
}

void add_evidence(const Comparison& comparison, Columns& columns) {
  if (!comparison.evidence) return;
  const auto row = [&](const std::string& name, auto text) {
    columns.add("  " + name, each_run(comparison, [&](const ComparedRun& run) {
                  const auto found = std::ranges::find(comparison.evidence->models, run.label, &ComparedModel::label);
                  return found == comparison.evidence->models.end() ? std::string("-") : text(*found);
                }));
  };
  columns.add_heading(
      "evidence: ln Z, ln Bayes factor of the best model over each, both with standard errors; "
      "probabilities with 95 % intervals where all models are as probable before the tests");
  row("ln evidence", [](const ComparedModel& one) {
    return fmt::format("{:.4f} +- {:.2g}", one.evidence.log_evidence, one.evidence.standard_error);
  });
  row("ln Bayes factor", [](const ComparedModel& one) {
    return is_best(one.against)
               ? std::string("0")
               : fmt::format("{:.4f} +- {:.2g}", one.against.log_bayes_factor, one.against.standard_error);
  });
  row("against it (Kass and Raftery 1995)", [](const ComparedModel& one) {
    return std::string(is_best(one.against) ? "best" : evidence_strength(one.against.log_bayes_factor));
  });
  row("probability", [](const ComparedModel& one) { return probability_text(one.against); });
  row("elpd, leave-one-out",
      [](const ComparedModel& one) { return std::isfinite(one.elpd) ? fmt::format("{:.4g}", one.elpd) : "-"; });
  row("elpd, less the largest", [](const ComparedModel& one) {
    if (std::isnan(one.elpd_difference)) return std::string("-");
    return one.elpd_difference == 0.0 ? std::string("0")
                                      : fmt::format("{:.3g} +- {:.2g}", one.elpd_difference, one.elpd_standard_error);
  });
}

/// What stands against comparing evidences, a line each.
void add_doubts(const Comparison& comparison, std::vector<std::string>& lines) {
  if (!comparison.evidence) return;
  for (const auto& [label, reason] : comparison.evidence->left_out) {
    lines.push_back(fmt::format("not compared by evidence: {}: {}", label, reason));
  }
  for (const std::string& warning : comparison.evidence->warnings) lines.push_back("warning: " + warning);
}

Json run_json(const ComparedRun& run) {
  Json parameters = Json::array();
  for (const ComparedParameter& one : run.parameters) {
    parameters.push_back({{"name", one.name},
                          {"unit", one.unit},
                          {"prior_mean", number_json(one.prior_mean)},
                          {"mean", number_json(one.mean)},
                          {"mean_ci95", {number_json(one.mean_lower), number_json(one.mean_upper)}},
                          {"std", number_json(one.standard_deviation)},
                          {"std_ci95", {number_json(one.std_lower), number_json(one.std_upper)}},
                          {"at_bound", one.at_bound}});
  }
  Json outputs = Json::array();
  for (const ComparedOutput& one : run.outputs) {
    outputs.push_back({{"name", one.name},
                       {"unit", one.unit},
                       {"test_mean", number_json(one.test_mean)},
                       {"initial_mean", number_json(one.initial_mean)},
                       {"final_mean", number_json(one.final_mean)},
                       {"scatter_ratio", number_json(one.scatter_ratio)}});
  }
  return {
      {"folder", run.folder.string()}, {"label", run.label},     {"title", run.title},         {"method", run.method},
      {"status", run.status},          {"verdict", run.verdict}, {"specimens", run.specimens}, {"seconds", run.seconds},
      {"parameters", parameters},      {"outputs", outputs}};
}

}  // namespace

RunSummary summarise(const Comparison& comparison) {
  Columns columns(comparison.runs.size());
  columns.add("", each_run(comparison, [](const ComparedRun& run) { return run.label; }));
  columns.add("study", each_run(comparison, [](const ComparedRun& run) { return run.title; }));
  columns.add("method", each_run(comparison, [](const ComparedRun& run) { return run.method; }));
  columns.add("ended", each_run(comparison, [](const ComparedRun& run) { return run.status; }));
  columns.add("verdict",
              each_run(comparison, [](const ComparedRun& run) { return run.verdict.empty() ? "-" : run.verdict; }));
  columns.add("specimens",
              each_run(comparison, [](const ComparedRun& run) { return fmt::format("{}", run.specimens); }));
  columns.add("time",
              each_run(comparison, [](const ComparedRun& run) { return fmt::format("{:.3g} s", run.seconds); }));
  add_parameters(comparison, columns);
  add_outputs(comparison, columns);
  if (comparison.evidence && !comparison.evidence->models.empty()) add_evidence(comparison, columns);
  RunSummary summary{.status = "done", .lines = columns.lines()};
  add_doubts(comparison, summary.lines);
  Json runs = Json::array();
  for (const ComparedRun& run : comparison.runs) runs.push_back(run_json(run));
  summary.json =
      one_line(Json{{"command", "compare"}, {"runs", runs}, {"evidence", evidence_comparison_json(comparison)}});
  return summary;
}

}  // namespace mottle::study
