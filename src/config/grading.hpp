/// Grading curves: how many percent pass a sieve, over the diameter. What makes one, and its part between percentiles.
#pragma once
#include <array>
#include <string>

#include "config/input.hpp"

namespace packmpi::input {

/// What keeps a curve from being one, "" if nothing does: at least two points, diameters ascending, percents not
/// descending, from 0 to 100 or beyond what `keep_percent` keeps.
[[nodiscard]] std::string flaw(const Curve& curve, const std::array<double, 2>& keep_percent);

/// The part of the curve between keep_percent, its percents from 0 to 100 again. The same bits on any machine.
[[nodiscard]] Curve kept_curve(const Radius& radius);

}  // namespace packmpi::input
