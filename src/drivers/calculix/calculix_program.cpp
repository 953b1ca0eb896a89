#include "drivers/calculix/calculix_program.hpp"

#include <algorithm>

#include "drivers/calculix/matrix_store.hpp"
#include "drivers/command/run_output.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"
#include "mottle/drivers/command/solver_process.hpp"
#include "mottle/formats/calculix/results.hpp"

namespace mottle::drivers {
namespace {

namespace fs = std::filesystem;

/// What the solver printed from its first error on, since the last one only says that there were others; the last lines
/// where there is none.
std::string tail_of(const fs::path& folder) {
  constexpr std::size_t k_bytes = 1500;
  const std::string text = last_part(folder / k_standard_output) + last_part(folder / k_standard_error);
  const std::size_t error = text.find("*ERROR");
  if (error != std::string::npos) return text.substr(error, k_bytes);
  return text.size() > k_bytes ? text.substr(text.size() - k_bytes) : text;
}

Eigen::Index diagonal_entries(const SparseMatrix& lower) {
  Eigen::Index count = 0;
  for (int j = 0; j < lower.outerSize(); ++j) {
    const SparseMatrix::InnerIterator first(lower, j);
    if (first && first.row() == j) ++count;
  }
  return count;
}

/// Cards of which it printed "Card image cannot be interpreted", as it prints them: in capitals, without blanks.
std::vector<std::string> unknown_cards(std::string_view printed) {
  constexpr std::string_view k_warning = "Card image cannot be";
  constexpr std::string_view k_image = "Card image:";
  std::vector<std::string> cards;
  for (std::size_t at = printed.find(k_warning); at != std::string_view::npos; at = printed.find(k_warning, at + 1)) {
    const std::size_t image = printed.find(k_image, at);
    if (image == std::string_view::npos) break;
    const std::size_t begin = printed.find_first_not_of(" \n", image + k_image.size());
    if (begin == std::string_view::npos) break;
    const std::string_view card = printed.substr(begin, printed.find_first_of(" \n", begin) - begin);
    if (card.starts_with('*') && std::ranges::find(cards, card) == cards.end()) cards.emplace_back(card);
  }
  return cards;
}

/// "plate.inp:12: *ROTARYINERTIA,ELSET=Q"
std::string located(const CalculixDeck& deck, const std::string& card) {
  for (std::size_t line = 0; line < deck.lines.size(); ++line) {
    std::string text = capitals(deck.lines[line].text);
    std::erase_if(text, [](char letter) { return letter == ' ' || letter == '\t'; });
    if (text == card) return fmt::format("{}: {}", deck.where(line), card);
  }
  return card;
}

void require_none(const std::vector<std::string>& unknown, const CalculixDeck& deck) {
  std::vector<std::string> cards;
  for (const std::string& card : unknown) cards.push_back(located(deck, card));
  require_of(cards.empty(), {Subject::Kind::model},
             "CalculiX does not know {}, and would give the modes of the structure without it; say the same with cards "
             "that CalculiX has, or take it out",
             join(cards));
}

}  // namespace

std::map<std::string, std::string> one_thread() {
  return {{"OMP_NUM_THREADS", "1"}, {"OPENBLAS_NUM_THREADS", "1"}};
}

CalculixProgram::CalculixProgram(const CalculixSettings& settings, const CalculixDeck& deck)
    : settings_(settings), deck_(deck), program_(find_program(settings.program)) {
  require_of(!program_.empty(), {Subject::Kind::program},
             "there is no program '{}' on the PATH; install CalculiX (Debian: calculix-ccx) or name its "
             "file",
             settings.program);
  const TemporaryFolder folder;
  run({program_.string(), "-v"}, folder.path());
  version_ = last_part(folder.path() / k_standard_output);  // whatever its exit status: 201 of version 2.20
  if (version_.empty()) fail("it does not say its version (-v)", folder.path());
}

MatrixRun CalculixProgram::matrices(const std::string& text) {
  const Digest digest = digest_of(text);
  if (auto found = find_run(settings_.cache, digest)) {
    ++reused_;
    return std::move(*found);
  }
  const TemporaryFolder folder;
  const ProcessEnd end = run_deck(text, folder.path());
  if (end.kind != ProcessEnd::Kind::done) {
    fail(end.kind == ProcessEnd::Kind::timed_out
             ? fmt::format("not done in {} s", 1e-3 * static_cast<double>(settings_.timeout.count()))
             : end.reason,
         folder.path());
  }
  ++runs_;
  require_none(unknown_cards(read_file(folder.path() / k_standard_output)), deck_);
  MatrixRun result;
  try {
    result = read_stored(folder.path());
  } catch (const InvalidInput& error) {
    fail(fmt::format("what it stored cannot be read: {}", error.what()), folder.path());
  }
  keep_run(settings_.cache, digest, result);
  return result;
}

Eigen::VectorXd CalculixProgram::eigenvalues(const std::string& text) {
  const Digest digest = digest_of(text);
  if (const auto found = find_eigenvalues(settings_.cache, digest)) return *found;
  const TemporaryFolder folder;
  if (run_deck(text, folder.path()).kind != ProcessEnd::Kind::done) return {};
  Eigen::VectorXd eigenvalues;
  try {
    eigenvalues = parse_calculix_eigenvalues(read_file(folder.path() / "model.dat"), "model.dat");
  } catch (const InvalidInput&) {
    return {};
  }
  if (eigenvalues.isZero(0.0)) return {};  // what it writes where its solver failed
  keep_eigenvalues(settings_.cache, digest, eigenvalues);
  return eigenvalues;
}

void CalculixProgram::require_known_cards(const std::string& text) {
  const TemporaryFolder folder;
  run_deck(text, folder.path());
  require_none(unknown_cards(read_file(folder.path() / k_standard_output)), deck_);
}

Digest CalculixProgram::digest_of(const std::string& text) const {
  Checksum checksum;
  checksum.add(version_);
  checksum.add(text);
  return checksum.digest();
}

void CalculixProgram::fail(const std::string& reason, const fs::path& folder) const {
  throw SystemFailure(
      fmt::format("{}: {}; the end of what it printed:\n{}", settings_.program, reason, tail_of(folder)));
}

void CalculixProgram::fail_short(const std::string& reason, const fs::path& folder) const {
  fail(fmt::format("{}; is the disk of {} full?", reason, folder.string()), folder);
}

/// The bytes of a file that it stored, to the last line end.
std::string CalculixProgram::stored(const fs::path& folder, const char* name) const {
  if (!fs::exists(folder / name)) fail("it stored no matrices", folder);
  std::string bytes = read_file(folder / name);
  if (!bytes.ends_with('\n')) fail_short(fmt::format("{} is cut short", name), folder);
  return bytes;
}

/// CalculiX ends with status 0 where the disk was full. It stores every diagonal entry and the same entries of both
/// matrices: that is compared with the list of rows before anything is kept.
MatrixRun CalculixProgram::read_stored(const fs::path& folder) const {
  const std::string stiffness = stored(folder, "model.sti");
  const std::string mass = stored(folder, "model.mas");
  const std::vector<std::string> names = parse_row_names(stored(folder, "model.dof"), "model.dof");
  const auto lines = std::ranges::count(stiffness, '\n');
  const auto mass_lines = std::ranges::count(mass, '\n');
  if (lines != mass_lines) {
    fail_short(fmt::format("model.sti has {} entries, model.mas {}", lines, mass_lines), folder);
  }
  MatrixRun run{parse_symmetric_matrix(stiffness, "model.sti", ""), parse_symmetric_matrix(mass, "model.mas", "")};
  const Eigen::Index rows = diagonal_entries(run.stiffness.lower);
  if (rows != static_cast<Eigen::Index>(names.size()) || run.stiffness.lower.rows() != rows) {
    fail_short(fmt::format("model.sti has {} diagonal entries, model.dof {} rows", rows, names.size()), folder);
  }
  run.stiffness.names = names;
  run.mass.names = names;
  return run;
}

ProcessEnd CalculixProgram::run_deck(const std::string& text, const fs::path& folder) const {
  write_file_atomically(folder / "model.inp", text);
  ProcessEnd end = run({program_.string(), "model"}, folder);
  if (end.kind == ProcessEnd::Kind::stopped) throw Stopped("stopped on request");
  return end;
}

ProcessEnd CalculixProgram::run(const std::vector<std::string>& arguments, const fs::path& folder) const {
  return run_process({.arguments = arguments,
                      .directory = folder,
                      .environment = one_thread(),
                      .timeout = settings_.timeout,
                      .stop = settings_.stop});
}

}  // namespace mottle::drivers
