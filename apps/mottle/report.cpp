// mottle report
#include "mottle/report/report.hpp"

#include <fmt/format.h>

#include <memory>
#include <optional>

#include "common_options.hpp"
#include "mottle/study/results/folder_lock.hpp"

namespace mottle::app {

void add_report(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("report", "draw the report again from the results in a folder");
  const auto folder = std::make_shared<std::string>();
  const auto is_quiet = std::make_shared<bool>(false);
  const auto is_printed = std::make_shared<bool>(false);
  verb->add_option("DIR", *folder, "folder with result.json")->required();
  verb->add_flag("--pdf", *is_printed, "also print its summary of two pages to DIR/report.pdf, by a Chromium on PATH");
  verb->add_flag("--quiet", *is_quiet, "say nothing but errors");
  verb->callback([folder, is_printed, is_quiet] {
    std::optional<FolderLock> lock;
    if (std::filesystem::is_directory(*folder)) lock.emplace(*folder);
    write_report(*folder);
    if (!*is_quiet) fmt::print("report: {}\n", (std::filesystem::path(*folder) / "report.html").string());
    if (!*is_printed) return;
    const std::filesystem::path file = print_report(*folder, &stop_flag());
    if (!*is_quiet) fmt::print("summary on paper: {}\n", file.string());
  });
}

}  // namespace mottle::app
