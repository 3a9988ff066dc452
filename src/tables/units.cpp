#include "tables/units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>

#include "base/text.hpp"

namespace packmpi::tables {
namespace {

constexpr Unit ratios[] = {{"%", -2}};
constexpr Unit lengths[] = {{"m", 0}, {"km", 3}, {"cm", -2}, {"mm", -3}, {"um", -6}, {"nm", -9}};
constexpr Unit densities[] = {{"kg/m3", 0}, {"g/cm3", 3}, {"t/m3", 3}};
constexpr Unit masses[] = {{"kg", 0}, {"t", 3}, {"g", -3}, {"mg", -6}};
constexpr Unit pressures[] = {{"Pa", 0}, {"kPa", 3}, {"MPa", 6}, {"GPa", 9}, {"N/m2", 0}, {"N/mm2", 6}};
constexpr Unit times[] = {{"s", 0}, {"ms", -3}, {"us", -6}, {"ns", -9}};
constexpr Unit velocities[] = {{"m/s", 0}, {"cm/s", -2}, {"mm/s", -3}};
constexpr Unit accelerations[] = {{"m/s2", 0}, {"cm/s2", -2}, {"mm/s2", -3}};
constexpr Unit angular_velocities[] = {{"rad/s", 0}};
constexpr Unit drag_factors[] = {{"N s/m", 0}, {"mN s/m", -3}, {"kg/s", 0}, {"g/s", -3}};

/// Where the decimal number at the start of `text` ends: its digits, and its exponent if there is one.
struct Decimal {
  std::size_t digits = 0;  ///< length of sign, digits and point
  std::size_t end = 0;     ///< the same with the exponent
  int exponent = 0;
};

std::optional<Decimal> scan_decimal(std::string_view text) {
  Decimal found;
  found.digits = std::min(text.find_first_not_of("0123456789.", text.starts_with('-') ? 1 : 0), text.size());
  double mantissa = 0.0;
  const char* stop = text.data() + found.digits;
  const auto read = std::from_chars(text.data(), stop, mantissa, std::chars_format::fixed);
  if (read.ec != std::errc{} || read.ptr != stop) return std::nullopt;
  found.end = found.digits;
  if (found.end < text.size() && (text[found.end] == 'e' || text[found.end] == 'E')) {
    const std::size_t plus = text.substr(found.end + 1).starts_with('+') ? 1 : 0;
    const auto exponent = std::from_chars(stop + 1 + plus, text.data() + text.size(), found.exponent);
    if (exponent.ec == std::errc::result_out_of_range || std::abs(found.exponent) > 9999) return std::nullopt;
    if (exponent.ec == std::errc{}) found.end = static_cast<std::size_t>(exponent.ptr - text.data());
  }
  return found;
}

/// The unit as in our lists: "µm" is um, "kg/m^3" and "kg/m³" are kg/m3. The two µ of Unicode look alike.
std::string plain_unit(std::string_view unit) {
  struct Spelling {
    std::string_view written, ours;
  };
  constexpr std::array spellings{Spelling{"\xc2\xb5", "u"}, Spelling{"\xce\xbc", "u"}, Spelling{"\xc2\xb3", "3"},
                                 Spelling{"\xc2\xb2", "2"}, Spelling{"^", ""},         Spelling{"\xc2\xb7", " "},
                                 Spelling{"*", " "}};
  std::string text(unit);
  for (const auto& [written, ours] : spellings) {
    for (std::size_t at = text.find(written); at != std::string::npos; at = text.find(written, at + ours.size())) {
      text.replace(at, written.size(), ours);
    }
  }
  return text;
}

/// 'm, mm or km' of the units of a quantity.
std::string list(std::span<const Unit> units) {
  std::string words;
  for (std::size_t i = 0; i < units.size(); ++i) {
    if (i > 0) words += i + 1 == units.size() ? " or " : ", ";
    words += units[i].name;
  }
  return words;
}

}  // namespace

const Quantity plain{"", "", {}};
const Quantity ratio{"", "40 %", ratios};
const Quantity length{"m", "20 mm", lengths};
const Quantity mass{"kg", "150 g", masses};
const Quantity density{"kg/m3", "1 g/cm3", densities};
const Quantity pressure{"Pa", "100 MPa", pressures};
const Quantity time{"s", "0.1 ms", times};
const Quantity velocity{"m/s", "5 cm/s", velocities};
const Quantity acceleration{"m/s2", "2 m/s2", accelerations};
const Quantity angular_velocity{"rad/s", "3 rad/s", angular_velocities};
const Quantity drag_factor{"N s/m", "5 g/s", drag_factors};

Scalar parse_scalar(std::string_view text, const Quantity& quantity) {
  text = text::trimmed(text);
  if (quantity.units.empty()) return {{}, "is text where a plain number belongs; write it without quotes and unit"};
  const auto decimal = scan_decimal(text);
  if (!decimal) {
    return {{},
            fmt::format("does not begin with a number; write a number and a unit, such as \"{}\"", quantity.example)};
  }
  const std::string_view unit = text::trimmed(text.substr(decimal->end));
  const std::string name = plain_unit(unit);
  for (const Unit& known : quantity.units) {
    if (known.name != name) continue;
    const std::string in_si = fmt::format("{}e{}", text.substr(0, decimal->digits), decimal->exponent + known.exponent);
    double value = 0.0;
    if (std::from_chars(in_si.data(), in_si.data() + in_si.size(), value).ec == std::errc{}) return {value, {}};
    return {{}, "is too large or too small for a double; give a number within 1e-300 to 1e300"};
  }
  if (unit.empty()) return {{}, fmt::format("has no unit; add {}, or remove the quotes", list(quantity.units))};
  return {{},
          fmt::format("has the unit {}, which does not fit here; use {}", toml_string(unit.substr(0, 60)),
                      list(quantity.units))};
}

std::string toml_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (code < 0x20 || code == 0x7f) {
      out += fmt::format("\\u{:04x}", code);
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string number(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  std::string text(digits.data(), end);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";  // "n" of nan and inf
  return text;
}

}  // namespace packmpi::tables
