/// The tools in Python that are commands of the program: packmpi render, plot, report.
#pragma once
#include <string>
#include <vector>

namespace packmpi::cli {

/// True if the first word is a tool and this process is alone, not one of mpirun's: then start_tool() is to have it,
/// before MPI begins. Local.
[[nodiscard]] bool wants_tool(int argc, const char* const* argv);

/// Becomes the tool: Python of PACKMPI_PYTHON, of /usr/bin or of PATH, with the package that is installed, or stands in
/// the source tree, beside this program. No shell sees the words. Returns only if that fails, the exit code, after one
/// line on stderr.
[[nodiscard]] int start_tool(int argc, const char* const* argv);

}  // namespace packmpi::cli
