// Shell completions, from the declarations of the command line.
#include <fmt/core.h>

#include <algorithm>

#include "cli/command_docs.hpp"
#include "cli/options.hpp"

namespace packmpi::cli {
namespace {

// In single quotes of a shell.
std::string in_quotes(std::string_view text) {
  std::string out;
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out;
}

std::string joined(const std::vector<std::string>& words, std::string_view between) {
  std::string out;
  for (const std::string& word : words) {
    if (!out.empty()) out += between;
    out += word;
  }
  return out;
}

std::vector<std::string> option_names(const CommandWords& command) {
  std::vector<std::string> names{"--help"};
  for (const OptionWords& option : command.options) names.insert(names.end(), option.names.begin(), option.names.end());
  return names;
}

std::vector<std::string> choices(const CommandWords& command) {
  std::vector<std::string> words;
  for (const OptionWords& a : command.arguments) words.insert(words.end(), a.choices.begin(), a.choices.end());
  return words;
}

std::string command_names() {
  std::vector<std::string> names;
  for (const CommandWords& command : command_words()) names.push_back(command.name);
  return joined(names, " ");
}

std::string bash() {
  std::string cases;
  for (const CommandWords& c : command_words()) {
    cases += fmt::format("    {}) options='{}' words='{}' ;;\n", c.name, joined(option_names(c), " "),
                         joined(choices(c), " "));
  }
  return fmt::format(
      "# bash completion of packmpi\n"
      "_packmpi() {{\n"
      "  local word=${{COMP_WORDS[COMP_CWORD]}} command=run options words\n"
      "  case \" {0} \" in *\" ${{COMP_WORDS[1]}} \"*) (( COMP_CWORD > 1 )) && command=${{COMP_WORDS[1]}} ;; esac\n"
      "  case $command in\n{1}  esac\n"
      "  if [[ $word == -* ]]; then\n"
      "    COMPREPLY=($(compgen -W \"$options\" -- \"$word\"))\n"
      "  else\n"
      "    COMPREPLY=($(compgen -W \"$words\" -- \"$word\") $(compgen -f -- \"$word\"))\n"
      "    (( COMP_CWORD == 1 )) && COMPREPLY+=($(compgen -W '{0}' -- \"$word\"))\n"
      "  fi\n"
      "}}\n"
      "complete -o filenames -F _packmpi packmpi\n",
      command_names(), cases);
}

std::string zsh_option(const OptionWords& option) {
  std::string text = option.text;
  std::ranges::replace(text, '[', '(');
  std::ranges::replace(text, ']', ')');
  const std::string value = option.value.empty() ? "" : fmt::format(":{}:_files", option.value);
  const std::string names = option.names.size() > 1 ? fmt::format("'*'{{{}}}", joined(option.names, ","))
                                                    : fmt::format("'*'{}", option.names.front());
  return fmt::format("{}'[{}]{}'", names, in_quotes(text), value);
}

std::string zsh() {
  std::string commands, cases;
  for (const CommandWords& c : command_words()) {
    commands += fmt::format("    '{}:{}'\n", c.name, in_quotes(c.text));
    std::vector<std::string> specs{"'--help[print help]'"};
    for (const OptionWords& option : c.options) specs.push_back(zsh_option(option));
    for (const OptionWords& a : c.arguments) {
      specs.push_back(a.choices.empty() ? fmt::format("':{}:_files'", a.names.front())
                                        : fmt::format("':{}:({})'", a.names.front(), joined(a.choices, " ")));
    }
    cases += fmt::format("    {}) _arguments {} ;;\n", c.name, joined(specs, " "));
  }
  return fmt::format(
      "#compdef packmpi\n"
      "_packmpi() {{\n"
      "  local -a commands=(\n{0}  )\n"
      "  if (( CURRENT == 2 )); then\n"
      "    _describe command commands\n"
      "    _files -g '*.toml'\n"
      "    return\n"
      "  fi\n"
      "  local command=$words[2]\n"
      "  if (( ${{commands[(I)$command:*]}} )); then shift words; (( CURRENT-- )); else command=run; fi\n"
      "  case $command in\n{1}  esac\n"
      "}}\n"
      "compdef _packmpi packmpi\n",
      commands, cases);
}

std::string fish() {
  std::string out = "# fish completion of packmpi\n";
  const std::string all = command_names();
  for (const CommandWords& c : command_words()) {
    out += fmt::format("complete -c packmpi -n 'not __fish_seen_subcommand_from {}' -a {} -d '{}'\n", all, c.name,
                       in_quotes(c.text));
    // Without a command the options are those of run.
    const std::string here =
        c.name == "run" ? fmt::format("__fish_seen_subcommand_from run; or not __fish_seen_subcommand_from {}", all)
                        : "__fish_seen_subcommand_from " + c.name;
    for (const OptionWords& option : c.options) {
      std::string names;
      for (const std::string& name : option.names) {
        names += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      }
      out += fmt::format("complete -c packmpi -n '{}'{}{} -d '{}'\n", here, names, option.value.empty() ? "" : " -r",
                         in_quotes(option.text));
    }
    if (const auto words = choices(c); !words.empty()) {
      out += fmt::format("complete -c packmpi -n '{}' -f -a '{}'\n", here, joined(words, " "));
    }
  }
  return out;
}

}  // namespace

std::string completion(std::string_view shell) { return shell == "bash" ? bash() : shell == "zsh" ? zsh() : fish(); }

}  // namespace packmpi::cli
