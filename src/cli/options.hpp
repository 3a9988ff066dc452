/// The command line as a plain struct.
#pragma once
#include <string>
#include <variant>
#include <vector>

#include "exporters/convert.hpp"
#include "forecast/estimate.hpp"
#include "run/options.hpp"

namespace packmpi::cli {

enum class Command { run, check, estimate, limits, info, analyze, convert, init, tool, schema, manual, completion };

/// What the user asked on the command line.
struct Request {
  Command command = Command::run;
  std::string name = "run";           ///< of the command, as it is written
  run::Options run;                   ///< of run; its scene is the file of info, analyze and init, too
  int dimension = 3;                  ///< of the scene that init writes
  exporters::ConvertRequest convert;  ///< convert: all of it but `force`
  forecast::Question question;        ///< estimate; its json is that of limits, too
  std::string shell;                  ///< completion: "bash", "zsh" or "fish"
};

/// Text to print and the exit code, for --help, --version, usage errors, schema, manual and completion.
struct Reply {
  std::string text;
  int code = 0;
};

/// Local and pure: every rank sees the same argv and gets the same answer.
[[nodiscard]] std::variant<Request, Reply> parse_command_line(int argc, const char* const* argv);

/// One option or positional argument, as documented.
struct OptionWords {
  std::vector<std::string> names;    ///< "-o", "--output"; of an argument its name alone, "SCENE"
  std::string value;                 ///< what follows it, "FOLDER"; "" for a flag
  std::vector<std::string> choices;  ///< the words it takes, if they are few
  std::string text;
};

/// A line of a list in the help and the manual.
struct EndWords {
  std::string term, text;
};

/// One command of the program, as documented.
struct CommandWords {
  std::string name;
  std::string text;
  std::vector<OptionWords> arguments;  ///< positional
  std::vector<OptionWords> options;    ///< without --help
  std::vector<EndWords> table;         ///< what else its help lists, a line each
};

/// All commands with all their options, from the declarations that the parser uses. Local.
[[nodiscard]] std::vector<CommandWords> command_words();

/// Commands to begin with, and what they do; in help and manual.
[[nodiscard]] const std::vector<EndWords>& example_words();

/// What ends every help text and the manual: signals and exit codes, a line each.
[[nodiscard]] const std::vector<EndWords>& exit_code_words();
[[nodiscard]] const std::vector<EndWords>& signal_words();

}  // namespace packmpi::cli
