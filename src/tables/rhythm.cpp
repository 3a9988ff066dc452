#include "tables/rhythm.hpp"

#include <charconv>

namespace packmpi::tables {

std::optional<Rhythm> rhythm_of(std::string_view every) {
  if (every == "off") return Rhythm{};
  const std::string_view digits = every.substr(0, every.find_first_not_of("0123456789."));
  std::string_view unit = every.substr(digits.size());
  if (unit.starts_with(' ')) unit.remove_prefix(1);
  const char* const end = digits.data() + digits.size();
  if (unit == "steps" || unit == "step") {
    std::int64_t steps = 0;
    const auto read = std::from_chars(digits.data(), end, steps);
    constexpr std::int64_t most = 1'000'000'000'000'000;  // a run is not that long, and sums with it do not overflow
    if (read.ec != std::errc{} || read.ptr != end || steps < 1 || steps > most) return std::nullopt;
    return Rhythm{.steps = steps};
  }
  const double factor = unit == "s" ? 1.0 : unit == "min" ? 60.0 : unit == "h" ? 3600.0 : 0.0;
  double number = 0.0;
  const auto read = std::from_chars(digits.data(), end, number, std::chars_format::fixed);
  const bool valid = read.ec == std::errc{} && read.ptr == end && number > 0.0 && number < 1e9 && factor > 0.0;
  return valid ? std::optional(Rhythm{.seconds = number * factor}) : std::nullopt;
}

}  // namespace packmpi::tables
