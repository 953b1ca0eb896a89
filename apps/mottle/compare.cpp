// mottle compare: results of several updates side by side.
#include "mottle/study/jobs/compare.hpp"

#include <fmt/format.h>

#include <memory>

#include "common_options.hpp"
#include "mottle/core/utf8.hpp"

namespace mottle::app {

void add_compare(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("compare", "parameters, errors and verdicts of several updates side by side");
  const auto folders = std::make_shared<std::vector<std::filesystem::path>>();
  const auto is_json = std::make_shared<bool>(false);
  verb->add_option("DIR", *folders, "folders of updates' results, two or more")->required();
  verb->add_flag("--json", *is_json, "machine-readable, as one line of JSON on stdout");
  verb->callback([=] {
    const RunSummary summary = summarise(compare_runs(*folders));
    if (*is_json) {
      fmt::print("{}\n", summary.json);
    } else {
      for (const std::string& line : summary.lines) fmt::print("{}\n", printable(line));
    }
  });
}

}  // namespace mottle::app
