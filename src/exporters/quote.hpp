/// Words from a pack or of a user, as the languages that are written here take them: a pack may be a stranger's, and
/// none of its words may become a command. One function a language; what a language cannot say is refused. Private to
/// this module. All of it is local; errors: Error(bad_input), one line.
#pragma once
#include <string>
#include <string_view>

namespace packmpi::exporters {

/// Anything, for a comment or a title in any of the languages: one line of letters, digits, blanks and plain
/// punctuation; other characters become '?'. Letters of other scripts stay.
[[nodiscard]] std::string comment(std::string_view words);

/// A string of Python, with its quotes.
[[nodiscard]] std::string python_string(std::string_view words);
/// A string of C++, with its quotes.
[[nodiscard]] std::string cpp_string(std::string_view words);
/// The value of a "variable ... index" of LIGGGHTS that stands for one word after ${...} is put in.
[[nodiscard]] std::string liggghts_word(std::string_view words);
/// The same for LAMMPS, which reads ASCII alone.
[[nodiscard]] std::string lammps_word(std::string_view words);
/// An entry of a list of file names in a parameter file of Lethe (deal.II), which knows no quotes.
[[nodiscard]] std::string lethe_file(std::string_view words);

/// Throws Error(bad_input) unless `name` can be the name of a file in all these languages: UTF-8, without control
/// characters, no blank at its ends.
void check_file_name(std::string_view name);

}  // namespace packmpi::exporters
