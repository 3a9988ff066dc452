#include "config/vessel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace packmpi::input {
namespace {

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

}  // namespace

Curve corners_of(const document::Document& document, Curve corners, std::size_t most, std::string_view otherwise) {
  constexpr std::string_view key = "container.polygon";
  if (corners.size() > 2 && corners.size() <= most && !is_convex(corners)) std::ranges::reverse(corners);
  if (corners.size() > most || !is_convex(corners)) {
    document::fail(document.place(key), key,
                   fmt::format("is no convex polygon of 3 to {} corners that go round once, each of which turns; {}",
                               most, otherwise));
  }
  std::array<double, 2> low = corners.front();
  for (const auto& corner : corners) {
    for (std::size_t a = 0; a < 2; ++a) low[a] = std::min(low[a], corner[a]);
  }
  for (auto& corner : corners) {
    for (std::size_t a = 0; a < 2; ++a) corner[a] = corner[a] - low[a] + 0.0;  // no -0
  }
  return corners;
}

void take_vessel(const document::Document& document, Container& container) {
  if (container.shape == VesselShape::box) return;
  std::array<double, 2> across{container.diameter, container.diameter};
  if (container.shape == VesselShape::frustum) across.fill(std::max(container.bottom_diameter, container.top_diameter));
  if (container.shape == VesselShape::mesh) across = {container.mesh->high()[0], container.mesh->high()[1]};
  if (container.shape == VesselShape::trapezium) {
    container.sides =
        std::make_shared<const geometry::Polygon>(container.bottom_width, container.top_width, container.height);
  }
  if (container.shape == VesselShape::polygon) {
    container.sides =
        std::make_shared<const geometry::Polygon>(corners_of(document, container.polygon, 100, "give one that is"));
  }
  if (container.sides) across[0] = container.sides->width();
  container.size = {across[0], across[1], container.height};
  container.boundary = {Boundary::wall, Boundary::wall};
  if (container.dimension == 2) {
    container.size = {across[0], container.height};
    container.boundary = {Boundary::wall};
  }
}

std::optional<Flaw> flaw_of_sides(const Container& c, double r) {
  if (!c.sides) return {};
  if (c.shape == VesselShape::polygon) {
    if (c.height > c.sides->top() * (1.0 + 1e-12)) {
      return Flaw{"container.height",
                  fmt::format("{:g} m is above the top of the polygon, {:g} m; lower it", c.height, c.sides->top())};
    }
    if (!c.sides->within(r, r, c.height - r).empty()) return {};
    return Flaw{"container.polygon", fmt::format("the largest particle, {:g} m across, fits nowhere below H_d; make it "
                                                 "smaller or the polygon larger",
                                                 2.0 * r)};
  }
  for (const bool top : {false, true}) {
    if (c.sides->width_at(top ? c.height - r : r, r) > 0.0) continue;
    return Flaw{top ? "container.top_width" : "container.bottom_width",
                fmt::format("{:g} m is too narrow for the largest particle, {:g} m across, to lie at the {}; make it "
                            "larger, or the walls steeper",
                            top ? c.top_width : c.bottom_width, 2.0 * r, top ? "top" : "floor")};
  }
  return {};
}

geometry::Container container_of(const Container& container) {
  geometry::Container box;
  box.dimension = container.dimension;
  std::ranges::copy(container.size, box.size.begin());
  for (std::size_t axis = 0; axis < container.boundary.size(); ++axis) {
    box.periodic[axis] = container.boundary[axis] == Boundary::periodic;
  }
  switch (container.shape) {
    case VesselShape::box:
      break;
    case VesselShape::cylinder:
      box.shape = geometry::Shape::cylinder;
      break;
    case VesselShape::frustum:
      box.shape = geometry::Shape::frustum;
      box.ends = {0.5 * container.bottom_diameter, 0.5 * container.top_diameter};
      break;
    case VesselShape::sphere:
    case VesselShape::circle:
      box.shape = geometry::Shape::sphere;
      break;
    case VesselShape::annulus:
      box.shape = geometry::Shape::annulus;
      box.core = 0.5 * container.inner_diameter;
      break;
    case VesselShape::trapezium:
    case VesselShape::polygon:
      box.shape = geometry::Shape::polygon;
      box.polygon = container.sides.get();
      break;
    case VesselShape::prism:  // once it has been read it is a mesh
    case VesselShape::mesh:
      box.shape = geometry::Shape::mesh;
      box.interior = container.mesh.get();
      break;
  }
  return box;
}

}  // namespace packmpi::input
