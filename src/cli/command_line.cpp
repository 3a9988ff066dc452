// The command line, by CLI11; nothing else of the program sees that library. Commands and options are declared here
// once: parser, help, manual page and shell completion come from these declarations.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>
#include <type_traits>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/command_docs.hpp"
#include "cli/options.hpp"
#include "cli/scene_schema.hpp"
#include "packmpi/version.hpp"
#include "tables/units.hpp"

namespace packmpi::cli {
namespace {

constexpr const char* about =
    "packmpi: dense random packs of spheres for DEM, layer by layer, on any number of MPI ranks.\n"
    "\"packmpi SCENE.toml\" is \"packmpi run SCENE.toml\"; \"packmpi COMMAND --help\" tells a command's options.";

constexpr std::int64_t most_particles = std::int64_t{1} << 40;  // as scenes may have
constexpr std::int64_t most_ranks = 1 << 24;
constexpr std::int64_t most_steps = 1'000'000'000'000'000;  // 30 years at a microsecond each
constexpr double least_hours = 1e-9, most_hours = 1e6;

// Of a name, which a variable of the shell that is not set leaves empty.
std::string not_empty(const std::string& name) { return name.empty() ? "the name is empty" : ""; }

// All of `text` as a number; none if it is not one.
template <class Number>
std::optional<Number> read_number(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

// An option that is a number in [least, most]; a refusal is one line that names the option, the word and the range.
template <class Number, class Take>
CLI::Option* add_number(CLI::App& app, const std::string& name, Number least, Number most, Take take,
                        const std::string& text) {
  return app.add_option_function<std::string>(
      name,
      [name, least, most, take](const std::string& word) {
        const std::optional<Number> value = read_number<Number>(word);
        if (value && *value >= least && *value <= most) return take(*value);  // not NaN
        throw CLI::ValidationError(name, fmt::format("\"{}\" is no {} from {:g} to {:g}", word,
                                                     std::is_integral_v<Number> ? "whole number" : "number",
                                                     static_cast<double>(least), static_cast<double>(most)));
      },
      text);
}

std::string version_text() { return fmt::format("packmpi {} ({}, {})\n", version(), git_id(), compiler()); }

void declare_scene(CLI::App& app, Request& request) {
  app.add_option("SCENE", request.run.scene, "scene file (doc/input.md)")->required();
  app.add_option("--set", request.run.overrides.set, "change a key; may be repeated")
      ->allow_extra_args(false)
      ->type_name("KEY.PATH=VALUE");
  // Declared after --set, so it is added behind its values, and wins.
  add_number(
      app, "--seed", std::int64_t{0}, std::numeric_limits<std::int64_t>::max(),
      [&request](std::int64_t seed) { request.run.overrides.set.push_back(fmt::format("seed={}", seed)); },
      "the same as --set seed=N")
      ->type_name("N");
}

void declare_run(CLI::App& app, Request& request) {
  declare_scene(app, request);
  app.add_option("-o,--output", request.run.folder, "folder for the outputs; made if missing")
      ->check(not_empty)
      ->capture_default_str()
      ->type_name("FOLDER");
  app.add_flag("--force", request.run.force, "replace outputs that exist");
  app.add_option("--restart", request.run.restart, "go on from a checkpoint: auto (the newest valid one) or its file")
      ->type_name("auto|FILE");
  add_number(
      app, "--max-hours", least_hours, most_hours, [&request](double hours) { request.run.max_hours = hours; },
      "write a checkpoint and end (code 75) before so much wall time")
      ->type_name("H");
  add_number(
      app, "--max-steps", std::int64_t{1}, most_steps, [&request](std::int64_t n) { request.run.max_steps = n; },
      "the same after so many time steps")
      ->type_name("N");
  app.add_option_function<std::string>(
         "--log-format",
         [&request](const std::string& word) {
           request.run.log_format = word == "jsonl" ? log::Format::jsonl : log::Format::text;
         },
         "of NAME.log: text, or jsonl, one JSON object a line with the numbers as members")
      ->check(CLI::IsMember({"text", "jsonl"}))
      ->type_name("text|jsonl");
  app.add_flag_callback(
      "-q,--quiet", [&request] { request.run.verbosity = log::Verbosity::quiet; },
      "say only warnings, errors and the result");
  app.add_flag_callback(
      "-v,--verbose", [&request] { request.run.verbosity = log::Verbosity::verbose; }, "say more");
}

void declare_info(CLI::App& app, Request& request) {
  app.add_option("FILE", request.run.scene, "pack or checkpoint")->required();
}

void declare_analyze(CLI::App& app, Request& request) {
  app.add_option("PACK", request.run.scene, "pack (NAME.hdf)")->required();
}

void declare_init(CLI::App& app, Request& request) {
  app.add_option("FILE", request.run.scene, "scene file to write")->default_val("scene.toml");
  app.add_option("--dimension", request.dimension, "2: discs, 3: spheres")
      ->check(CLI::IsMember({2, 3}))
      ->capture_default_str()
      ->type_name("2|3");
  app.add_flag("--force", request.run.force, "replace the file if it exists");
}

constexpr std::array<std::string_view, 2> trims{"drop", "cut"};  // exporters::Trim after none, in its order

std::string lines(const std::vector<EndWords>& table) {
  std::string text;
  for (const EndWords& line : table) {  // a term that fills its column stands on a line of its own
    const std::string_view wide = line.term.size() < 28 ? "" : "\n                              ";
    text += fmt::format("  {:<28}{}{}\n", line.term, wide, line.text);
  }
  return text;
}

std::vector<EndWords> format_words() {
  std::vector<EndWords> words;
  for (const exporters::FormatWords& f : exporters::convert_formats()) {
    const std::string second = *f.companion == '\0' ? "" : fmt::format(", {}", f.companion);
    words.push_back({f.name, fmt::format("{} (NAME{}{})", f.text, f.ending, second)});
  }
  return words;
}

// "NX,NY" or "NX".
void read_copies(const std::string& text, std::array<int, 2>& copies) {
  std::istringstream words(text);
  char comma = ',';
  copies = {0, 1};
  const bool valid = words >> copies[0] && (words.eof() || (words >> comma && comma == ',' && words >> copies[1])) &&
                     (words >> std::ws).eof() && copies[0] > 0 && copies[1] > 0;
  if (!valid) throw CLI::ValidationError("--replicate", fmt::format("\"{}\" is not NX,NY, two counts from 1 on", text));
}

void declare_convert(CLI::App& app, Request& request) {
  exporters::ConvertRequest& conversion = request.convert;
  app.add_option("PACK", conversion.pack, "pack (NAME.hdf)")->required();
  app.add_option("--to", conversion.format, "format, see below")->required()->type_name("FORMAT");
  app.add_option("-o,--output", conversion.file,
                 "file to write; without it, NAME with the format's ending, beside the pack")
      ->check(not_empty)
      ->type_name("FILE");
  app.add_option_function<std::string>(
         "--trim",
         [&conversion](const std::string& word) {
           conversion.trim = word == trims[0] ? exporters::Trim::drop : exporters::Trim::cut;
         },
         "leave out particles above the target height: those that reach above it (drop), or those with their centre "
         "above it (cut)")
      ->check(CLI::IsMember(std::vector<std::string>(trims.begin(), trims.end())))
      ->type_name("drop|cut");
  app.add_option("--cut", conversion.cut,
                 "take a specimen out: box:length=L,width=W,height=H, cylinder:diameter=D,height=H or "
                 "sphere:diameter=D, with its middle at x=X,y=Y,z=Z or in that of the pack, or a closed surface, "
                 "FILE.stl:unit=mm or FILE.obj, where the file has it or with its middle at x=X,y=Y,z=Z; particles "
                 "wholly inside are kept, and its solid fraction is told")
      ->type_name("SHAPE");
  app.add_option_function<std::string>(
         "--replicate", [&conversion](const std::string& text) { read_copies(text, conversion.copies); },
         "write so many copies side by side along x and y; periodic axes only")
      ->type_name("NX,NY");
  app.add_flag("--force", request.run.force, "replace files that exist");
  app.footer("Formats:\n" + lines(format_words()));
}

// A length above 0 [m]: "0.2", or "20 cm".
std::optional<double> read_length(const std::string& text) {
  const std::optional<double> plain = read_number<double>(text);
  const std::optional<double> length = plain ? plain : tables::parse_scalar(text, tables::length).value;
  return length && *length > 0.0 && std::isfinite(*length) ? length : std::nullopt;
}

// "L,B" or "L", each a length or "open".
void read_sides(const std::string& text, std::vector<std::optional<double>>& sides) {
  std::istringstream words(text + ",");  // a last side that is empty is one, too
  for (std::string word; std::getline(words, word, ',');) {
    const bool open = word == "open";
    sides.push_back(open ? std::nullopt : read_length(word));
    if (!open && !sides.back()) {
      throw CLI::ValidationError("--floor", fmt::format("\"{}\" is neither a length above 0 nor \"open\"", word));
    }
  }
}

void declare_estimate(CLI::App& app, Request& request) {
  declare_scene(app, request);
  forecast::Question& question = request.question;
  add_number(
      app, "--particles", std::int64_t{1}, most_particles, [&question](std::int64_t n) { question.particles = n; },
      "of the pack; then its height is found, or its floor")
      ->type_name("N");
  app.add_option_function<std::string>(
         "--height",
         [&question](const std::string& text) {
           question.height = read_length(text);
           if (!question.height) {
             throw CLI::ValidationError("--height", fmt::format("\"{}\" is no length above 0", text));
           }
         },
         "to be filled, instead of the scene's [m]; with --particles, the floor is found, of the scene's shape")
      ->type_name("H");
  app.add_option_function<std::string>(
         "--floor", [&question](const std::string& text) { read_sides(text, question.sides); },
         "sides of the floor, instead of the scene's [m]; one that is the word open is found")
      ->type_name("L,B");
  add_number(
      app, "--fraction", 0.01, 0.99, [&question](double fraction) { question.fraction = fraction; },
      "solid fraction of the bed, instead of the estimate")
      ->type_name("F");
  add_number(
      app, "--ranks", std::int64_t{1}, most_ranks,
      [&question](std::int64_t n) { question.ranks = static_cast<int>(n); },
      "that the run is to have; without it, those that are here")
      ->type_name("N");
  app.add_flag_callback(
      "--no-probe", [&question] { question.probe = false; }, "do not try how fast this machine is: no time is told");
  app.add_flag("--json", question.json, "print JSON");
}

void declare_limits(CLI::App& app, Request& request) {
  declare_scene(app, request);
  app.add_flag("--json", request.question.json, "print JSON");
}

void declare_nothing(CLI::App&, Request&) {}

// A tool's own options are those of its program in Python: packmpi render --help.
void declare_tool(CLI::App& app, Request& request) {
  app.add_option("PACK", request.run.scene, "pack (NAME.hdf); --help tells the options")->required();
  app.allow_extras();
}

void declare_completion(CLI::App& app, Request& request) {
  app.add_option("SHELL", request.shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
}

struct Declaration {
  Command command;
  const char* name;
  const char* text;
  void (*declare)(CLI::App&, Request&);
};
constexpr std::array declarations{
    Declaration{Command::run, "run", "make the pack: NAME.hdf, NAME.json, NAME.log, NAME.steps.csv", declare_run},
    Declaration{Command::check, "check", "read and check the scene, print every key as it will be used, do nothing",
                declare_scene},
    Declaration{Command::estimate, "estimate",
                "tell what the scene will take: particles, height or floor, layers, steps, memory, files, time",
                declare_estimate},
    Declaration{Command::limits, "limits",
                "find the loosest and the densest state that the scene can have by friction, on samples of it",
                declare_limits},
    Declaration{Command::info, "info", "tell what a pack or a checkpoint is; verify it", declare_info},
    Declaration{Command::init, "init", "write a scene to begin with: every key, with its meaning", declare_init},
    Declaration{Command::schema, "schema", "print the JSON Schema of scene files, for editors", declare_nothing},
    Declaration{Command::analyze, "analyze",
                "measure a pack inside: profiles, contacts, forces, g(r), order; NAME.analysis.json", declare_analyze},
    Declaration{Command::convert, "convert", "write a pack in the format of another code", declare_convert},
    Declaration{Command::tool, "render", "draw a pack: NAME.png", declare_tool},
    Declaration{Command::tool, "plot", "plot density, sizes, g(r) and history of a pack: NAME.density.png and so on",
                declare_tool},
    Declaration{Command::tool, "report", "write one page on a pack, with pictures and plots: NAME.html", declare_tool},
    Declaration{Command::manual, "manual", "print the manual page (packmpi.1)", declare_nothing},
    Declaration{Command::completion, "completion", "print the completion of this command line for a shell",
                declare_completion}};

std::string end_words() {
  return "Examples:\n" + lines(example_words()) + "Signals:\n" + lines(signal_words()) + "Exit codes:\n" +
         lines(exit_code_words());
}

void declare_all(CLI::App& app, Request& request) {
  app.set_version_flag("--version", version_text(), "print version, git id and compiler");
  app.require_subcommand(1);
  app.footer(end_words());
  for (const Declaration& d : declarations) {
    CLI::App* command = app.add_subcommand(d.name, d.text);
    d.declare(*command, request);
    command->callback([&request, &d] {
      request.command = d.command;
      request.name = d.name;
    });
  }
}

// "run" is understood where no command stands.
void name_command(std::vector<std::string>& words) {
  constexpr std::array<std::string_view, 3> answers{"-h", "--help", "--version"};
  const auto known = [&](const Declaration& d) { return words.front() == d.name; };
  if (words.empty() || std::ranges::any_of(declarations, known)) return;
  if (std::ranges::find(answers, words.front()) == answers.end()) words.insert(words.begin(), "run");
}

// What to say of a first word that is neither a command nor a file, and near to a command; "" of any other.
std::string mistyped_command(const std::vector<std::string>& words) {
  if (words.empty() || words.front().starts_with('-') || words.front().find_first_of("./") != std::string::npos)
    return "";
  std::vector<std::string> names;
  names.reserve(declarations.size());
  for (const Declaration& d : declarations) names.emplace_back(d.name);
  if (std::ranges::find(names, words.front()) != names.end()) return "";
  const auto near = text::closest(words.front(), names);
  std::error_code ignored;
  if (!near || std::filesystem::exists(words.front(), ignored)) return "";
  return fmt::format("packmpi: there is no command \"{}\", and no scene of that name; did you mean \"{}\"?\n",
                     text::printable(words.front()), *near);
}

// A line for the first option that the command has not and that is near to one it has; "" if there is none.
std::string mistyped_option(const CLI::App& app, const std::vector<std::string>& words) {
  if (words.empty()) return "";
  const auto commands = app.get_subcommands([&](const CLI::App* one) { return one->get_name() == words.front(); });
  if (commands.empty()) return "";
  const CLI::App* command = commands.front();
  std::vector<std::string> names;
  for (const CLI::Option* option : command->get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  for (const std::string& word : words) {
    const std::string name = word.substr(0, word.find('='));
    if (!name.starts_with("--") || std::ranges::find(names, name) != names.end()) continue;
    if (const auto near = text::closest(name, names)) {
      return fmt::format("{}: did you mean \"{}\"?\n", text::printable(name), *near);
    }
  }
  return "";
}

OptionWords words_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();  // "N:POSITIVE" with its check
  OptionWords words{
      .names = {}, .value = type.substr(0, type.find(':')), .choices = {}, .text = option.get_description()};
  if (option.get_positional()) return {{option.get_name()}, "", {}, words.text};
  for (const std::string& name : option.get_snames()) words.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) words.names.push_back("--" + name);
  if (option.get_items_expected_max() == 0) words.value.clear();  // a flag
  return words;
}

}  // namespace

std::vector<CommandWords> command_words() {
  Request request;
  CLI::App app{about, "packmpi"};
  declare_all(app, request);
  std::vector<CommandWords> all;
  for (const CLI::App* command : app.get_subcommands({})) {
    CommandWords words{command->get_name(), command->get_description(), {}, {}, {}};
    for (const CLI::Option* option : command->get_options()) {
      if (option == command->get_help_ptr()) continue;
      (option->get_positional() ? words.arguments : words.options).push_back(words_of(*option));
    }
    if (words.name == "convert") words.table = format_words();
    if (words.name == "completion") words.arguments.front().choices = {"bash", "zsh", "fish"};
    all.push_back(words);
  }
  return all;
}

std::variant<Request, Reply> parse_command_line(int argc, const char* const* argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  if (const std::string flaw = mistyped_command(words); !flaw.empty()) {
    return Reply{flaw, static_cast<int>(ExitCode::bad_input)};
  }
  name_command(words);
  Request request;
  CLI::App app{about, "packmpi"};
  declare_all(app, request);
  try {
    std::vector<std::string> reversed(words.rbegin(), words.rend());  // CLI11 takes them from the back
    app.parse(reversed);
  } catch (const CLI::ParseError& error) {
    std::ostringstream out, err;
    const int code = app.exit(error, out, err);
    if (code != 0) err << mistyped_option(app, words);
    return Reply{out.str() + err.str(), code == 0 ? 0 : static_cast<int>(ExitCode::bad_input)};
  }
  if (request.command == Command::schema) return Reply{cli::scene_schema(), 0};
  if (request.command == Command::manual) return Reply{manual_page(), 0};
  if (request.command == Command::completion) return Reply{completion(request.shell), 0};
  return request;
}

}  // namespace packmpi::cli
