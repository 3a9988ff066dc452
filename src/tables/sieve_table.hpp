/// Sieve tables as spreadsheets write them, read as grading curves where there is one way to read them.
#pragma once
#include <array>
#include <string>
#include <vector>

namespace packmpi::tables {

/// Points [diameter in m, percent passing].
using Curve = std::vector<std::array<double, 2>>;

/// A CSV file that a scene names, as read from the disk.
struct CurveFile {
  std::string path;  ///< for messages
  std::string text;
};

/// A curve, and how the file was read: "FILE: read as percent passing over diameters in mm: 3 sieves, 2.36 to 9.5 mm".
struct SieveTable {
  Curve curve;
  std::string reading;
};

/// The points of `file`. Its first line names the columns: sieves (diameter, sieve, size or radius, with a unit of
/// length) and what passes or is retained, in percent, cumulative or by sieve, or a mass. Sieves stand in any order; a
/// line "pan" may be among them. Columns are separated by commas, semicolons or tabs, decimals by points or commas;
/// blank lines and lines that begin with # are skipped. What can be read in two ways is refused with what to add. The
/// curve need not begin at 0 or end at 100 percent: see flaw(). Throws Error(bad_input), one line "FILE:LINE: ...".
/// Local.
[[nodiscard]] SieveTable read_sieve_table(const CurveFile& file);

/// Sizes one by one, in the file's order, and how the file was read.
struct SizeList {
  std::vector<double> radii;  ///< [m]
  std::string reading;
};

/// The sizes of `file`: its first line names the columns, one of them diameters or radii with a unit of length. Numbers
/// as in sieve tables. Throws Error(bad_input), one line "FILE:LINE: ...". Local.
[[nodiscard]] SizeList read_size_list(const CurveFile& file);

}  // namespace packmpi::tables
