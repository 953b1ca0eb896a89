// The study that `mottle init` writes for a solver by command: what only its user knows is marked.
#include "study/results/init_text.hpp"

namespace mottle::study {
namespace {

/// Name of a filled-in template in the folder of a run.
std::string name_in_run(const std::filesystem::path& model) {
  std::filesystem::path name = model.filename();
  if (name.extension() == ".in" || name.extension() == ".template") name.replace_extension();
  return name.string();
}

std::string template_model_text(const InitSettings& settings) {
  std::string text = fmt::format(
      "\n[model]\nkind = \"command\"\n"
      "templates = [{}]   # placeholders are filled in for each run\n"
      "# files = [\"mesh.inc\"]            # UNKNOWN: other files that a run needs, copied as they are\n"
      "command = [\"UNKNOWN\", {}]   # UNKNOWN: the program and its arguments, as you would type them\n",
      toml_string(relative_path(settings.model, settings.study)), toml_string(name_in_run(settings.model)));
  text +=
      "timeout = \"10 min\"              # GUESSED\n"
      "\n[model.frequencies]             # how a run's frequencies are read, see docs/howto/any-solver.md\n"
      "file = \"UNKNOWN\"                # UNKNOWN: the file that a run leaves\n"
      "format = \"column\"               # or \"csv\", \"json\", \"regex\", \"f06\", \"punch\", \"calculix\"\n"
      "# after = \"E I G E N V A L U E\"   # a text in an earlier line; without it the table begins with the file\n"
      "line = 1                        # rows below that text\n"
      "column = \"UNKNOWN\"             # UNKNOWN: the table's column of frequencies, counted from 1\n"
      "quantity = \"Hz\"                 # or \"rad/s\", \"eigenvalue\"\n"
      "\n# [model.shapes]                # UNKNOWN: with shapes, modes are followed where they cross\n"
      "# file = \"shapes.csv\"\n"
      "# format = \"csv\"\n";
  return text;
}

std::string template_outputs_text(const InitOutcome& outcome) {
  std::string text =
      "\n[outputs]\n# UNKNOWN: which of the model's modes the tests' modes are; the solver was not run.\n";
  return text + fmt::format("frequencies = [{}]\n",
                            listed(outcome.modes, [](const InitMode& mode) { return fmt::format("{}", mode.mode); }));
}

std::string template_test_text(const InitSettings& settings) {
  if (settings.tests.empty())
    return "\n# [test]                        # UNKNOWN: no tests were given\n# file = \"tests.csv\"\n";
  return fmt::format(
      "\n[test]\nfile = {}\n"
      "# pairing = \"frequency\"         # if the columns count modes otherwise than the model\n"
      "# repeatability = {{ \"f*\" = \"0.1 %\" }}   # UNKNOWN: the scatter of repeated tests of one specimen\n",
      test_files_text(settings));
}

}  // namespace

std::string template_study_text(const InitOutcome& outcome) {
  const InitSettings& settings = outcome.settings;
  std::string text =
      "# Proposed by `mottle init`. What is UNKNOWN is for you to fill in; `mottle check` says what is missing, and "
      "does "
      "one run.\n";
  text += fmt::format("title = {}\n", toml_string(settings.model.stem().string()));
  text += fmt::format("units = {}{}\n", toml_string(*settings.units),
                      outcome.units_reason.empty() ? "" : fmt::format("   # {}", outcome.units_reason));
  text += template_model_text(settings) + template_outputs_text(outcome) + template_test_text(settings);
  text += outcome.specimens == 1
              ? "\n[update]\nmethod = \"deterministic\"          # one specimen has no scatter to explain\n"
              : "\n[update]\nmethod = \"maximum-likelihood\"\n";
  for (const InitParameter& parameter : outcome.parameters) {
    text += fmt::format(
        "\n[[parameter]]\nname = {0}\n"
        "# UNKNOWN: the value of {{{{{1}}}}} as you know it, and how far it may be off\n"
        "distribution = {{ kind = \"lognormal\", mean = \"UNKNOWN\", std = \"UNKNOWN\" }}\n",
        toml_string(parameter.name), parameter.name);
  }
  return text;
}

}  // namespace mottle::study
