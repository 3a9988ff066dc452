#include "config/obstacles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "config/mesh_vessel.hpp"
#include "mesh/bodies.hpp"
#include "mesh/vectors.hpp"

namespace packmpi::input {
namespace {

using Triangles = std::vector<mesh::Corners>;

using mesh::moved;

Triangles box_of(const Vec3& size) {
  return mesh::prism_over({{0.0, 0.0}, {size[0], 0.0}, {size[0], size[1]}, {0.0, size[1]}}, size[2]);
}

Triangles cylinder_of(double radius, double length) {
  return mesh::body_of_revolution({{0.0, 0.0}, {radius, 0.0}, {radius, length}, {0.0, length}});
}

/// x, y, z of a body about the z axis become those of one about another.
Vec3 about(Axis axis, const Vec3& x) {
  if (axis == Axis::x) return {x[2], x[0], x[1]};
  return axis == Axis::y ? Vec3{x[1], x[2], x[0]} : x;
}

Triangles read_body(const Obstacle& one, const std::string& scene, const std::vector<tables::CurveFile>& files) {
  const auto file = std::ranges::find(files, beside(scene, one.file), &tables::CurveFile::path);
  if (file == files.end())
    document::fail(one.place, "obstacle.file", "no file comes with this text; give the path of an STL or OBJ file");
  const double unit = metres(one.place, "obstacle.unit", one.unit);
  try {
    return moved(mesh::read_triangles(file->text, file->path), [&](const Vec3& x) { return mesh::times(unit, x); });
  } catch (const Error& error) {
    document::fail(one.place, "obstacle.file", error.what());
  }
}

Triangles body_of(const Obstacle& one, const std::string& scene, const std::vector<tables::CurveFile>& files) {
  switch (one.shape) {
    case Body::sphere:
      return mesh::sphere_of_facets(0.5 * one.diameter);
    case Body::cylinder:
      return moved(cylinder_of(0.5 * one.diameter, one.length), [&](const Vec3& x) { return about(one.axis, x); });
    case Body::box:
      return box_of(one.size);
    case Body::mesh:
      return read_body(one, scene, files);
  }
  return {};
}

void add(Triangles& all, const Triangles& more) { all.insert(all.end(), more.begin(), more.end()); }

Triangles triangles_of(const mesh::Shell& shell) {
  Triangles triangles;
  for (std::size_t t = 0; t < shell.triangles.size(); ++t) triangles.push_back(shell.corners(t));
  return triangles;
}

/// The first obstacle that meets what is there before it is refused.
void refuse_what_meets(const Input& in, Triangles all, const std::vector<Triangles>& obstacles) {
  for (std::size_t k = 0; k < obstacles.size(); ++k) {
    add(all, obstacles[k]);
    try {
      (void)mesh::close(all, "");
    } catch (const Error&) {
      document::fail(in.obstacles[k].place, "obstacle",
                     fmt::format("obstacle {} meets the vessel or an obstacle before it; leave a gap, however small: "
                                 "nothing fits into it",
                                 k + 1));
    }
  }
}

/// The first obstacle that lies in another one is refused.
void refuse_what_is_inside(const Input& in, const std::vector<Triangles>& obstacles) {
  for (std::size_t k = 0; k < obstacles.size(); ++k) {
    const mesh::Surface other(obstacles[k], "obstacle");
    for (std::size_t j = 0; j < obstacles.size(); ++j) {
      if (j == k || other.beyond(obstacles[j].front()[0]) > 0.0) continue;
      document::fail(in.obstacles[j].place, "obstacle",
                     fmt::format("obstacle {} lies inside obstacle {}; remove it", j + 1, k + 1));
    }
  }
}

/// No more than a pack may hold the text of: told before the work on them.
void refuse_many(const Input& in, std::size_t triangles, const std::vector<Triangles>& obstacles) {
  constexpr std::size_t most = 60'000;
  for (const Triangles& body : obstacles) triangles += body.size();
  if (triangles <= most) return;
  document::fail(in.obstacles.front().place, "obstacle",
                 fmt::format("with the obstacles the vessel has {} triangles, and {} are the limit; leave some out, or "
                             "simplify them",
                             triangles, most));
}

/// Of an obstacle that is closed, lies in the vessel and is not so small that its corners would be one there.
double volume_of(const Obstacle& one, std::size_t number, const Triangles& body, const mesh::Surface& vessel) {
  const auto refuse = [&](const std::string& words) {
    document::fail(one.place, "obstacle", fmt::format("obstacle {} {}", number, words));
  };
  const auto [low, high] = mesh::box_around(body);
  const Vec3 widths = mesh::minus(high, low), extent = mesh::minus(vessel.high(), vessel.low());
  const bool round = one.shape == Body::sphere || one.shape == Body::cylinder;
  const double width = *std::ranges::min_element(widths),
               least = *std::ranges::max_element(extent) * (round ? 1e-3 : 1e-5);
  if (width < least)
    refuse(fmt::format("is {:.3g} m wide; less than {:.3g} m is too little in this vessel", width, least));
  if (const Vec3& x = body.front()[0]; vessel.beyond(x) > 0.0) {
    refuse(fmt::format("does not lie in the vessel: ({:g}, {:g}, {:g}) m of it is outside; move it by its position",
                       x[0], x[1], x[2]));
  }
  try {
    return mesh::close(body, fmt::format("obstacle {}", number)).volume();
  } catch (const Error& error) {
    document::fail(one.place, "obstacle", error.what());
  }
}

}  // namespace

Triangles drawn_vessel(const document::Document& document, const Input& in) {
  const Container& c = in.container;
  const std::string& place = in.obstacles.front().place;
  if (c.dimension != 3) document::fail(place, "obstacle", "is a body in 3D; give container.dimension = 3");
  if (std::ranges::find(c.boundary, Boundary::periodic) != c.boundary.end()) {
    document::fail(document.place("container.boundary"), "container.boundary",
                   "a container with an [[obstacle]] has walls on all sides; give \"wall\"");
  }
  if (c.shape == VesselShape::annulus && !(c.inner_diameter < c.diameter)) {
    document::fail(document.place("container.inner_diameter"), "container.inner_diameter",
                   fmt::format("{:g} m leaves no room in container.diameter = {:g} m; make it smaller",
                               c.inner_diameter, c.diameter));
  }
  const double radius = 0.5 * c.diameter, core = 0.5 * c.inner_diameter;
  const auto upright = [](Triangles triangles, double r) {
    return moved(std::move(triangles), [&](const Vec3& x) { return Vec3{x[0] + r, x[1] + r, x[2]}; });
  };
  switch (c.shape) {
    case VesselShape::cylinder:
      return upright(cylinder_of(radius, c.height), radius);
    case VesselShape::frustum: {
      const double low = 0.5 * c.bottom_diameter, high = 0.5 * c.top_diameter;
      return upright(mesh::body_of_revolution({{0.0, 0.0}, {low, 0.0}, {high, c.height}, {0.0, c.height}}),
                     std::max(low, high));
    }
    case VesselShape::sphere:
      return moved(mesh::sphere_of_facets(radius), [&](const Vec3& x) {
        return Vec3{x[0] + radius, x[1] + radius, x[2] + radius};
      });
    case VesselShape::annulus:
      return upright(mesh::body_of_revolution({{core, 0.0}, {radius, 0.0}, {radius, c.height}, {core, c.height}}),
                     radius);
    default:
      return box_of({c.size[0], c.size[1], c.size[2]});
  }
}

std::vector<Triangles> drawn_obstacles(const Input& in, const std::vector<tables::CurveFile>& files,
                                       const Vec3& shift) {
  std::vector<Triangles> bodies;
  for (const Obstacle& one : in.obstacles) {
    Triangles body = body_of(one, in.file, files);
    const auto [low, high] = mesh::box_around(body);
    Vec3 by = shift;
    if (one.position) by = mesh::plus(by, mesh::minus(*one.position, mesh::times(0.5, mesh::plus(low, high))));
    bodies.push_back(moved(std::move(body), [&](const Vec3& x) { return mesh::plus(x, by); }));
  }
  return bodies;
}

std::shared_ptr<const mesh::Surface> interior_around(const Input& in, const mesh::Surface& vessel,
                                                     const std::vector<Triangles>& obstacles) {
  const Triangles before = triangles_of(vessel.shell());
  refuse_many(in, before.size(), obstacles);
  Triangles all = before;
  double volume = vessel.volume();
  for (std::size_t k = 0; k < obstacles.size(); ++k) {
    volume -= volume_of(in.obstacles[k], k + 1, obstacles[k], vessel);
    add(all, obstacles[k]);
  }
  try {
    auto interior = std::make_shared<const mesh::Surface>(all, "mesh");
    if (std::abs(interior->volume() - volume) > 1e-9 * vessel.volume()) refuse_what_is_inside(in, obstacles);
    return interior;
  } catch (const Error&) {
    refuse_what_meets(in, before, obstacles);
    throw;
  }
}

}  // namespace packmpi::input
