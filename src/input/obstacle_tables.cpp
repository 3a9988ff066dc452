#include "input/obstacle_tables.hpp"

#include <fmt/format.h>

#include "config/named_files.hpp"
#include "config/words.hpp"
#include "input/array_tables.hpp"

namespace packmpi::input {
namespace {

constexpr std::size_t most_obstacles = 500;

/// One [[obstacle]] on its way to the struct.
struct Reader {
  const Node& table;
  Obstacle to = {};

  /// The entry, which has to be there, or may not.
  const Node* find(std::string_view name, bool wanted, bool needed) const {
    const Node* node = entry(table, name);
    const std::string path = fmt::format("obstacle.{}", name);
    const std::string_view shape = word(to.shape);
    if (node != nullptr && !wanted) {
      document::fail(node->place, path, fmt::format("a {} has none; remove it", shape));
    }
    if (node == nullptr && wanted && needed) {
      document::fail(table.place, path, fmt::format("is missing; a {} has one", shape));
    }
    return node;
  }
  template <class Value>
  void read(std::string_view name, bool wanted, bool needed, Value& value, Key key) const {
    const Node* node = find(name, wanted, needed);
    const std::string path = fmt::format("obstacle.{}", name);
    key.path = path;
    if (node != nullptr) store_in(value, key, *node);
  }
  Obstacle take() {
    const Key text{.path = "", .slot = {}};
    const Key extent{.path = "", .slot = {}, .quantity = &length, .unit = length.si, .range = above_zero};
    Key extents = extent, place = extent;
    extents.count = place.count = Count::axes;
    place.range = {};
    read("shape", true, false, to.shape, text);
    if (entry(table, "shape") == nullptr)
      document::fail(table.place, "obstacle.shape", "is missing; give \"sphere\", \"cylinder\", \"box\" or \"mesh\"");
    const bool rounded = to.shape == Body::sphere || to.shape == Body::cylinder, mesh = to.shape == Body::mesh;
    read("diameter", rounded, true, to.diameter, extent);
    read("length", to.shape == Body::cylinder, true, to.length, extent);
    read("axis", to.shape == Body::cylinder, false, to.axis, text);
    read("size", to.shape == Body::box, true, to.size, extents);
    read("file", mesh, true, to.file, text);
    if (mesh) check_name(entry(table, "file")->place, "obstacle.file", to.file, "mesh");
    to.unit = std::string("m");
    read("unit", mesh, false, to.unit, text);
    Vec3 position{};
    read("position", true, !mesh, position, place);
    if (entry(table, "position") != nullptr) to.position = position;
    to.place = table.place;
    return std::move(to);
  }
};

}  // namespace

std::vector<Obstacle> take_obstacle_tables(document::Document& document) {
  constexpr std::array<std::string_view, 8> names{"shape", "diameter", "length", "axis",
                                                  "size",  "file",     "unit",   "position"};
  std::vector<Obstacle> obstacles;
  for (const Node& table : tables_at(document, "obstacle")) {
    refuse_unknown_in(table, "obstacle", names);
    if (obstacles.size() == most_obstacles) {
      document::fail(table.place, "obstacle",
                     fmt::format("there are more than {}, the limit; draw them as one mesh", most_obstacles));
    }
    obstacles.push_back(Reader{table}.take());
  }
  return obstacles;
}

}  // namespace packmpi::input
