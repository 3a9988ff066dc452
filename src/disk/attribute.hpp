/// A named value with its unit, as files carry it.
#pragma once
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace packmpi::disk {

using Value = std::variant<std::int64_t, std::uint64_t, double, bool, std::string, std::vector<double>,
                           std::vector<std::int64_t>>;

/// One value. `unit` is "" for counts and words, "-" for ratios.
struct Field {
  const char* name;
  const char* unit;
  Value value;
};

}  // namespace packmpi::disk
