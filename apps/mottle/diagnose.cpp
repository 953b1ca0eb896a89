// mottle diagnose
#include <fmt/format.h>

#include <memory>

#include "common_options.hpp"

namespace mottle::app {

void add_diagnose(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("diagnose", "say which parameter is missing, and which can be seen");
  const auto options = std::make_shared<CommonOptions>();
  add_common_options(*verb, *options);
  verb->callback([options] {
    const Study study = read_study(*options);
    Console console(options->quiet);
    print_summary(*options, run_diagnose(study, run_settings(*options, console)));
  });
}

}  // namespace mottle::app
