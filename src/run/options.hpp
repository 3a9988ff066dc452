/// The command line as a plain struct.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/log.hpp"
#include "input/read.hpp"
#include "output/convert.hpp"

namespace packmpi::run {

enum class Command { run, check, estimate, info, analyze, convert, init, schema, manual, completion };

/// What `estimate` is asked; nothing: what the scene as it is comes to.
struct Question {
  std::optional<std::int64_t> particles{};
  std::optional<double> height{};              ///< [m] H_d
  std::vector<std::optional<double>> sides{};  ///< [m] of the floor, none: open; empty: those of the scene
  std::optional<double> fraction{};            ///< [-] of the pile, instead of the estimate
  int ranks = 0;                               ///< 0: those that are here
  bool probe = true;
  bool json = false;
};

/// What the user asked on the command line.
struct Options {
  Command command = Command::run;
  std::string scene;           ///< path of the TOML file; of any file for info, of the new one for init
  std::string folder = ".";    ///< where outputs go
  input::Overrides overrides;  ///< --set, --seed
  bool force = false;          ///< existing outputs may be replaced
  std::string restart;         ///< "auto", a checkpoint file, or "": from the beginning
  double max_hours = 0.0;      ///< [h] of wall time, then a checkpoint and the end; 0: no limit
  std::int64_t max_steps = 0;  ///< of this run, then the same; 0: no limit
  log::Verbosity verbosity = log::Verbosity::normal;
  log::Format log_format = log::Format::text;
  int dimension = 3;               ///< of the scene that init writes
  output::ConvertRequest convert;  ///< convert: all of it but `force`
  Question question;               ///< estimate
  std::string shell;               ///< completion: "bash", "zsh" or "fish"
};

/// Text to print and the exit code, for --help, --version, usage errors, schema, manual and completion.
struct Reply {
  std::string text;
  int code = 0;
};

/// Local and pure: every rank sees the same argv and gets the same answer.
[[nodiscard]] std::variant<Options, Reply> parse_command_line(int argc, const char* const* argv);

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

/// What ends every help text and the manual: signals and exit codes, a line each.
[[nodiscard]] const std::vector<EndWords>& exit_code_words();
[[nodiscard]] const std::vector<EndWords>& signal_words();

}  // namespace packmpi::run
