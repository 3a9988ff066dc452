// CSV files of particles.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/text.hpp"
#include "start/text_file.hpp"
#include "start/text_rows.hpp"
#include "tables/units.hpp"

namespace packmpi::start {
namespace {

enum Column { col_x, col_y, col_z, col_radius, col_vx, col_vy, col_vz, col_wx, col_wy, col_wz, column_count };
constexpr std::array<std::string_view, column_count> names{"x", "y", "z", "radius", "vx", "vy", "vz", "wx", "wy", "wz"};

struct Place {
  int cell = -1;     // -1: the file has it not
  int exponent = 0;  // of ten, to SI units
  bool diameter = false;
};

struct Table {
  std::array<Place, column_count> of;
  char separator = ',';
  std::size_t cells = 0, other = 0;  // columns; those that nobody wants

  [[nodiscard]] bool has(Column first, int count) const {
    const int end = first + count;
    for (int column = first; column < end; ++column) {
      if (of[static_cast<std::size_t>(column)].cell < 0) return false;
    }
    return true;
  }
};

// Of the line of names or of the first row.
char separator_of(std::string_view line) {
  for (const char c : {';', '\t', ','}) {
    if (line.find(c) != std::string_view::npos) return c;
  }
  return ' ';
}

// "Radius [mm]" begins with Radius; "" if a cell has no word.
std::string_view first_word(std::string_view cell) {
  const auto letter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || (c & 0x80) != 0; };
  const auto begin = std::ranges::find_if(cell, letter);
  return {begin, std::find_if_not(begin, cell.end(), letter)};
}

std::string lowered(std::string word) {
  std::ranges::transform(word, word.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return word;
}

// What a column is a quantity of.
const tables::Quantity& quantity_of(std::ptrdiff_t column) {
  if (column <= col_radius) return tables::length;
  return column <= col_vz ? tables::velocity : tables::angular_velocity;
}

// The unit behind a name, as "vx [mm/s]", "vx_mm/s" or "x_mm" have it: all that follows, without brackets.
std::string unit_behind(std::string_view cell, std::string_view first) {
  std::string unit;
  for (const char c : cell.substr(cell.find(first) + first.size())) {
    if (std::string_view(" _[](){}\"\r").find(c) == std::string_view::npos) unit += c;
  }
  return unit;
}

// The power of ten of that unit.
int exponent_of(const TextFile& file, std::string_view unit, std::string_view name, const tables::Quantity& quantity) {
  if (unit.empty()) return 0;
  const auto found = std::ranges::find(quantity.units, unit, &tables::Unit::name);
  if (found == quantity.units.end()) {
    const std::string_view other = quantity.example.substr(quantity.example.find(' ') + 1);
    file.refuse(fmt::format("column {} is in \"{}\", which is not known; write its name as \"{}\" ({}){}", name,
                            text::printable(unit), name, quantity.si,
                            other == quantity.si ? "" : fmt::format(" or \"{}_{}\"", name, other)));
  }
  return found->exponent;
}

Table table_of_names(const TextFile& file, std::string_view line, int dimension) {
  Table table;
  table.separator = separator_of(line);
  const std::vector<std::string_view> cells = cells_of(line, table.separator);
  table.cells = cells.size();
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const std::string_view word = first_word(cells[k]);
    std::string name = lowered(std::string(word));
    const bool diameter = name == "diameter" || name == "d";
    if (diameter || name == "r") name = "radius";
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) {
      ++table.other;
      continue;
    }
    Place& place = table.of[static_cast<std::size_t>(found - names.begin())];
    if (place.cell >= 0 && name == "radius") file.refuse("there are two columns of radii or diameters; leave one");
    if (place.cell >= 0) file.refuse(fmt::format("column {} is there twice; leave one", name));
    const tables::Quantity& quantity = quantity_of(found - names.begin());
    place = {static_cast<int>(k), exponent_of(file, unit_behind(cells[k], word), name, quantity), diameter};
  }
  for (const Column needed : {col_x, col_y, col_z, col_radius}) {
    if (table.of[needed].cell >= 0 || (needed == col_z && dimension == 2)) continue;
    file.refuse(fmt::format("there is no column {}; name the columns, such as \"x,y,z,radius\"", names[needed]));
  }
  return table;
}

// x, y, z, r.
Table table_without_names(const TextFile& file, std::string_view line, int dimension) {
  Table table;
  table.separator = separator_of(line);
  table.cells = cells_of(line, table.separator).size();
  const bool flat = dimension == 2 && table.cells == 3;
  if (table.cells != 4 && !flat)
    file.refuse(fmt::format("has {} columns and no names above them; give x, y, {}radius, or a line of names",
                            table.cells, dimension == 2 ? "" : "z, "));
  table.of[col_x].cell = 0, table.of[col_y].cell = 1;
  if (!flat) table.of[col_z].cell = 2;
  table.of[col_radius].cell = flat ? 2 : 3;
  return table;
}

bool all_numbers(std::string_view line) {
  const char separator = separator_of(line);
  double value = 0.0;
  return std::ranges::all_of(cells_of(line, separator),
                             [&](std::string_view cell) { return is_number(cell, separator != ',', value); });
}

double value_at(const TextFile& file, const Table& table, const std::vector<std::string_view>& cells, Column column) {
  const Place& place = table.of[column];
  double value = 0.0;
  if (!is_number(cells[static_cast<std::size_t>(place.cell)], table.separator != ',', value))
    file.refuse(fmt::format("column {} has no number", names[column]));
  // As the decimal number that it is: 20 mm is 0.02.
  if (place.exponent == 0) return value;
  return place.exponent > 0 ? value * std::pow(10.0, place.exponent) : value / std::pow(10.0, -place.exponent);
}

Vec3 vector_at(const TextFile& file, const Table& table, const std::vector<std::string_view>& cells, Column first) {
  Vec3 v{};
  for (int k = 0; k < 3; ++k) v[static_cast<std::size_t>(k)] = value_at(file, table, cells, Column(first + k));
  return v;
}

void take_row(const TextFile& file, const Table& table, std::string_view line, int dimension, bool mine,
              TextRows& found) {
  const std::vector<std::string_view> cells = cells_of(line, table.separator);
  if (cells.size() != table.cells) file.refuse(fmt::format("has {} columns instead of {}", cells.size(), table.cells));
  Vec3 position{value_at(file, table, cells, col_x), value_at(file, table, cells, col_y), 0.0};
  if (dimension == 3) position[2] = value_at(file, table, cells, col_z);
  const double size = value_at(file, table, cells, col_radius) * (table.of[col_radius].diameter ? 0.5 : 1.0);
  if (!(size > 0.0)) file.refuse("its radius is not above 0");
  const Vec3 velocity = table.has(col_vx, 3) ? vector_at(file, table, cells, col_vx) : Vec3{};
  const Vec3 spin = table.has(col_wx, 3) ? vector_at(file, table, cells, col_wx) : Vec3{};
  if (mine) {
    found.rows.id.push_back(found.total);
    found.rows.position.push_back(position);
    found.rows.radius.push_back(size);
    found.rows.velocity.push_back(velocity);
    found.rows.spin.push_back(spin);
    found.rows.layer.push_back(0);
    found.line.push_back(file.number());
  }
  ++found.total;
}

}  // namespace

TextRows read_csv(const std::string& path, int dimension, Rank rank, int ranks) {
  TextFile file(path);
  TextRows found;
  Table table;
  std::string line;
  while (file.next(line)) {
    const std::size_t begin = line.find_first_not_of(" \t,;");
    if (begin == std::string::npos || line[begin] == '#') continue;
    if (table.cells == 0) {
      const bool bare = all_numbers(line);
      table = bare ? table_without_names(file, line, dimension) : table_of_names(file, line, dimension);
      if (!bare) continue;
    }
    take_row(file, table, line, dimension, found.total % ranks == rank, found);
  }
  if (found.total == 0) file.refuse("there is no particle in it");
  found.taken = "positions, radii";
  if (table.has(col_vx, 3)) found.taken += ", velocities";
  if (table.has(col_wx, 3)) found.taken += ", spins";
  std::size_t others = table.other;
  for (const Column first : {col_vx, col_wx}) {
    for (int k = 0; k < 3 && !table.has(first, 3); ++k) others += table.has(Column(first + k), 1) ? 1 : 0;
  }
  if (others > 0) found.left = fmt::format("{} other column{}", others, others == 1 ? "" : "s");
  return found;
}

}  // namespace packmpi::start
