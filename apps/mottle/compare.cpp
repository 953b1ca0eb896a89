// mottle compare: results of several updates side by side.
#include "mottle/study/jobs/compare.hpp"

#include <fmt/format.h>

#include <memory>

#include "common_options.hpp"
#include "mottle/core/utf8.hpp"
#include "mottle/report/report.hpp"

namespace mottle::app {

void add_compare(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("compare", "parameters, errors and verdicts of several updates side by side");
  const auto folders = std::make_shared<std::vector<std::filesystem::path>>();
  const auto page = std::make_shared<std::filesystem::path>();
  const auto is_json = std::make_shared<bool>(false);
  verb->add_option("DIR", *folders, "folders of updates' results, two or more")->required();
  verb->add_option("--out", *page, "also write a page (HTML) that shows them side by side");
  verb->add_flag("--json", *is_json, "machine-readable, as one line of JSON on stdout");
  verb->callback([=] {
    const Comparison comparison = compare_runs(*folders);
    const RunSummary summary = summarise(comparison);
    if (!page->empty()) write_comparison_page(comparison, summary, *page);
    if (*is_json) {
      fmt::print("{}\n", summary.json);
    } else {
      for (const std::string& line : summary.lines) fmt::print("{}\n", printable(line));
      if (!page->empty()) fmt::print("page: {}\n", page->string());
    }
  });
}

}  // namespace mottle::app
