// mottle completion: what shells need to complete verbs and options, made from the option tables themselves.
#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "common_options.hpp"
#include "mottle/core/text.hpp"

namespace mottle::app {
namespace {

struct Verb {
  std::string name, summary;
  std::vector<std::pair<std::string, std::string>> options;  ///< "--out", what it means
};

std::vector<Verb> verbs_of(const CLI::App& app) {
  std::vector<Verb> verbs;
  for (const CLI::App* verb : app.get_subcommands({})) {
    if (verb->get_group().empty()) continue;  // not for people
    Verb found{verb->get_name(), verb->get_description(), {}};
    for (const CLI::Option* option : verb->get_options()) {
      for (const std::string& name : option->get_lnames()) {
        found.options.emplace_back("--" + name, option->get_description());
      }
    }
    verbs.push_back(std::move(found));
  }
  return verbs;
}

std::string names_of(const Verb& verb) {
  std::vector<std::string> names;
  for (const auto& [name, meaning] : verb.options) names.push_back(name);
  return join(names, " ");
}

/// Within single quotes of a shell.
std::string in_quotes(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return safe;
}

void print_bash(const std::vector<Verb>& verbs) {
  std::vector<std::string> names;
  std::string cases;
  for (const Verb& verb : verbs) {
    names.push_back(verb.name);
    cases += fmt::format("    {}) words='{}' ;;\n", verb.name, names_of(verb));
  }
  fmt::print(R"(# Completion of mottle for bash: source it, or put it into a folder of bash-completion.
_mottle() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} words=''
  if ((COMP_CWORD == 1)); then
    COMPREPLY=($(compgen -W '{}' -- "$word"))
    return
  fi
  case ${{COMP_WORDS[1]}} in
{}  esac
  if [[ $word == -* ]]; then
    COMPREPLY=($(compgen -W "$words" -- "$word"))
  else
    compopt -o filenames 2>/dev/null
    word=${{word#[\"\']}}
    mapfile -t COMPREPLY < <(compgen -f -- "${{word//\\/}}")
  fi
}}
complete -F _mottle mottle
)",
             join(names, " "), cases);
}

void print_zsh(const std::vector<Verb>& verbs) {
  std::string list;
  std::string cases;
  const auto entry = [](const std::string& text) {
    std::string safe;
    for (const char c : in_quotes(text))
      safe += c == ':' || c == '[' || c == ']' ? std::string("\\") + c : std::string(1, c);
    return safe;
  };
  for (const Verb& verb : verbs) {
    list += fmt::format("    '{}:{}'\n", verb.name, entry(verb.summary));
    cases += fmt::format("    {})\n      _arguments", verb.name);
    for (const auto& [name, meaning] : verb.options) cases += fmt::format(" '{}[{}]'", name, entry(meaning));
    cases += " '*:file:_files' ;;\n";
  }
  fmt::print(R"(#compdef mottle
# Completion of mottle for zsh: put it as _mottle into a folder of $fpath.
_mottle() {{
  local -a verbs
  verbs=(
{}  )
  if ((CURRENT == 2)); then
    _describe 'verb' verbs
    return
  fi
  local verb=${{words[2]}}
  shift words
  ((CURRENT--))
  case $verb in
{}  esac
}}
_mottle "$@"
)",
             list, cases);
}

void print_fish(const std::vector<Verb>& verbs) {
  fmt::print("# Completion of mottle for fish: put it as mottle.fish into ~/.config/fish/completions.\n");
  for (const Verb& verb : verbs) {
    fmt::print("complete -c mottle -n __fish_use_subcommand -f -a {} -d '{}'\n", verb.name, in_quotes(verb.summary));
    for (const auto& [name, meaning] : verb.options) {
      fmt::print("complete -c mottle -n '__fish_seen_subcommand_from {}' -l {} -d '{}'\n", verb.name, name.substr(2),
                 in_quotes(meaning));
    }
  }
}

}  // namespace

void add_completion(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("completion", "print what bash, zsh or fish needs to complete verbs and options");
  const auto shell = std::make_shared<std::string>();
  verb->add_option("SHELL", *shell, "bash, zsh or fish")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
  verb->callback([shell, &app] {
    const std::vector<Verb> verbs = verbs_of(app);
    if (*shell == "bash") print_bash(verbs);
    if (*shell == "zsh") print_zsh(verbs);
    if (*shell == "fish") print_fish(verbs);
  });
}

}  // namespace mottle::app
