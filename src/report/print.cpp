#include <array>
#include <chrono>

#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"
#include "mottle/drivers/command/solver_process.hpp"
#include "mottle/report/report.hpp"
#include "mottle/study/results/own_results.hpp"
#include "mottle/study/results/run_folder.hpp"

namespace mottle::report {
namespace {

constexpr std::array k_browsers = {"chromium", "chromium-browser", "google-chrome", "google-chrome-stable",
                                   "microsoft-edge"};

constexpr const char* k_printed = "report.pdf";

std::filesystem::path find_browser() {
  for (const char* name : k_browsers) {
    std::filesystem::path program = find_program(name);
    if (!program.empty()) return program;
  }
  throw InvalidInput(fmt::format(
      "--pdf needs a browser to print with, and none of {} is on PATH; install one, or open report.html and "
      "print it: paper has the same summary",
      join({k_browsers.begin(), k_browsers.end()})));
}

/// The address of a file: all bytes but those of plain names are escaped.
std::string file_address(const std::filesystem::path& file) {
  std::string address = "file://";
  for (const char c : std::filesystem::absolute(file).string()) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' ||
                          c == '-' || c == '.' || c == '_';
    address += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return address;
}

}  // namespace

std::filesystem::path print_report(const std::filesystem::path& folder, const std::atomic<bool>* stop) {
  constexpr std::chrono::minutes k_patience{3};
  const std::filesystem::path browser = find_browser();
  require_own_result(folder / k_printed);
  const TemporaryFolder work;
  const std::filesystem::path printed = work.path() / "printed.pdf";
  // Chromium refuses to run as root with its sandbox; the page holds nothing but what Mottle wrote.
  const ProcessEnd end =
      run_process({.arguments = {browser.string(), "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
                                 "--no-pdf-header-footer", "--user-data-dir=" + (work.path() / "profile").string(),
                                 "--print-to-pdf=" + printed.string(), file_address(folder / "report.html")},
                   .directory = work.path(),
                   .timeout = k_patience,
                   .stop = stop});
  if (end.kind == ProcessEnd::Kind::stopped) throw Stopped("the report was not printed: stopped on request");
  if (end.kind != ProcessEnd::Kind::done || !std::filesystem::exists(printed)) {
    throw SystemFailure(fmt::format("{}: the browser did not print the report: {}", browser.string(),
                                    end.reason.empty() ? "it wrote no file" : end.reason));
  }
  const std::string bytes = read_file(printed);
  if (!bytes.starts_with("%PDF-")) {
    throw SystemFailure(
        fmt::format("{}: the browser did not print the report: what it wrote is no PDF", browser.string()));
  }
  const RunFolder results(folder);
  results.write(k_printed, bytes);
  return results.file(k_printed);
}

}  // namespace mottle::report
