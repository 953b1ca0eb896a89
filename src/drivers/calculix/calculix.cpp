#include "mottle/drivers/calculix/calculix.hpp"

#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp is POSIX's

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <map>

#include "drivers/calculix/matrix_store.hpp"
#include "drivers/command/run_output.hpp"
#include "drivers/command/solver_process.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"
#include "mottle/drivers/calculix/separable_fit.hpp"

namespace mottle::drivers {
namespace {

namespace fs = std::filesystem;

/// More threads are slower on small models, and much slower beside other work.
std::map<std::string, std::string> one_thread() {
  return {{"OMP_NUM_THREADS", "1"}, {"OPENBLAS_NUM_THREADS", "1"}};
}

/// A folder of its own, gone at the end.
class PrivateFolder {
 public:
  PrivateFolder() {
    std::string name = (temporary_folder() / "mottle-ccx-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw SystemFailure(fmt::format("{}: cannot make a folder: {}", name, std::strerror(errno)));
    }
    path_ = name;
  }
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;
  ~PrivateFolder() {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// The last lines of what the solver printed, errors first.
std::string tail_of(const fs::path& folder) {
  constexpr std::size_t k_bytes = 1500;
  const std::string text = last_part(folder / k_standard_output) + last_part(folder / k_standard_error);
  const std::size_t error = text.rfind("*ERROR");
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

class CalculixProgram {
 public:
  explicit CalculixProgram(const CalculixSettings& settings)
      : settings_(settings), program_(find_program(settings.program)) {
    require_of(!program_.empty(), {Subject::Kind::program},
               "there is no program '{}' on the PATH; install CalculiX (Debian: calculix-ccx) or name its "
               "file",
               settings.program);
    const PrivateFolder folder;
    run({program_.string(), "-v"}, folder.path());
    version_ = last_part(folder.path() / k_standard_output);  // whatever its exit status: 201 of version 2.20
    if (version_.empty()) fail("it does not say its version (-v)", folder.path());
  }

  MatrixRun matrices(const std::string& deck) {
    Checksum checksum;
    checksum.add(version_);
    checksum.add(deck);
    const Digest digest = checksum.digest();
    if (auto found = find_run(settings_.cache, digest)) {
      ++reused_;
      return std::move(*found);
    }
    const PrivateFolder folder;
    write_file_atomically(folder.path() / "model.inp", deck);
    const ProcessEnd end = run({program_.string(), "model"}, folder.path());
    if (end.kind == ProcessEnd::Kind::stopped) throw Stopped("stopped on request");
    if (end.kind != ProcessEnd::Kind::done) {
      fail(end.kind == ProcessEnd::Kind::timed_out
               ? fmt::format("not done in {} s", 1e-3 * static_cast<double>(settings_.timeout.count()))
               : end.reason,
           folder.path());
    }
    ++runs_;
    MatrixRun result;
    try {
      result = read_stored(folder.path());
    } catch (const InvalidInput& error) {
      fail(fmt::format("what it stored cannot be read: {}", error.what()), folder.path());
    }
    keep_run(settings_.cache, digest, result);
    return result;
  }

  int runs() const { return runs_; }
  int reused() const { return reused_; }

 private:
  [[noreturn]] void fail(const std::string& reason, const fs::path& folder) const {
    throw SystemFailure(
        fmt::format("{}: {}; the end of what it printed:\n{}", settings_.program, reason, tail_of(folder)));
  }

  [[noreturn]] void fail_short(const std::string& reason, const fs::path& folder) const {
    fail(fmt::format("{}; is the disk of {} full?", reason, folder.string()), folder);
  }

  /// The bytes of a file that it stored, to the last line end.
  std::string stored(const fs::path& folder, const char* name) const {
    if (!fs::exists(folder / name)) fail("it stored no matrices", folder);
    std::string bytes = read_file(folder / name);
    if (!bytes.ends_with('\n')) fail_short(fmt::format("{} is cut short", name), folder);
    return bytes;
  }

  /// CalculiX ends with status 0 where the disk was full. It stores every diagonal entry and the same entries of both
  /// matrices: that is compared with the list of rows before anything is kept.
  MatrixRun read_stored(const fs::path& folder) const {
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

  ProcessEnd run(const std::vector<std::string>& arguments, const fs::path& folder) const {
    return run_process({.arguments = arguments,
                        .directory = folder,
                        .environment = one_thread(),
                        .timeout = settings_.timeout,
                        .stop = settings_.stop});
  }

  CalculixSettings settings_;
  fs::path program_;
  std::string version_;
  int runs_ = 0;
  int reused_ = 0;
};

/// What a parameter sets.
struct Setting {
  std::vector<CalculixNumber> numbers;
  bool is_factor = false;
};

std::vector<Setting> find_settings(const CalculixDeck& deck, const std::vector<ParameterTargets>& parameters) {
  std::vector<Setting> settings;
  std::map<std::pair<std::size_t, std::size_t>, std::string> owners;
  for (const ParameterTargets& parameter : parameters) {
    Setting& setting = settings.emplace_back();
    setting.is_factor = parameter.is_factor;
    const Subject subject = subject_parameter(parameter.parameter);
    for (const std::string& target : parameter.targets) {
      std::vector<CalculixNumber> numbers;
      try {
        numbers = find_calculix_numbers(deck, target);
      } catch (const FormatError&) {
        throw;
      } catch (const InvalidInput& error) {
        throw SubjectError(subject, fmt::format("it acts on nothing: {}", error.what()));
      }
      for (const CalculixNumber& number : numbers) {
        require_of(parameter.is_factor || number.temperatures == 1, subject,
                   "'{}' ({}) has a value at each of {} temperatures; relative = true multiplies all of them, "
                   "{{{{name}}}} in the deck in place of one of them sets it alone",
                   target, deck.where(number.line), number.temperatures);
        const auto [owner, is_new] = owners.emplace(std::pair{number.line, number.begin}, parameter.parameter);
        require_of(is_new, subject, "target '{}' ({}) is already tied to parameter '{}'", target,
                   deck.where(number.line), owner->second);
        require_of(!parameter.is_factor || !number.is_placeholder, subject,
                   "'{}' has no value in the deck that a factor could multiply", target);
        require_of(!parameter.is_factor || number.value != 0.0, subject,
                   "a factor on '{}', whose nominal value is 0, acts on nothing", target);
        setting.numbers.push_back(number);
      }
    }
    require_of(!setting.numbers.empty(), subject, "it has no target, so it acts on nothing");
  }
  return settings;
}

double nominal_of(const Setting& setting, double fallback) {
  if (setting.is_factor) return 1.0;
  const double first = setting.numbers.front().value;
  const bool is_one = std::all_of(setting.numbers.begin(), setting.numbers.end(),
                                  [&](const CalculixNumber& number) { return number.value == first; });
  return is_one ? first : fallback;
}

}  // namespace

MatrixModel calculix_model(const CalculixDeck& deck, const std::vector<ParameterTargets>& parameters,
                           const Eigen::VectorXd& fallback, const CalculixSettings& settings) {
  const std::vector<Setting> moved = find_settings(deck, parameters);
  if (const std::string reason = needs_earlier_steps(deck); !reason.empty()) throw NotSeparable(reason);
  for (const ParameterTargets& parameter : parameters) {
    for (const std::string& target : parameter.targets) {
      if (!calculix_field(target).starts_with("NU")) continue;
      throw NotSeparable(
          fmt::format("parameter '{}': '{}' enters the matrices by no powers", parameter.parameter, target));
    }
  }
  MatrixModel model;
  model.reference.resize(fallback.size());
  model.limits.resize(parameters.size());
  std::vector<FitAxis> axes;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const auto p = static_cast<Eigen::Index>(i);
    model.reference(p) = nominal_of(moved[i], fallback(p));
    require_of(model.reference(p) != 0.0, subject_parameter(parameters[i].parameter),
               "its nominal value is 0; CalculiX cannot be run there");
    const auto& targets = parameters[i].targets;
    axes.push_back({parameters[i].parameter, model.reference(p),
                    std::any_of(targets.begin(), targets.end(),
                                [](const std::string& target) { return calculix_field(target) == "T"; })});
  }
  CalculixProgram solver(settings);
  SeparableFit fit = fit_separable(axes, [&](const Eigen::VectorXd& values) {
    std::vector<CalculixChange> changes;
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const double x = values(static_cast<Eigen::Index>(i));
      for (const CalculixNumber& number : moved[i].numbers) {
        changes.push_back({number, moved[i].is_factor ? x * number.value : x});
      }
    }
    return solver.matrices(matrix_storage_deck(deck, changes));
  });
  model.pencil = std::move(fit.pencil);
  model.notes.push_back(fmt::format(
      "CalculiX: matrices from {} decks ({} runs, {} from the cache); for a deck that was not used for the fit "
      "they agree to {:.1e} of their diagonal",
      fit.runs, solver.runs(), solver.reused(), fit.error));
  return model;
}

SolverCommand calculix_command(const CalculixDeck& deck, const std::vector<ParameterTargets>& parameters,
                               const CalculixSettings& settings) {
  const std::vector<Setting> moved = find_settings(deck, parameters);
  std::vector<CalculixReplacement> replacements;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    for (const CalculixNumber& number : moved[i].numbers) {
      const std::string factor = moved[i].is_factor ? fmt::format("*{}", number_text(number.value)) : "";
      replacements.push_back({number, fmt::format("{{{{{}{}:%20.13e}}}}", parameters[i].parameter, factor)});
    }
  }
  SolverCommand command;
  command.templates = {{deck.files.front(), "model.inp", deck_with_replacements(deck, replacements)}};
  command.command.arguments = {settings.program, "model"};
  command.environment = one_thread();
  command.timeout = settings.timeout;
  command.parallel = settings.parallel;
  command.frequencies = {.file = "model.dat", .format = FrequencyRule::Format::calculix};
  if (writes_displacements(deck)) command.shapes = {.file = "model.frd", .format = ShapeRule::Format::calculix};
  return command;
}

}  // namespace mottle::drivers
