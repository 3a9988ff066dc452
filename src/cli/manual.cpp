// The manual page, from the declarations of the command line.
#include <fmt/core.h>

#include "cli/command_docs.hpp"
#include "cli/options.hpp"
#include "packmpi/version.hpp"

namespace packmpi::cli {
namespace {

// Text for troff: no line begins a request, hyphens stay hyphens.
std::string troff(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
  }
  return !out.empty() && (out.front() == '.' || out.front() == '\'') ? "\\&" + out : out;
}

std::string entry(const OptionWords& option) {
  std::string names;
  for (const std::string& name : option.names)
    names += fmt::format("{}\\fB{}\\fR", names.empty() ? "" : ", ", troff(name));
  if (!option.value.empty()) names += fmt::format(" \\fI{}\\fR", troff(option.value));
  return fmt::format(".TP\n{}\n{}\n", names, troff(option.text));
}

std::string entries(const std::vector<EndWords>& lines) {
  std::string out;
  for (const EndWords& line : lines) out += fmt::format(".TP\n\\fB{}\\fR\n{}\n", troff(line.term), troff(line.text));
  return out;
}

std::string section(const CommandWords& command) {
  std::string head = "packmpi " + command.name;
  for (const OptionWords& argument : command.arguments) head += " " + argument.names.front();
  std::string out = fmt::format(".SS \"{}\"\n{}.\n", troff(head), troff(command.text));
  for (const OptionWords& argument : command.arguments) out += entry(argument);
  for (const OptionWords& option : command.options) out += entry(option);
  return out + entries(command.table);
}

}  // namespace

std::string manual_page() {
  std::string out = fmt::format(".TH PACKMPI 1 \"\" \"packmpi {}\" \"User Commands\"\n", version());
  out +=
      ".SH NAME\npackmpi \\- dense random packs of spheres for DEM, on any number of MPI ranks\n"
      ".SH SYNOPSIS\n\\fBpackmpi\\fR [\\fICOMMAND\\fR] \\fISCENE.toml\\fR [\\fIOPTION\\fR]...\n.br\n"
      "\\fBmpirun \\-n\\fR \\fIN\\fR \\fBpackmpi\\fR \\fISCENE.toml\\fR [\\fIOPTION\\fR]...\n"
      ".SH DESCRIPTION\nLoose layers of spheres are inserted at random above the bed and settle under gravity, one "
      "after "
      "the other,\nuntil the target height is filled.\nOne scene file gives one pack: the same bits on any number "
      "of "
      "ranks, and after any restart.\nWithout a command, \\fBrun\\fR is meant.\n.SH COMMANDS\n";
  for (const CommandWords& command : command_words()) out += section(command);
  out += ".SH EXAMPLES\n" + entries(example_words());
  out += ".SH SIGNALS\n" + entries(signal_words());
  out += ".SH EXIT STATUS\n" + entries(exit_code_words());
  return out;
}

}  // namespace packmpi::cli
