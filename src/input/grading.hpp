/// Grading curves: how many percent pass a sieve, over the diameter. From a CSV file, and cut at percentiles.
#pragma once
#include <string>
#include <vector>

#include "input/input.hpp"

namespace packmpi::input {

/// A CSV file that a scene names, as read from the disk.
struct CurveFile {
  std::string path;  ///< for messages
  std::string text;
};

/// The points of `file`: a line "diameter_mm,percent_passing" (any unit of length after diameter_), then two numbers a
/// line; blank lines and lines that begin with # are skipped. Throws Error(bad_input), one line "FILE:LINE: ...".
[[nodiscard]] Curve read_curve(const CurveFile& file);

/// What keeps a curve from being one, "" if nothing does: at least two points, diameters ascending, percents not
/// descending, from 0 to 100.
[[nodiscard]] std::string flaw(const Curve& curve);

/// The part of the curve between keep_percent, its percents from 0 to 100 again. The same bits on any machine.
[[nodiscard]] Curve kept_curve(const Radius& radius);

}  // namespace packmpi::input
