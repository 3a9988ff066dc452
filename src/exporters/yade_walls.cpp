// YADE has flat walls and facets. Over a seam of two facets a sphere is touched twice, so that a pack that was at rest
// is not. So round walls are a formula in the script (geometry::RoundWall) with the scene's law (doc/theory.md), and
// the faces of a convex interior are a facet each.
#include "exporters/yade_walls.hpp"

#include <fmt/core.h>

#include <vector>

#include "exporters/law.hpp"
#include "exporters/mixture.hpp"
#include "geometry/container.hpp"
#include "mesh/convex.hpp"
#include "mesh/vectors.hpp"
#include "scene/mixture.hpp"

namespace packmpi::exporters::yade {
namespace {

std::string vector_words(const Vec3& v) { return fmt::format("Vector3({}, {}, {})", v[0], v[1], v[2]); }

std::string walls_words(const Specimen& s) {
  std::string text =
      "# Round walls by their numbers in the pack: centre, offset, radial, weight, lean. With d = weight * (x - "
      "centre),\n"
      "# a wall is offset - radial * |d| - lean * x away from x.\nround_walls = {\n";
  for (std::size_t k = 0; k < geometry::most_round; ++k) {
    const std::size_t number = geometry::most_planes + k;
    if (!s.has(static_cast<geometry::Surface>(number))) continue;
    const geometry::RoundWall wall = s.scene.container.round(k);
    text += fmt::format("    {}: ({}, {}, {}, {}, {}),\n", number, vector_words(wall.centre), wall.offset, wall.radial,
                        vector_words(wall.weight), vector_words(wall.lean));
  }
  return text + "}\n";
}

/// The scene as one of components: its particles are the only one.
input::Input with_components(input::Input in) {
  if (!in.components.empty()) return in;
  input::Component only;
  only.particles = in.particles;
  only.wall_friction = in.contact.wall_friction;
  only.damping_ratio = in.contact.damping_ratio;
  in.components.push_back(only);
  return in;
}

std::string laws_words(const Specimen& s) {
  std::string text =
      "# E* and G* at them [Pa], friction and damping ratio, of each material of spheres\nround_laws = [\n";
  const input::Input in = with_components(s.scene.in);
  for (int k = 0; k < kinds(s); ++k) {
    const scene::PairMaterial of = scene::wall_material(in, k);
    text += fmt::format("    ({}, {}, {}, {}),\n", of.normal_modulus, of.shear_modulus, of.friction.particles,
                        of.damping_ratio);
  }
  return text + fmt::format("]\nslipping = {}   # of a sphere's mass\n", s.rotation ? "2 / 7" : "1");
}

constexpr const char* push = R"(round_springs = {}   # forces of friction on spheres [N], by sphere and wall
near_round, round_margin = [], 0.0


def off_round_wall(x, wall):
    """Distance and the direction towards it."""
    centre, offset, radial, weight, lean = round_walls[wall]
    d = Vector3(*(w * (a - c) for w, a, c in zip(weight, x, centre)))
    rho = d.norm()
    return offset - radial * rho - lean.dot(x), (d * (radial / rho) if rho > 0 else Vector3.Zero) + lean


def find_near_round_walls():
    global near_round, round_margin
    round_margin = 0.2 * min(O.bodies[i].shape.radius for i in ids)
    bodies = [O.bodies[i] for i in ids]
    near_round = [(b.id, wall, b.state, b.shape.radius, *round_laws[b.mat.id]) for b in bodies for wall in round_walls
                  if off_round_wall(b.state.pos, wall)[0] < b.shape.radius + round_margin]


def push_off_round_walls():
    """Hertz, Mindlin's spring of friction, Coulomb's limit; as between the spheres."""
    global round_margin
    round_margin -= math.sqrt(newton.maxVelocitySq) * O.dt
    if round_margin <= 0:
        find_near_round_walls()
    for i, wall, state, radius, modulus, shear_modulus, friction, damping in near_round:
        distance, normal = off_round_wall(state.pos, wall)
        overlap = radius - distance
        if overlap <= 0:
            round_springs.pop((i, wall), None)
            continue
        velocity = state.vel + state.angVel.cross(radius * normal)
        slip = velocity - velocity.dot(normal) * normal
        stiffness, shear = (f * math.sqrt(radius * overlap) for f in (2 * modulus, 8 * shear_modulus))
        dashpot = 2 * damping * math.sqrt(stiffness * state.mass)
        pushed = max(0.0, 2 / 3 * stiffness * overlap + dashpot * velocity.dot(normal))
        before = round_springs.get((i, wall), Vector3.Zero)
        turned = before - before.dot(normal) * normal
        if turned.norm() > 0:
            turned *= before.norm() / turned.norm()
        spring = turned - shear * O.dt * slip
        force = spring - 2 * damping * math.sqrt(shear * slipping * state.mass) * slip
        if force.norm() > friction * pushed:
            spring = force = force * (friction * pushed / force.norm())
        round_springs[i, wall] = spring
        O.forces.addF(i, force - pushed * normal)
        O.forces.addT(i, (radius * normal).cross(force))


)";

}  // namespace

std::vector<mesh::Corners> facets(const mesh::Surface& surface) {
  std::vector<mesh::Corners> triangles = mesh::triangles_over_faces(surface);
  if (!triangles.empty()) return triangles;
  for (std::size_t t = 0; t < surface.shell().triangles.size(); ++t) triangles.push_back(surface.shell().corners(t));
  return triangles;
}

std::vector<mesh::Corners> facets(const Specimen& s) {
  const double length = 2.0 * (s.size[0] + inner_box(s)[1].high), depth = 4.0 * s.widest;
  std::vector<mesh::Corners> triangles;
  for (const auto& [n, offset] : s.scene.container.polygon->sloping()) {
    const Vec3 foot{offset * n[0], offset * n[1], 0.0}, along{-n[1], n[0], 0.0};  // foot: of the origin
    const auto place = [&](double a, double z) { return mesh::plus(foot, {a * along[0], a * along[1], z}); };
    triangles.push_back({place(-length, -depth), place(3.0 * length, -depth), place(-length, 3.0 * depth)});
  }
  return triangles;
}

std::string round_walls(const Specimen& s) { return walls_words(s) + laws_words(s) + push; }

}  // namespace packmpi::exporters::yade
