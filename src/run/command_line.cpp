// The command line, by CLI11; nothing else of the program sees that library.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <array>
#include <sstream>
#include <string_view>
#include <utility>

#include "base/error.hpp"
#include "packmpi/version.hpp"
#include "run/options.hpp"

namespace packmpi::run {
namespace {

constexpr const char* about =
    "packmpi: dense random packs of spheres for DEM, layer by layer, on any number of MPI ranks.\n"
    "  packmpi [run] SCENE.toml    make the pack: NAME.hdf, NAME.json, NAME.log, NAME.steps.csv\n"
    "  packmpi check SCENE.toml    read and check the scene, print every key as it will be used, do nothing\n"
    "  packmpi info FILE           what a pack or a checkpoint is; verify it\n"
    "Signals: USR1 checkpoint; USR2, TERM, INT checkpoint and end. A file STOP in the output folder ends it, too.\n"
    "Exit codes: 0 done; 2 bad input or usage; 3 finished but a target was missed; 4 numerical failure; 5 "
    "input/output; "
    "6 checkpoint unusable; 75 stopped early with a checkpoint: --restart auto goes on.";

std::string version_text() { return fmt::format("packmpi {} ({}, {})\n", version(), git_id(), compiler()); }

// A command may stand before the scene; "run" is understood otherwise.
Command take_command(std::vector<std::string>& words) {
  constexpr std::array<std::pair<std::string_view, Command>, 3> commands{
      {{"run", Command::run}, {"check", Command::check}, {"info", Command::info}}};
  for (const auto& [name, command] : commands) {
    if (words.empty() || words.front() != name) continue;
    words.erase(words.begin());
    return command;
  }
  return Command::run;
}

}  // namespace

std::variant<Options, Reply> parse_command_line(int argc, const char* const* argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  Options options;
  options.command = take_command(words);
  CLI::App app{about, "packmpi"};
  bool quiet = false;
  bool verbose = false;
  bool show_version = false;
  std::optional<std::uint64_t> seed;
  app.add_option("SCENE", options.scene, "scene file (doc/input.md)");
  app.add_option("-o,--output", options.folder, "folder for the outputs; made if missing")->capture_default_str();
  app.add_option("--set", options.overrides.set, "change a key: key.path=value; may be repeated")
      ->allow_extra_args(false);
  app.add_option("--seed", seed, "the same as --set seed=N");
  app.add_flag("--force", options.force, "replace outputs that exist");
  app.add_option("--restart", options.restart, "go on from a checkpoint: auto (the newest sound one) or its file")
      ->type_name("auto|FILE");
  app.add_option("--max-hours", options.max_hours, "write a checkpoint and end (code 75) before so much wall time")
      ->check(CLI::PositiveNumber);
  app.add_option("--max-steps", options.max_steps, "the same after so many time steps")->check(CLI::PositiveNumber);
  app.add_flag("-q,--quiet", quiet, "say only warnings, errors and the result");
  app.add_flag("-v,--verbose", verbose, "say more");
  app.add_flag("--version", show_version, "print version, git id and compiler");
  try {
    std::vector<std::string> reversed(words.rbegin(), words.rend());  // CLI11 takes them from the back
    app.parse(reversed);
    if (show_version) return Reply{version_text(), 0};
    if (options.scene.empty()) throw CLI::RequiredError("SCENE.toml");
  } catch (const CLI::ParseError& error) {
    std::ostringstream out, err;
    const int code = app.exit(error, out, err);
    return Reply{out.str() + err.str(), code == 0 ? 0 : static_cast<int>(ExitCode::bad_input)};
  }
  if (seed) options.overrides.set.push_back(fmt::format("seed={}", *seed));
  options.verbosity = quiet ? log::Verbosity::quiet : verbose ? log::Verbosity::verbose : log::Verbosity::normal;
  return options;
}

}  // namespace packmpi::run
