// Makes pages of results: report.html of a run's folder, modes.html, diagnosis.html, and several runs side by side.
#pragma once

#include <atomic>
#include <filesystem>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/compare.hpp"

namespace mottle::report {

/// Reads result.json, tests.csv and clouds.csv of `folder` and writes report.html beside them. It links diagnosis.html
/// there, where that is a diagnosis beside the same parameters.
///
/// Throws InvalidInput: no result.json there, or one of these files cannot be understood; SystemFailure: cannot write.
void write_report(const std::filesystem::path& folder);

/// Prints report.html of `folder` to report.pdf beside it, by a Chromium of this machine: the page's summary for paper,
/// which has two pages.
///
/// @param stop  ends the printing early; null: nothing does
/// @returns the file
/// @throws InvalidInput   there is no browser
/// @throws SystemFailure  it fails, or writes no PDF; Stopped
std::filesystem::path print_report(const std::filesystem::path& folder, const std::atomic<bool>* stop = nullptr);

/// Reads modes.json of `folder` and writes modes.html beside it.
void write_modes_page(const std::filesystem::path& folder);

/// Reads diagnosis.json and diagnosis-model.json of `folder` and writes diagnosis.html beside them.
///
/// @throws InvalidInput   one of these files cannot be understood
/// @throws SystemFailure  cannot write
void write_diagnosis_page(const std::filesystem::path& folder);

/// Reads result.json of every compared run and writes one page that shows them side by side.
///
/// @param summary  of the comparison, which compares the evidences
/// @param page     file to write; the runs' own reports are linked relative to it
/// Throws InvalidInput: a result that cannot be understood; SystemFailure: cannot write.
void write_comparison_page(const Comparison& comparison, const RunSummary& summary, const std::filesystem::path& page);

}  // namespace mottle::report
