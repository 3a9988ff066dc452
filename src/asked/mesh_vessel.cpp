#include "asked/mesh_vessel.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "mesh/file.hpp"
#include "tables/units.hpp"

namespace packmpi::input {
namespace {

constexpr std::size_t longest_surface = std::size_t{3} << 20U;  // of its text, which stands in every pack
constexpr std::string_view mesh_file = "container.file", mesh_unit = "container.unit", mesh_text = "container.surface";

/// What a unit of the file is [m].
double metres(const document::Document& document, const std::string& unit) {
  const tables::Scalar read = tables::parse_scalar("1 " + unit, tables::length);
  if (read.value) return *read.value;
  document::fail(document.place(mesh_unit), mesh_unit,
                 fmt::format("is {}; give a unit of lengths, such as \"mm\"", tables::toml_string(unit)));
}

/// With the lower corner of the box around them at the origin.
void move_to_origin(std::vector<mesh::Corners>& triangles, double unit) {
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL};
  for (mesh::Corners& corners : triangles) {
    for (Vec3& x : corners) {
      for (std::size_t a = 0; a < 3; ++a) low[a] = std::min(low[a], x[a] *= unit);
    }
  }
  for (mesh::Corners& corners : triangles) {
    for (Vec3& x : corners) {
      for (std::size_t a = 0; a < 3; ++a) x[a] = x[a] - low[a] + 0.0;  // no -0
    }
  }
}

/// An upright prism over a convex polygon, of corners that go round anticlockwise: floor and lid, and its sides.
std::vector<mesh::Corners> prism_over(const Curve& corners, double height) {
  const auto at = [&](std::size_t k, double z) {
    const auto& [x, y] = corners[k % corners.size()];
    return Vec3{x, y, z};
  };
  std::vector<mesh::Corners> triangles;
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    triangles.push_back({at(0, 0.0), at(k + 1, 0.0), at(k, 0.0)});
    triangles.push_back({at(0, height), at(k, height), at(k + 1, height)});
  }
  for (std::size_t k = 0; k < corners.size(); ++k) {
    triangles.push_back({at(k, 0.0), at(k + 1, 0.0), at(k + 1, height)});
    triangles.push_back({at(k, 0.0), at(k + 1, height), at(k, height)});
  }
  return triangles;
}

/// Is every corner to the left of every side but its ends? Only of a convex polygon that goes round once,
/// anticlockwise.
bool is_convex(const Curve& corners) {
  const std::size_t n = corners.size();
  for (std::size_t k = 0; k < n; ++k) {
    const auto &a = corners[k], &b = corners[(k + 1) % n];
    for (std::size_t j = 2; j < n; ++j) {
      const auto& c = corners[(k + j) % n];
      if (!((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0)) return false;
    }
  }
  return n >= 3;
}

/// A prism becomes the mesh that it is.
void take_prism(const document::Document& document, Container& c) {
  constexpr std::string_view key = "container.polygon";
  constexpr std::size_t most = 1000;
  Curve corners = c.polygon;
  if (corners.size() > 2 && corners.size() <= most && !is_convex(corners)) std::ranges::reverse(corners);
  if (corners.size() > most || !is_convex(corners)) {
    document::fail(
        document.place(key), key,
        "is no convex polygon of 3 to 1000 corners that go round once, each of which turns; draw other rooms "
        "in a CAD program, for shape = \"mesh\"");
  }
  std::vector<mesh::Corners> triangles = prism_over(corners, c.height);
  move_to_origin(triangles, 1.0);
  try {
    c.surface = mesh::obj_text(mesh::Shell(mesh::close(triangles, "the prism")));
  } catch (const Error& error) {
    document::fail(document.place(key), key, error.what());
  }
  c.shape = VesselShape::mesh;
  c.unit = std::string("m");
  c.polygon.clear();
}

}  // namespace

void take_mesh(const document::Document& document, const std::optional<tables::CurveFile>& file, Input& in) {
  Container& c = in.container;
  if (c.shape == VesselShape::prism) take_prism(document, c);
  if (c.shape != VesselShape::mesh) return;
  const bool named = !c.file.empty();
  const std::string_view key = named ? mesh_file : mesh_text;
  const auto refuse = [&](const std::string& words) { document::fail(document.place(key), key, words); };
  if (named && !c.surface.empty()) refuse("there is a surface, too; remove one of them");
  if (named && !file) refuse("no file comes with this text; give surface");
  if (!named && c.surface.empty())
    document::fail(document.place(mesh_file), mesh_file, "is missing; give the name of an STL or OBJ file");
  const double unit = metres(document, c.unit);
  try {
    auto triangles =
        named ? mesh::read_triangles(file->text, file->path) : mesh::read_triangles(c.surface, "surface.obj");
    move_to_origin(triangles, unit);
    c.mesh = std::make_shared<const mesh::Surface>(triangles, named ? file->path : "mesh");
  } catch (const Error& error) {
    refuse(error.what());
  }
  const mesh::Shell& shell = c.mesh->shell();
  if (named) {
    in.remarks.push_back(fmt::format("{}: {} triangles{}, a room of {:.6g} m3 in {:g} x {:g} x {:g} m", file->path,
                                     shell.triangles.size(), mesh::mended_words(shell.mended), c.mesh->volume(),
                                     shell.high[0], shell.high[1], shell.high[2]));
  }
  c.surface = mesh::obj_text(shell);
  const auto lines = static_cast<std::size_t>(std::ranges::count(c.surface, '\n'));
  if (c.surface.size() + 5 * lines > longest_surface) {  // as TOML escapes them
    refuse(
        fmt::format("{} triangles are too many for a vessel: their text in a pack would be longer than 3 MiB; simplify "
                    "the surface",
                    shell.triangles.size()));
  }
  c.file.clear();
  c.unit = std::string("m");  // of a char array, GCC 12 warns wrongly
}

}  // namespace packmpi::input
