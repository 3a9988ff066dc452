#include "exporters/quote.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/text.hpp"

namespace packmpi::exporters {
namespace {

[[noreturn]] void refuse(std::string_view name, const std::string& words) {
  throw Error(ExitCode::bad_input,
              fmt::format("the file name \"{}\" {}; choose another one with -o FILE", text::printable(name), words));
}

bool has_any(std::string_view words, std::string_view letters) {
  return words.find_first_of(letters) != std::string_view::npos;
}

/// With backslashes before what `special` has. Control characters and broken UTF-8 do not get here (check_file_name).
std::string quoted(std::string_view words, std::string_view special) {
  check_file_name(words);
  std::string text = "\"";
  for (const char c : words) {
    if (special.find(c) != std::string_view::npos) text += '\\';
    text += c;
  }
  return text + '"';
}

}  // namespace

std::string comment(std::string_view words) {
  constexpr std::string_view plain = " .,:;_-+*/()[]=@~^!|";
  std::string text = text::printable(words);
  for (char& c : text) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    const bool ascii = static_cast<unsigned char>(c) < 0x80U;
    if (ascii && !letter && plain.find(c) == std::string_view::npos) c = '?';
  }
  return text;
}

std::string python_string(std::string_view words) { return quoted(words, "\"\\"); }

// '?' too: two of them begin a trigraph for older compilers.
std::string cpp_string(std::string_view words) { return quoted(words, "\"\\?"); }

// The inner quotes keep blanks and '#' together once the variable is put in; what is put in is not looked at again.
std::string liggghts_word(std::string_view words) {
  check_file_name(words);
  if (has_any(words, "'\"$&")) refuse(words, "has a quote, $ or &, which LAMMPS and LIGGGHTS would not take as it is");
  return fmt::format("\"'{}'\"", words);
}

std::string lammps_word(std::string_view words) {
  const bool ascii = std::ranges::all_of(words, [](char c) { return static_cast<unsigned char>(c) < 0x80U; });
  if (!ascii) refuse(words, "has letters beyond ASCII, which LAMMPS would not take as they are");
  return liggghts_word(words);
}

std::string lethe_file(std::string_view words) {
  check_file_name(words);
  if (has_any(words, ",#\\|")) refuse(words, "has a comma, #, | or backslash, which Lethe would not take as it is");
  return std::string(words);
}

void check_file_name(std::string_view name) {
  if (text::printable(name) != name) {
    refuse(name, "has control characters or is not UTF-8");
  }
  if (name.empty() || text::trimmed(name) != name) refuse(name, "begins or ends with a blank");
}

}  // namespace packmpi::exporters
