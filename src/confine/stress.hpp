/// The stress of a specimen under a lid: on its boundary, and of its contacts. Compression is positive.
#pragma once
#include "comm/comm.hpp"
#include "dynamics/law.hpp"
#include "neighbor/neighborhood.hpp"
#include "particles/store.hpp"
#include "scene/scene.hpp"

namespace packmpi::confine {

/// A plane scene is a sheet as thick as a mean particle: its forces over lengths are stresses over that [m]; 1 in
/// space.
[[nodiscard]] double thickness(const scene::Scene& scene);
/// Area [m2] of the specimen's section across an axis, of the vertical one at the lid; and its volume [m3], between
/// floor and lid. Lateral axes: of a box.
[[nodiscard]] double area_across(const scene::Scene& scene, std::size_t axis);
[[nodiscard]] double volume(const scene::Scene& scene);

/// What the parts of the boundary bear [Pa], axis by axis: normal force over area. Periodic axes, and the sides of
/// meshes and polygons: 0; round sides: the mean over the mantle up to the lid, for each lateral axis.
struct Boundary {
  Vec3 low{}, high{};  ///< vertical: floor, if it is a plane of its own, and lid
};
/// Collective, exact. The moving state's: damping is in it.
[[nodiscard]] Boundary on_boundary(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                                   const dynamics::Law& law, const neighbor::Neighborhood& neighborhood);
/// Of Boundary::high what servos move [Pa], for each of their ticks. Cost: a pass over the wall list.
[[nodiscard]] Vec3 on_high_walls(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                                 const dynamics::Law& law, const neighbor::Neighborhood& neighborhood);

/// Stress of the contacts of the whole specimen (Love 1927, Weber 1966): over its volume, the sum of l_a f_a, l from
/// the centre of one particle to that of the other, or to where it touches a wall, f what it presses the other with.
struct Stress {
  Vec3 contacts{};  ///< [Pa] diagonal, axis by axis
  /// [Pa] vertical, that a specimen at rest must have: what the lid presses with, and the mean over the height of the
  /// weight above, less what side walls bear by friction. Equal to contacts of the vertical axis at rest.
  double vertical_at_rest = 0.0;
};
/// Collective, exact. Cost: about two steps.
[[nodiscard]] Stress of_contacts(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                                 const dynamics::Law& law, const neighbor::Neighborhood& neighborhood);

}  // namespace packmpi::confine
