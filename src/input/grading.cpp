#include "input/grading.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string_view>

#include "base/elementary.hpp"
#include "base/error.hpp"
#include "input/document.hpp"
#include "input/units.hpp"

namespace packmpi::input {
namespace {

constexpr std::string_view head_end = ",percent_passing";

/// A line of the file, for its complaints.
struct Line {
  const std::string& path;
  int number;

  [[noreturn]] void refuse(const std::string& words) const {
    throw Error(ExitCode::bad_input, fmt::format("{}:{}: {}", path, number, words));
  }
};

std::string without_blanks(std::string text) {
  std::erase_if(text, [](char c) { return c == ' ' || c == '\t' || c == '\r'; });
  return text;
}

/// The unit of "diameter_mm,percent_passing".
std::string unit_of(const std::string& head, const Line& line) {
  constexpr std::string_view begin = "diameter_";
  // Not told: the scene may be a stranger's, and the file one that is none of his business.
  const std::string words =
      "is no grading curve; the first line must be \"diameter_mm,percent_passing\" (or _m, _cm, _um)";
  if (!head.starts_with(begin) || !head.ends_with(head_end)) line.refuse(words);
  std::string unit = head.substr(begin.size(), head.size() - begin.size() - head_end.size());
  if (!parse_scalar("1 " + unit, length).value) line.refuse(words);
  return unit;
}

/// A length in `unit`; of a percentage, "m" is as good as any.
double number_of(const std::string& text, const std::string& unit, const Line& line) {
  const Scalar scalar = parse_scalar(text + " " + unit, length);
  if (!scalar.value) {
    line.refuse(fmt::format("{} is not a number; write 4.75,63.2 (a point, no units)", toml_string(text)));
  }
  return *scalar.value;
}

/// Where the curve has the value `percent`.
double diameter_at(const Curve& curve, Interpolation interpolation, double percent) {
  const auto above = std::ranges::lower_bound(curve, percent, {}, [](const auto& point) { return point[1]; });
  if (above == curve.begin()) return (*above)[0];
  const auto& [low, p] = *(above - 1);
  const auto& [high, q] = *above;
  if (percent == q) return high;
  const double share = (percent - p) / (q - p);
  if (interpolation == Interpolation::linear) return low + share * (high - low);
  return std::clamp(low * elementary::power(high / low, share), low, high);
}

}  // namespace

Curve read_curve(const CurveFile& file) {
  Curve curve;
  std::istringstream lines(file.text);
  std::string unit;
  Line line{file.path, 0};
  for (std::string text; std::getline(lines, text);) {
    ++line.number;
    text = without_blanks(text);
    if (text.empty() || text.front() == '#') continue;
    if (unit.empty()) {
      unit = unit_of(text, line);
      continue;
    }
    const std::size_t comma = text.find(',');
    if (comma == std::string::npos) line.refuse(fmt::format("is {}; give two numbers with a comma", toml_string(text)));
    const double diameter = number_of(text.substr(0, comma), unit, line);
    const double percent = number_of(text.substr(comma + 1), "m", line);
    if (!(diameter > 0.0)) line.refuse("a diameter must be above 0");
    if (percent < 0.0 || percent > 100.0) line.refuse(fmt::format("{:g} percent; give 0 to 100", percent));
    curve.push_back({diameter, percent});
    if (curve.size() > 10000) line.refuse("more than 10000 points; is it a grading curve?");
  }
  if (unit.empty()) line.refuse("is empty; the first line must be \"diameter_mm,percent_passing\"");
  return curve;
}

std::string flaw(const Curve& curve) {
  if (curve.size() < 2)
    return fmt::format("has {} point{}; give two at least", curve.size(), curve.size() == 1 ? "" : "s");
  for (std::size_t k = 1; k < curve.size(); ++k) {
    const auto& [low, p] = curve[k - 1];
    const auto& [high, q] = curve[k];
    if (low >= high) {
      return fmt::format("diameter {:g} m follows {:g} m; diameters must ascend", high, low);
    }
    if (p > q) return fmt::format("{:g} percent follow {:g}; what passes a wider sieve cannot be less", q, p);
  }
  if (curve.front()[1] != 0.0) {
    return fmt::format("begins at {:g} percent; begin with the diameter that nothing passes, 0 percent",
                       curve.front()[1]);
  }
  if (curve.back()[1] != 100.0) {
    return fmt::format("ends at {:g} percent; end with the diameter that all pass, 100 percent", curve.back()[1]);
  }
  return "";
}

Curve kept_curve(const Radius& radius) {
  const double from = radius.keep_percent[0], to = radius.keep_percent[1];
  if (from == 0.0 && to == 100.0) return radius.diameter_curve;
  const auto rescaled = [&](double percent) { return 100.0 * ((percent - from) / (to - from)); };
  Curve kept{{diameter_at(radius.diameter_curve, radius.interpolation, from), 0.0}};
  for (const auto& [diameter, percent] : radius.diameter_curve) {
    if (percent > from && percent < to && diameter > kept.back()[0]) kept.push_back({diameter, rescaled(percent)});
  }
  const double end = diameter_at(radius.diameter_curve, radius.interpolation, to);
  if (end > kept.back()[0]) {
    kept.push_back({end, 100.0});
  } else {
    kept.back()[1] = 100.0;
  }
  return kept;
}

}  // namespace packmpi::input
