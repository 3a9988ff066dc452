/// The units a number in a scene file may carry; numbers and words as text.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace packmpi::tables {

/// A unit as a power of ten of the SI unit. Only powers of ten: "20 mm" is then read as the decimal 20e-3, rounded
/// once, and is the same double as 0.02.
struct Unit {
  std::string_view name;
  int exponent;
};

/// A kind of quantity: its SI unit and what else is accepted.
struct Quantity {
  std::string_view si;          ///< "" for a plain number
  std::string_view example;     ///< for error messages: "20 mm"
  std::span<const Unit> units;  ///< the SI unit first; empty: none may be written
};

extern const Quantity plain, ratio, length, mass, density, pressure, time, velocity, acceleration, angular_velocity,
    drag_factor;

/// A number read from text, or what is wrong with it ("...; what to do").
struct Scalar {
  std::optional<double> value;
  std::string complaint;
};

/// Read "20 mm", "1e8 Pa", "40%" as a double in SI units, correctly rounded. Local.
[[nodiscard]] Scalar parse_scalar(std::string_view text, const Quantity& quantity);

/// `text` as a TOML basic string, on one line.
[[nodiscard]] std::string toml_string(std::string_view text);

/// The shortest TOML float that reads back as the same double: 0.1, 1000.0, 1e+08.
[[nodiscard]] std::string number(double value);

}  // namespace packmpi::tables
