// The command: calls the verb with its arguments and turns exceptions into a message and an exit code.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "blas_threads.hpp"
#include "common_options.hpp"
#include "job_ranks.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/core/utf8.hpp"
#include "mottle/linalg/blas_kernels.hpp"
#include "mottle/study/jobs/study_objects.hpp"

namespace {

constexpr int k_wrong_input = 2;
constexpr int k_failed = 3;
constexpr int k_our_bug = 70;
constexpr std::size_t k_longest_message = 2500;  // of bytes; CalculiX may have said 1500 of them

/// The exit code, once all ranks have come to the end.
int end(const mottle::RankEnd& own) {
  const mottle::RankEnd end = mottle::app::end_job(own);
  if (!end.message.empty()) mottle::app::tell(fmt::format("mottle: {}\n", end.message));
  return end.code;
}

/// Lines stay lines: what a solver said at the end is shown as it said it.
int fail(int code, const std::string& message) {
  std::string text;
  for (std::size_t begin = 0; begin <= message.size();) {
    const std::size_t end = std::min(message.find('\n', begin), message.size());
    text += (begin > 0 ? "\n" : "") + mottle::printable(std::string_view(message).substr(begin, end - begin));
    begin = end + 1;
  }
  return end({.code = code, .message = mottle::shortened(text, k_longest_message)});
}

/// CLI11 only says that a verb is required.
void require_known_verb(CLI::App& app, const std::string& word) {
  std::vector<std::string> verbs;
  for (const CLI::App* verb : app.get_subcommands({})) {
    if (verb->get_name() == word) return;
    if (!verb->get_group().empty()) verbs.push_back(verb->get_name());
  }
  const bool is_known = word.starts_with('-');
  if (!is_known) throw mottle::InvalidInput(mottle::unknown_name_message("verb", word, verbs));
}

/// Verbs that ranks do together; the others are the first one's.
bool is_shared_verb(int argc, char** argv) {
  const std::string_view verb = argc > 1 ? argv[1] : "";
  return verb == "update" || verb == "propagate" || verb == "diagnose";
}

int run(int argc, char** argv) {
  CLI::App app("Mottle: stochastic finite-element model updating", "mottle");
  app.set_version_flag("--version", "mottle " + mottle::study::version());
  app.require_subcommand(1);
  app.footer("Exit codes: 0 done, 2 wrong input, 3 a solver or file failed, 4 stopped (resumable), 70 a bug.");
  struct Group {
    const char* title;
    std::vector<void (*)(CLI::App&)> verbs;
  };
  const Group groups[] = {
      {"From a deck and tests to a study",
       {mottle::app::add_modes, mottle::app::add_targets, mottle::app::add_init, mottle::app::add_check}},
      {"Updating", {mottle::app::add_update, mottle::app::add_diagnose}},
      {"The model alone", {mottle::app::add_propagate, mottle::app::add_simulate}},
      {"On a cluster", {mottle::app::add_status, mottle::app::add_cancel}},
      {"Results", {mottle::app::add_report, mottle::app::add_compare, mottle::app::add_export}},
      {"Help", {mottle::app::add_methods, mottle::app::add_completion}},
  };
  for (const Group& group : groups) {
    for (const auto add : group.verbs) {
      add(app);
      app.get_subcommands({}).back()->group(group.title);
    }
  }
  mottle::app::add_run_task(app);
  if (argc > 1) require_known_verb(app, argv[1]);
  if (mottle::app::is_silent_rank() && !is_shared_verb(argc, argv)) return 0;
  try {
    app.parse(argc, argv);
  } catch (const CLI::RuntimeError& error) {  // a verb's own exit code
    return error.get_exit_code();
  } catch (const CLI::ParseError& error) {
    const bool is_help = error.get_exit_code() == 0;
    if (!mottle::app::is_silent_rank()) app.exit(error);
    return is_help ? 0 : k_wrong_input;
  }
  if (std::fflush(stdout) != 0) {
    throw mottle::SystemFailure(fmt::format("what is printed cannot be written: {}", std::strerror(errno)));
  }
  return 0;
}

/// A file opened in place of a closed standard stream would be written over by messages.
void open_standard_streams() {
  for (int descriptor = 0; descriptor < 3; ++descriptor) {
    if (::fcntl(descriptor, F_GETFD) == -1) (void)::open("/dev/null", descriptor == 0 ? O_RDONLY : O_WRONLY);
  }
}

constexpr std::string_view k_no_memory =
    "the memory does not suffice for this study; lower update.samples or take a larger machine";

/// For errors that cannot be caught: in another library's thread, or while another one is reported.
[[noreturn]] void end_by_nobody() {
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    for (const std::string_view part : {std::string_view("mottle: "), k_no_memory, std::string_view("\n")}) {
      (void)!::write(STDERR_FILENO, part.data(), part.size());
    }
    ::_exit(k_failed);
  } catch (...) {  // NOLINT(bugprone-empty-catch): reported below as the system does
  }
  std::abort();
}

}  // namespace

int main(int argc, char** argv) {
  std::set_terminate(end_by_nobody);
  open_standard_streams();
  mottle::app::leave_out_blas_threads(argv);
  mottle::linalg::choose_blas_kernels();
  mottle::app::catch_signals();
  try {
    return end({.code = run(argc, argv), .message = {}});
  } catch (const mottle::InvalidInput& error) {
    return fail(k_wrong_input, error.what());
  } catch (const mottle::SystemFailure& error) {
    return fail(k_failed, error.what());
  } catch (const mottle::Stopped& error) {
    return fail(mottle::app::k_stopped, fmt::format("{}; go on with --resume", error.what()));
  } catch (const std::bad_alloc&) {
    return fail(k_failed, std::string(k_no_memory));
  } catch (const std::system_error& error) {  // files, threads, descriptors: the machine's answers
    return fail(k_failed, fmt::format("the system refuses: {}", error.what()));
  } catch (const std::exception& error) {
    return fail(k_our_bug, fmt::format("this is a bug of Mottle, please report it: {}", error.what()));
  }
}
