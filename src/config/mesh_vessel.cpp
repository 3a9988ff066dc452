#include "config/mesh_vessel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "base/error.hpp"
#include "config/obstacles.hpp"
#include "config/vessel.hpp"
#include "mesh/bodies.hpp"
#include "mesh/file.hpp"
#include "mesh/vectors.hpp"
#include "tables/units.hpp"

namespace packmpi::input {
namespace {

constexpr std::size_t longest_surface = std::size_t{3} << 20U;  // of its text, which stands in every pack
constexpr std::string_view mesh_file = "container.file", mesh_unit = "container.unit", mesh_text = "container.surface";

/// Moves the lower corner of the box around them to the origin, by what is returned.
Vec3 move_to_origin(std::vector<mesh::Corners>& triangles, double unit) {
  triangles = mesh::moved(std::move(triangles), [&](const Vec3& x) { return mesh::times(unit, x); });
  const Vec3 low = mesh::box_around(triangles)[0];
  triangles = mesh::moved(std::move(triangles), [&](const Vec3& x) {
    return Vec3{x[0] - low[0] + 0.0, x[1] - low[1] + 0.0, x[2] - low[2] + 0.0};  // no -0
  });
  return {-low[0], -low[1], -low[2]};
}

/// A prism becomes the mesh that it is.
void take_prism(const document::Document& document, Container& c) {
  constexpr std::string_view key = "container.polygon";
  const Curve corners =
      corners_of(document, c.polygon, 1000, "draw other rooms in a CAD program, for shape = \"mesh\"");
  std::vector<mesh::Corners> triangles = mesh::prism_over(corners, c.height);
  (void)move_to_origin(triangles, 1.0);
  try {
    c.surface = mesh::obj_text(mesh::Shell(mesh::close(triangles, "the prism")));
  } catch (const Error& error) {
    document::fail(document.place(key), key, error.what());
  }
  c.shape = VesselShape::mesh;
  c.unit = std::string("m");
  c.polygon.clear();
}

/// The triangles of a mesh, in the file that it names or in the scene [m].
std::vector<mesh::Corners> read_vessel(const document::Document& document, const std::vector<tables::CurveFile>& files,
                                       const Input& in) {
  const Container& c = in.container;
  const bool named = !c.file.empty();
  const std::string_view key = named ? mesh_file : mesh_text;
  const auto refuse = [&](const std::string& words) { document::fail(document.place(key), key, words); };
  const auto file = std::ranges::find(files, beside(in.file, c.file), &tables::CurveFile::path);
  if (named && !c.surface.empty()) refuse("there is a surface, too; remove one of them");
  if (named && file == files.end()) refuse("no file comes with this text; give surface");
  if (!named && c.surface.empty())
    document::fail(document.place(mesh_file), mesh_file, "is missing; give the name of an STL or OBJ file");
  const double unit = metres(document.place(mesh_unit), mesh_unit, c.unit);
  std::vector<mesh::Corners> triangles;
  try {
    triangles = named ? mesh::read_triangles(file->text, file->path) : mesh::read_triangles(c.surface, "surface.obj");
  } catch (const Error& error) {
    refuse(error.what());
  }
  (void)move_to_origin(triangles, unit);
  return triangles;
}

/// How the surface was read, for the log.
std::string reading_of(const mesh::Surface& surface, const std::string& name, const mesh::Mended& mended) {
  const mesh::Shell& shell = surface.shell();
  return fmt::format("{}: {} triangles{}, an interior of {:.6g} m3 in {:g} x {:g} x {:g} m", name,
                     shell.triangles.size(), mesh::mended_words(mended), surface.volume(), shell.high[0], shell.high[1],
                     shell.high[2]);
}

}  // namespace

double metres(const std::string& place, std::string_view key, const std::string& unit) {
  const tables::Scalar read = tables::parse_scalar("1 " + unit, tables::length);
  if (read.value) return *read.value;
  document::fail(place, key, fmt::format("is {}; give a unit of lengths, such as \"mm\"", tables::toml_string(unit)));
}

std::string beside(const std::string& scene, const std::string& name) {
  return (std::filesystem::path(scene).parent_path() / name).string();
}

void take_mesh(const document::Document& document, const std::vector<tables::CurveFile>& files, Input& in) {
  Container& c = in.container;
  if (c.shape == VesselShape::prism) take_prism(document, c);
  const bool drawn = c.shape != VesselShape::mesh;
  if (drawn && in.obstacles.empty()) return;
  const bool boxed = c.shape == VesselShape::box;
  const std::string_view key = drawn            ? (boxed ? "container.size" : "container.height")
                               : c.file.empty() ? mesh_text
                                                : mesh_file;
  std::vector<mesh::Corners> triangles = drawn ? drawn_vessel(document, in) : read_vessel(document, files, in);
  const Vec3 shift = drawn ? move_to_origin(triangles, 1.0) : Vec3{};
  const std::string name = c.file.empty() ? "mesh" : beside(in.file, c.file);
  if (boxed) c.height = c.size.back();
  c.shape = VesselShape::mesh;
  try {
    c.mesh = std::make_shared<const mesh::Surface>(triangles, name);
  } catch (const Error& error) {
    document::fail(document.place(key), key, error.what());
  }
  if (!c.file.empty()) in.remarks.push_back(reading_of(*c.mesh, name, c.mesh->shell().mended));
  if (!in.obstacles.empty()) {
    c.mesh = interior_around(in, *c.mesh, drawn_obstacles(in, files, shift));
    in.remarks.push_back(reading_of(*c.mesh, fmt::format("the container less {} obstacles", in.obstacles.size()), {}));
    in.obstacles.clear();
  }
  c.surface = mesh::obj_text(c.mesh->shell());
  const auto lines = static_cast<std::size_t>(std::ranges::count(c.surface, '\n'));
  if (c.surface.size() + 5 * lines > longest_surface) {  // as TOML escapes them
    document::fail(
        document.place(key), key,
        fmt::format("{} triangles are too many for a vessel: their text in a pack would be longer than 3 MiB; simplify "
                    "the surface",
                    c.mesh->shell().triangles.size()));
  }
  c.file.clear();
  c.unit = std::string("m");  // of a char array, GCC 12 warns wrongly
}

}  // namespace packmpi::input
