// What is asked of vessels.
#include <algorithm>
#include <array>

#include "checks/checks.hpp"
#include "checks/scene_case.hpp"
#include "config/words.hpp"

namespace packmpi::input {
namespace {

void check_fit(const Case& scene) {
  const double diameter = 2.0 * scene.largest();
  const auto& size = scene.in.container.size;
  for (std::size_t axis = 0; axis < size.size(); ++axis) {
    if (diameter <= size[axis]) continue;
    scene.refuse(scene.largest_key(), fmt::format("the largest particle is {:g} m across, more than {} = {:g} m; "
                                                  "make it smaller or the container larger",
                                                  diameter, scene.extent_key(axis), size[axis]));
  }
  if (diameter > scene.in.layers.thickness) {
    scene.refuse("layers.thickness",
                 fmt::format("{:g} m is less than the largest particle, {:g} m across; make layers thicker",
                             scene.in.layers.thickness, diameter));
  }
}

/// H_d is inside, and there is room at all.
void check_mesh(const Case& scene) {
  const Container& c = scene.in.container;
  const double top = c.mesh->high()[2], r = scene.largest();
  if (c.height > top * (1.0 + 1e-12)) {
    scene.refuse("container.height",
                 fmt::format("{:g} m is above the top of the mesh, {:g} m; lower it", c.height, top));
  }
  if (c.mesh->volume() < 4.0 / 3.0 * std::numbers::pi * r * r * r) {
    scene.refuse(scene.extent_key(),
                 fmt::format("the mesh has a volume of {:.3g} m3, less than the largest particle, {:g} m "
                             "across; is its unit right?",
                             c.mesh->volume(), 2.0 * r));
  }
}

/// The largest particle lies at both ends.
void check_frustum(const Case& scene) {
  const Container& c = scene.in.container;
  const double diameter = 2.0 * scene.largest();
  const geometry::Container frustum = container_of(c);
  for (const bool top : {false, true}) {
    const double height = top ? c.height - scene.largest() : scene.largest();
    if (frustum.ring(height, scene.largest()).outer > 0.0) continue;
    scene.refuse(top ? "container.top_diameter" : "container.bottom_diameter",
                 fmt::format("{:g} m is too narrow for the largest particle, {:g} m across, to lie at the {}; make it "
                             "larger, or the walls steeper",
                             top ? c.top_diameter : c.bottom_diameter, diameter, top ? "top" : "floor"));
  }
}

}  // namespace

void check_vessel(const Case& scene) {
  check_fit(scene);
  const Container& c = scene.in.container;
  const double diameter = 2.0 * scene.largest();
  if ((scene.is(VesselShape::sphere) || scene.is(VesselShape::circle)) && c.height > c.diameter) {
    scene.refuse("container.height", fmt::format("{:g} m is above container.diameter = {:g} m, the top of the {}; "
                                                 "lower it",
                                                 c.height, c.diameter, word(c.shape)));
  }
  if (scene.is(VesselShape::annulus)) {
    const double gap = 0.5 * (c.diameter - c.inner_diameter);
    if (!(gap >= diameter)) {
      scene.refuse("container.inner_diameter",
                   fmt::format("{:g} m leaves {:g} m between the walls, less than the largest particle, {:g} m across; "
                               "make it smaller",
                               c.inner_diameter, gap, diameter));
    }
  }
  if (scene.is(VesselShape::mesh)) return check_mesh(scene);
  if (scene.is(VesselShape::frustum)) check_frustum(scene);
  if (const auto flaw = flaw_of_sides(c, scene.largest())) scene.refuse(flaw->key, flaw->words);
}

void check_shape(const Input& in, const Document& document) {
  const Case scene{in, document};
  using enum VesselShape;
  constexpr std::array<std::array<VesselShape, 2>, 5> likes{
      {{circle, sphere}, {trapezium, frustum}, {polygon, prism}, {polygon, mesh}, {box, box}}};  // in 2D and in 3D
  const VesselShape shape = in.container.shape;
  const bool flat = scene.is(circle) || scene.is(trapezium) || scene.is(polygon);
  if (scene.boxed() || flat == scene.plane()) return;
  const auto like = std::ranges::find_if(likes, [&](const auto& one) { return one[flat ? 0 : 1] == shape; });
  scene.refuse("container.shape",
               fmt::format("\"{}\" is a vessel in {}D; give dimension = {}, or shape = \"{}\"", word(shape),
                           flat ? 2 : 3, flat ? 2 : 3, word(like == likes.end() ? box : (*like)[flat ? 1 : 0])));
}

}  // namespace packmpi::input
