#include "config/vessel.hpp"

#include <algorithm>
#include <array>

namespace packmpi::input {

void take_vessel(Container& container) {
  if (container.shape == VesselShape::box) return;
  std::array<double, 2> across{container.diameter, container.diameter};
  if (container.shape == VesselShape::frustum) across.fill(std::max(container.bottom_diameter, container.top_diameter));
  if (container.shape == VesselShape::mesh) across = {container.mesh->high()[0], container.mesh->high()[1]};
  container.size = {across[0], across[1], container.height};
  container.boundary = {Boundary::wall, Boundary::wall};
  if (container.dimension == 2) {
    container.size = {across[0], container.height};
    container.boundary = {Boundary::wall};
  }
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
    case VesselShape::prism:  // once it has been read it is a mesh
    case VesselShape::mesh:
      box.shape = geometry::Shape::mesh;
      box.room = container.mesh.get();
      break;
  }
  return box;
}

}  // namespace packmpi::input
