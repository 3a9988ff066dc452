/// The key table: every key of a scene file, declared once. The reader, the effective input and the reference in
/// doc/input.md all come from it.
#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "input/input.hpp"
#include "tables/units.hpp"

namespace packmpi::input {

using tables::acceleration, tables::angular_velocity, tables::density, tables::drag_factor, tables::length,
    tables::plain, tables::pressure, tables::Quantity, tables::ratio, tables::time, tables::velocity;

/// Where a key's value goes. Its type decides what the file may say.
using Slot =
    std::variant<bool*, int*, std::int64_t*, std::uint64_t*, double*, std::optional<double>*, std::string*, Vec3*,
                 std::array<double, 2>*, std::vector<double>*, std::vector<Boundary>*, Curve*, SizeDistribution*,
                 Weighting*, ListOrder*, Interpolation*, HeightRule*, RegionRule*, FrictionVelocity*, Tangential*,
                 Regularisation*, WallStiffness*, StopRule*, TargetState*, Decomposition*, VesselShape*, Body*, Axis*>;

/// An interval of numbers; infinity and NaN are in none.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false, high_open = false;  ///< the bound itself is outside

  [[nodiscard]] bool contains(double value) const noexcept;
  [[nodiscard]] std::string words() const;  ///< "> 0", ">= 0 and < 1", ""
};

/// How many entries a list has; `any`: as many as the file gives, pairs in a curve.
enum class Count { one, two, axes, lateral_axes, spin_axes, any };

/// When a key belongs to a scene.
struct Condition {
  std::string_view words = "";            ///< `distribution = "equal"`
  bool (*holds)(const Input&) = nullptr;  ///< none: always
};

struct Key {
  std::string_view path;  ///< "table.key"
  std::function<Slot(Input&)> slot;
  const Quantity* quantity = &plain;
  std::string_view unit = "";  ///< as documented; the quantity's SI unit unless it has none
  Range range = {};
  Count count = Count::one;
  std::optional<std::string_view> standard = {};  ///< default, a TOML value (of each entry of a list), or a key's path
                                                  ///< after "="; none: mandatory
  std::string_view doc = "";
  Condition when = {};
  std::vector<std::string_view> choices = {};  ///< words of a text key; those of an enumeration are known by its type
  std::optional<double> only = {};             ///< the one number that is not refused

  [[nodiscard]] bool applies(const Input& in) const { return when.holds == nullptr || when.holds(in); }
};

/// The table, in the order of reading: a key stands after those that its condition, count and default look at.
[[nodiscard]] const std::vector<Key>& keys();

/// "a.b.c" into "a.b" and "c"; a path without a table has an empty one.
[[nodiscard]] std::pair<std::string_view, std::string_view> split_path(std::string_view path);

/// The key at `path`, or null.
[[nodiscard]] const Key* find_key(std::string_view path);

/// Entries the key's list has in this scene; 0: any number.
[[nodiscard]] std::size_t entries(const Key& key, const Input& in);

/// The words the key can have; empty for a key of another type.
[[nodiscard]] std::vector<std::string_view> choices(const Key& key);

/// What the key wants: "a number > 0 [m]", "true or false", "\"stop\", \"viscous\" or \"none\"".
[[nodiscard]] std::string wanted(const Key& key);

/// "a, b or c".
[[nodiscard]] std::string joined(std::span<const std::string_view> words, std::string_view last = "or");

}  // namespace packmpi::input
