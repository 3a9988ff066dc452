#include "base/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace packmpi::text {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  const std::size_t columns = b.size() + 1;
  std::vector<std::size_t> cost((a.size() + 1) * columns);  // cost(i, j): the first i letters of a to the first j of b
  const auto at = [&](std::size_t i, std::size_t j) -> std::size_t& { return cost[i * columns + j]; };
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        at(i, j) = i + j;
        continue;
      }
      const std::size_t exchanged = at(i - 1, j - 1) + (a[i - 1] == b[j - 1] ? 0 : 1);
      at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1, exchanged});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
    }
  }
  return cost.back();
}

std::optional<std::string> closest(std::string_view word, std::span<const std::string> candidates) {
  std::optional<std::string> best;
  std::size_t best_distance = 0;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    const std::size_t allowed = std::max<std::size_t>(1, std::max(word.size(), candidate.size()) / 3);
    if (distance > allowed || (best && distance >= best_distance)) continue;
    best = candidate;
    best_distance = distance;
  }
  return best;
}

std::string duration(double seconds) {
  if (!std::isfinite(seconds) || seconds < 0.0) return "unknown";
  if (seconds < 9.995) return fmt::format("{:.2f} s", seconds);
  if (seconds < 59.95) return fmt::format("{:.1f} s", seconds);
  const double whole_seconds = std::round(seconds);
  if (whole_seconds < 3600.0) {
    return fmt::format("{:.0f} min {:02.0f} s", std::floor(whole_seconds / 60.0), std::fmod(whole_seconds, 60.0));
  }
  const double minutes = std::round(seconds / 60.0);
  if (minutes < 48.0 * 60.0) {
    return fmt::format("{:.0f} h {:02.0f} min", std::floor(minutes / 60.0), std::fmod(minutes, 60.0));
  }
  const double hours = std::round(seconds / 3600.0);
  return fmt::format("{:.0f} d {:02.0f} h", std::floor(hours / 24.0), std::fmod(hours, 24.0));
}

std::string bytes(std::uint64_t count) {
  constexpr std::array<const char*, 6> units{"KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
  if (count < 1024) return fmt::format("{} B", count);
  double value = static_cast<double>(count) / 1024.0;
  std::size_t unit = 0;
  while (value >= 1023.95 && unit + 1 < units.size()) {  // 1023.95 would print as 1024.0
    value /= 1024.0;
    ++unit;
  }
  return fmt::format("{:.1f} {}", value, units[unit]);
}

std::size_t utf8_length(std::string_view text) noexcept {
  const auto at = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0U; };
  const auto follows = [&](std::size_t k) { return (at(k) & 0xc0U) == 0x80U; };
  const unsigned first = at(0);
  if (first < 0x80U) return 1;
  if (first >= 0xc2U && first < 0xe0U) return follows(1) ? 2 : 0;
  if (first >= 0xe0U && first < 0xf0U) {
    const bool shortest = first != 0xe0U || at(1) >= 0xa0U;
    const bool surrogate = first == 0xedU && at(1) >= 0xa0U;
    return follows(1) && follows(2) && shortest && !surrogate ? 3 : 0;
  }
  if (first < 0xf0U || first > 0xf4U) return 0;
  const bool in_range = first == 0xf0U ? at(1) >= 0x90U : first != 0xf4U || at(1) < 0x90U;
  return in_range && follows(1) && follows(2) && follows(3) ? 4 : 0;
}

std::string printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const std::string_view one = text.substr(0, std::max<std::size_t>(length, 1));
    text.remove_prefix(one.size());
    const bool ascii_control = length == 1 && (static_cast<unsigned char>(one[0]) < 0x20U || one[0] == 0x7f);
    const bool control = length == 2 && one[0] == '\xc2' && static_cast<unsigned char>(one[1]) < 0xa0U;
    const bool turns = (one >= "\u2028" && one <= "\u202e") || (one >= "\u2066" && one <= "\u2069");
    out += length == 0 || ascii_control || control || turns ? std::string_view("?") : one;
  }
  return out;
}

std::string_view trimmed(std::string_view text) noexcept {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

}  // namespace packmpi::text
