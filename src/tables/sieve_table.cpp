#include "tables/sieve_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <span>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/text.hpp"
#include "tables/units.hpp"

namespace packmpi::tables {
namespace {

/// A line of the file, for its complaints.
struct Line {
  const std::string& path;
  int number;

  [[noreturn]] void refuse(const std::string& words) const {
    throw Error(ExitCode::bad_input, fmt::format("{}:{}: {}", path, number, words));
  }
};

// No word of the file: the scene may be a stranger's, and the file one that is none of his business.
constexpr const char* no_table =
    "is no grading curve; the first line must name the columns, such as \"diameter_mm,percent_passing\", "
    "\"sieve_mm;percent_retained\" or \"sieve_mm;mass_retained_g\" (or _m, _cm, _um)";
constexpr const char* no_list =
    "is no list of sizes; the first line must name the columns, such as \"diameter_mm\" or \"radius_mm\" (or _m, _cm, "
    "_um)";

/// What a column holds. Of several columns the first of these kinds is taken.
enum class Kind { passing, cumulative, by_sieve, retained, other };
constexpr std::array kind_words{"percent passing", "cumulative retained", "retained by sieve", "percent retained", ""};

struct Head {
  std::vector<std::string> names;
  char separator = ',';
  std::size_t sieve = 0, value = 0;  ///< columns
  std::string unit;
  bool radius = false, mass = false;
  Kind kind = Kind::other;
};

struct Point {
  double diameter;  ///< [m]; 0: the pan
  double value;
  int line;
};

/// How numbers are written, of the whole file.
struct Style {
  bool points = false, commas = false;
};

std::vector<std::string> cells_of(const std::string& line, char separator) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == separator && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  for (std::string& cell : cells) cell = std::string(text::trimmed(cell));
  while (cells.size() > 1 && cells.back().empty()) cells.pop_back();
  return cells;
}

/// "Percent retained [%]" as percent, retained. Bytes beyond ASCII are letters (µm).
std::vector<std::string> words_in(const std::string& cell) {
  std::vector<std::string> words;
  bool inside = false;
  for (const char c : cell) {
    const auto byte = static_cast<unsigned char>(c);
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || byte >= 0x80;
    if (letter && !inside) words.emplace_back();
    if (letter) words.back() += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    inside = letter;
  }
  return words;
}

bool any_of(const std::vector<std::string>& words, std::initializer_list<std::string_view> names) {
  return std::ranges::any_of(words, [&](const auto& word) { return std::ranges::find(names, word) != names.end(); });
}

Kind kind_of(const std::vector<std::string>& words) {
  if (any_of(words, {"passing", "passed", "finer", "undersize"})) return Kind::passing;
  if (!any_of(words, {"retained", "coarser", "oversize"})) return Kind::other;
  if (any_of(words, {"cumulative", "cum"})) return Kind::cumulative;
  if (any_of(words, {"by", "per", "each", "individual", "partial"})) return Kind::by_sieve;
  return any_of(words, {"mass", "weight", "g", "kg"}) ? Kind::by_sieve : Kind::retained;
}

bool is_sieve(const std::vector<std::string>& words) {
  return any_of(words, {"diameter", "sieve", "size", "opening", "aperture", "radius", "d"}) &&
         kind_of(words) == Kind::other;
}

char separator_of(const std::string& line) {
  for (const char c : {';', '\t'}) {
    if (line.find(c) != std::string::npos) return c;
  }
  return ',';
}

/// `otherwise`: the complaint of a line that names no column of sizes.
Head read_head(const std::string& text, const Line& line, std::optional<char> separator, const char* otherwise) {
  Head head;
  head.separator = separator.value_or(separator_of(text));
  head.names = cells_of(text, head.separator);
  bool sieves = false;
  for (std::size_t k = 0; k < head.names.size(); ++k) {
    const std::vector<std::string> words = words_in(head.names[k]);
    if (!sieves && is_sieve(words)) {
      sieves = true;
      head.sieve = k;
      head.radius = any_of(words, {"radius"});
      const auto unit =
          std::ranges::find_if(words, [](const auto& w) { return parse_scalar("1 " + w, length).value.has_value(); });
      if (unit == words.end()) line.refuse(otherwise);
      head.unit = *unit;
    } else if (const Kind kind = kind_of(words); kind < head.kind) {
      head.kind = kind;
      head.value = k;
      head.mass = any_of(words, {"mass", "weight", "g", "kg"}) && !any_of(words, {"percent"}) &&
                  head.names[k].find('%') == std::string::npos;
    }
  }
  if (!sieves) line.refuse(otherwise);
  return head;
}

/// A number of a cell, `unit` being that of the column; of a percentage or a mass, "m" is as good as any.
double number_of(std::string cell, const std::string& unit, Style& style, const Line& line) {
  const std::string written = cell;
  if (cell.ends_with('%')) cell = std::string(text::trimmed(std::string_view(cell).substr(0, cell.size() - 1)));
  const auto comma = cell.find(',');
  const bool point = cell.find('.') != std::string::npos;
  style.points |= point;
  style.commas |= comma != std::string::npos;
  if (style.points && style.commas) {
    line.refuse(fmt::format("{}: the file has decimal points and decimal commas, or thousands; use one kind alone",
                            toml_string(written)));
  }
  if (comma != std::string::npos) cell[comma] = '.';
  Scalar scalar = parse_scalar(cell + " " + unit, length);
  if (!scalar.value) scalar = parse_scalar(cell, length);
  if (!scalar.value) {
    line.refuse(fmt::format("{} is not a number; write 4.75,63.2 (a point), or 4,75;63,2", toml_string(written)));
  }
  return *scalar.value;
}

bool is_pan(std::string cell) {
  std::ranges::transform(cell, cell.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return cell == "pan" || cell == "rest" || cell == "bottom";
}

Point read_point(const std::string& text, const Head& head, Style& style, const Line& line) {
  const std::vector<std::string> cells = cells_of(text, head.separator);
  if (cells.size() > head.names.size() || cells.size() <= std::max(head.sieve, head.value)) {
    line.refuse(
        fmt::format("has {} cell{}, the first line has {}; give as many, and where decimals have commas, "
                    "separate columns by semicolons",
                    cells.size(), cells.size() == 1 ? "" : "s", head.names.size()));
  }
  Point point{.diameter = 0.0, .value = number_of(cells[head.value], "m", style, line), .line = line.number};
  if (!is_pan(cells[head.sieve])) {
    point.diameter = (head.radius ? 2.0 : 1.0) * number_of(cells[head.sieve], head.unit, style, line);
    const bool pan = point.diameter == 0.0 && !std::signbit(point.diameter);
    if (!pan && !(point.diameter > 0.0)) line.refuse("a diameter must be above 0");
  }
  if (point.value < 0.0 || (!head.mass && point.value > 100.0)) {
    line.refuse(head.mass ? fmt::format("{:g} is below 0; give masses", point.value)
                          : fmt::format("{:g} percent; give 0 to 100", point.value));
  }
  return point;
}

/// A file's points, the finest first.
struct Sieves {
  std::vector<Point> points;  ///< without the pan
  std::optional<Point> pan;
  std::string order;  ///< in the file
};

Sieves sorted(std::vector<Point> points, const std::string& path) {
  Sieves sieves;
  const auto up = [](const Point& a, const Point& b) { return a.diameter < b.diameter; };
  const auto down = [](const Point& a, const Point& b) { return a.diameter > b.diameter; };
  sieves.order = std::ranges::is_sorted(points, up)     ? ""
                 : std::ranges::is_sorted(points, down) ? ", coarsest first"
                                                        : ", in no order";
  std::ranges::stable_sort(points, up);
  for (std::size_t k = 1; k < points.size(); ++k) {
    if (points[k - 1].diameter == points[k].diameter)
      Line{path, points[k].line}.refuse(fmt::format("the sieve of line {} is there again", points[k - 1].line));
  }
  if (!points.empty() && points.front().diameter == 0.0) {
    sieves.pan = points.front();
    points.erase(points.begin());
  }
  sieves.points = std::move(points);
  return sieves;
}

constexpr double rounding = 1.0;  // percent, by which shares may miss 100: each is rounded

double sum_of(const Sieves& sieves) {
  double sum = sieves.pan ? sieves.pan->value : 0.0;
  for (const Point& point : sieves.points) sum += point.value;
  return sum;
}

/// Whether shares that are just "retained" are each sieve's own, or cumulative.
Kind which(const Sieves& sieves, const Line& head) {
  const double sum = sum_of(sieves);
  const bool falls = std::ranges::is_sorted(sieves.points, std::greater{}, &Point::value);  // with the diameter
  const bool by_sieve = sieves.pan ? std::abs(sum - 100.0) <= rounding : sum <= 100.0 + rounding;
  const bool cumulative = falls && (!sieves.pan || sieves.pan->value == 100.0);
  if (by_sieve && cumulative) {
    head.refuse(
        "percent retained may be each sieve's own or cumulative here; name the column percent_retained_by_sieve or "
        "cumulative_percent_retained");
  }
  if (!by_sieve && !cumulative) {
    head.refuse(
        fmt::format("percent retained is neither cumulative, as it does not grow to finer sieves, nor each "
                    "sieve's own, as the sum is {:g}; check the numbers",
                    sum));
  }
  return by_sieve ? Kind::by_sieve : Kind::cumulative;
}

Curve from_shares(const Sieves& sieves, const Head& head, const Line& line) {
  double total = sum_of(sieves);
  double below = sieves.pan ? sieves.pan->value : 0.0;
  if (head.mass && !sieves.pan) {
    line.refuse("masses by sieve do not tell what passes the finest; add a line for the pan, such as \"pan,0\"");
  }
  if (!head.mass && std::abs(total - 100.0) > rounding) {
    if (sieves.pan || total > 100.0) line.refuse(fmt::format("the shares add up to {:g} percent; give 100", total));
    below = 100.0 - total;
    total = 100.0;
  }
  if (!(total > 0.0)) line.refuse("all is 0; check the numbers");
  Curve curve;
  for (const Point& point : sieves.points) {
    curve.push_back({point.diameter, std::min(100.0, 100.0 * (below / total))});
    below += point.value;
  }
  return curve;
}

Curve from_cumulative(const Sieves& sieves, const Head& head, const Line& line) {
  if (head.mass && !sieves.pan) {
    line.refuse("cumulative masses need the whole; add a line for the pan with the mass of all");
  }
  const double total = head.mass ? sieves.pan->value : 100.0;
  if (!(total > 0.0)) line.refuse("the mass of all is 0; check the numbers");
  Curve curve;
  for (const Point& point : sieves.points) {
    if (point.value > total) Line{line.path, point.line}.refuse("is more than all; check the numbers");
    curve.push_back({point.diameter, 100.0 * (1.0 - point.value / total)});
  }
  return curve;
}

Curve curve_of(const Sieves& sieves, Head& head, const Line& line) {
  if (head.kind == Kind::retained) head.kind = which(sieves, line);
  if (head.kind == Kind::by_sieve) return from_shares(sieves, head, line);
  if (head.kind == Kind::cumulative) return from_cumulative(sieves, head, line);
  Curve curve;
  for (const Point& point : sieves.points) curve.push_back({point.diameter, point.value});
  return curve;
}

std::string as_written(const Style& style, bool mark) {
  return fmt::format("{}{}", style.commas ? ", decimal commas" : "", mark ? ", with a byte-order mark" : "");
}

std::string reading_of(const std::string& path, const Head& head, const Sieves& sieves, const Style& style, bool mark) {
  std::string words =
      fmt::format("{}: read as {}{} over {} in {}", path, head.mass ? "mass, " : "",
                  kind_words.at(static_cast<std::size_t>(head.kind)), head.radius ? "radii" : "diameters", head.unit);
  if (head.names.size() > 2) words += fmt::format(" (columns {} and {})", head.value + 1, head.sieve + 1);
  words += sieves.order + as_written(style, mark);
  if (sieves.pan) words += ", with a pan";
  words += fmt::format(": {} sieves", sieves.points.size());
  if (sieves.points.empty()) return words;
  return words +
         fmt::format(", diameters {:g} to {:g} m", sieves.points.front().diameter, sieves.points.back().diameter);
}

/// Takes the mark off the front of UTF-8, and the CR of CRLF; refuses UTF-16.
bool take_mark(std::string& text, const Line& line) {
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) line.refuse("is UTF-16; save it as CSV in UTF-8");
  const bool mark = text.starts_with("\xef\xbb\xbf");
  if (mark) text.erase(0, 3);
  if (text.find('\n') == std::string::npos) std::ranges::replace(text, '\r', '\n');
  std::erase(text, '\r');
  return mark;
}

/// The lines of a file that say something, after the mark and "sep=" of Excel.
struct Lines {
  std::vector<std::pair<int, std::string>> lines;  ///< with their numbers
  std::optional<char> separator;
  bool mark = false;
};

Lines lines_of(const CurveFile& file) {
  Lines found;
  std::string whole = file.text;
  found.mark = take_mark(whole, {file.path, 1});
  std::istringstream stream(whole);
  int number = 0;
  for (std::string text; std::getline(stream, text);) {
    ++number;
    const std::string_view seen = text::trimmed(text);
    if (seen.empty() || seen.front() == '#' || seen.starts_with("\"#")) continue;
    if (found.lines.empty() && seen.starts_with("sep=") && seen.size() == 5) {
      found.separator = seen.back();
    } else {
      found.lines.emplace_back(number, text);
    }
  }
  return found;
}

}  // namespace

SieveTable read_sieve_table(const CurveFile& file) {
  const Lines found = lines_of(file);
  if (found.lines.empty())
    Line{file.path, 1}.refuse("is empty; the first line must be \"diameter_mm,percent_passing\"");
  const Line first{file.path, found.lines.front().first};
  Head head = read_head(found.lines.front().second, first, found.separator, no_table);
  if (head.kind == Kind::other) first.refuse(no_table);
  if (found.lines.size() > 10000) first.refuse("more than 10000 points; is it a grading curve?");
  Style style;
  std::vector<Point> points;
  for (const auto& [number, text] : std::span(found.lines).subspan(1)) {
    points.push_back(read_point(text, head, style, {file.path, number}));
  }
  const Sieves sieves = sorted(std::move(points), file.path);
  SieveTable table{.curve = curve_of(sieves, head, first), .reading = ""};
  table.reading = reading_of(file.path, head, sieves, style, found.mark);
  return table;
}

SizeList read_size_list(const CurveFile& file) {
  const Lines found = lines_of(file);
  if (found.lines.empty())
    Line{file.path, 1}.refuse("is empty; the first line must be \"diameter_mm\" or \"radius_mm\"");
  const Line first{file.path, found.lines.front().first};
  const Head head = read_head(found.lines.front().second, first, found.separator, no_list);
  Style style;
  SizeList list;
  for (const auto& [number, text] : std::span(found.lines).subspan(1)) {
    const Line line{file.path, number};
    const std::vector<std::string> cells = cells_of(text, head.separator);
    if (cells.size() <= head.sieve) line.refuse(fmt::format("has no column {}", head.sieve + 1));
    const double size = number_of(cells[head.sieve], head.unit, style, line);
    if (!(size > 0.0)) line.refuse("a size must be above 0");
    list.radii.push_back(head.radius ? size : 0.5 * size);
  }
  if (list.radii.empty()) Line{file.path, 1}.refuse("has no sizes; give one a line");
  const auto [least, most] = std::ranges::minmax(list.radii);
  list.reading = fmt::format("{}: read as {} in {}{}: {} sizes, diameters {:g} to {:g} m", file.path,
                             head.radius ? "radii" : "diameters", head.unit, as_written(style, found.mark),
                             list.radii.size(), 2.0 * least, 2.0 * most);
  return list;
}

}  // namespace packmpi::tables
