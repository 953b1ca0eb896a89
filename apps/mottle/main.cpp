// The command: hands the arguments to a verb and turns what is thrown into a message and an exit code.
#include <fmt/format.h>

#include <exception>

#include "common_options.hpp"
#include "mottle/core/error.hpp"
#include "mottle/study/study_objects.hpp"

namespace {

constexpr int k_wrong_input = 2;
constexpr int k_failed = 3;
constexpr int k_stopped = 4;
constexpr int k_our_bug = 70;

int fail(int code, const std::string& message) {
  fmt::print(stderr, "mottle: {}\n", message);
  return code;
}

int run(int argc, char** argv) {
  CLI::App app("Mottle: stochastic finite-element model updating", "mottle");
  app.set_version_flag("--version", "mottle " + mottle::version());
  app.require_subcommand(1);
  app.footer("Exit codes: 0 done, 2 wrong input, 3 a solver or file failed, 4 stopped (resumable), 70 a bug.");
  mottle::app::add_update(app);
  mottle::app::add_propagate(app);
  mottle::app::add_simulate(app);
  mottle::app::add_check(app);
  mottle::app::add_report(app);
  mottle::app::add_methods(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : k_wrong_input;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  mottle::app::catch_signals();
  try {
    return run(argc, argv);
  } catch (const mottle::InvalidInput& error) {
    return fail(k_wrong_input, error.what());
  } catch (const mottle::SystemFailure& error) {
    return fail(k_failed, error.what());
  } catch (const mottle::Stopped& error) {
    return fail(k_stopped, fmt::format("{}; go on with --resume", error.what()));
  } catch (const std::exception& error) {
    return fail(k_our_bug, fmt::format("this is a bug of Mottle, please report it: {}", error.what()));
  }
}
