// YADE: text for SpherePack.load, which carries the period, and a script with the scene's law.
#include <fmt/compile.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "exporters/document.hpp"
#include "exporters/law.hpp"
#include "exporters/mixture.hpp"
#include "exporters/quote.hpp"

namespace packmpi::exporters::yade {
namespace {

/// YADE knows cells that are periodic along all axes: where the pack is not, the cell is so large that images are
/// apart.
std::string cell(const Specimen& s) {
  if (!s.scene.features.periodic) return "";
  constexpr double apart = 8.0;  // largest radii
  Vec3 size{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    size[axis] = axis == s.vertical() ? 2.0 * inner_box(s)[axis].high + apart * s.widest
                 : s.periodic(axis)   ? s.size[axis]
                                      : s.size[axis] + apart * s.widest;
  }
  return fmt::format("##PERIODIC:: {:.17g} {:.17g} {:.17g}\n", size[0], size[1], size[2]);
}

/// Facets that touch the wall from where no particle is, so many that their edges are half a thousandth of a radius
/// beyond it; they begin below the floor, so that no particle meets their ends.
std::string mantle(const Specimen& s) {
  constexpr double gap = 5e-4;
  const double facets = std::max(48.0, std::ceil(std::numbers::pi * std::sqrt(s.radius() / (2.0 * gap * s.widest))));
  const double high = inner_box(s)[2].high + 4.0 * s.widest;
  const auto cylinder = [&](double radius, const char* edges) {
    return fmt::format(
        "walls += geom.facetCylinder(({0}, {0}, {1}), {4}{5}, {3}, segmentsNumber={2:.0f}, "
        "wallMask=4, material='walls')\n",
        s.radius(), 0.5 * (high - s.widest), facets, high + s.widest, radius, edges);
  };
  const std::string outside = fmt::format(" / math.cos(math.pi / {:.0f})", facets);
  std::string text;
  if (s.scene.container.shape == geometry::Shape::frustum) {
    const auto [height, radius] = cone_ends(s);
    text = fmt::format(
        "walls += geom.facetCone(({0}, {0}, {1}), {2}{5}, {3}{5}, {4}, segmentsNumber={6:.0f}, wallMask=4, "
        "material='walls')\n",
        s.radius(), 0.5 * (height.low + height.high), radius.high, radius.low, height.high - height.low, outside,
        facets);
  } else {
    text = cylinder(s.radius(), outside.c_str());
  }
  if (s.has(geometry::Surface::inner)) text += cylinder(s.scene.container.core, "");
  if (s.has(geometry::Surface::collar)) text += cylinder(s.scene.container.ends[1], outside.c_str());
  return text;
}

/// The triangles of a mesh.
std::string facets(const Specimen& s) {
  const mesh::Shell& shell = s.scene.container.room->shell();
  std::string text = "points = [\n";
  for (const Vec3& x : shell.points) text += fmt::format("    ({}, {}, {}),\n", x[0], x[1], x[2]);
  text += "]\ntriangles = [\n";
  for (const auto& t : shell.triangles) text += fmt::format("    ({}, {}, {}),\n", t[0], t[1], t[2]);
  return text + "]\nwalls = [utils.facet([points[k] for k in t], material='walls') for t in triangles]\n";
}

/// A plane wall, by its number in the pack.
struct Plane {
  int number;
  std::size_t axis;
  double at;
};

/// In the order in which the script has them; what is not plane comes after them.
std::vector<Plane> planes(const Specimen& s) {
  std::vector<Plane> all;
  if (s.has(geometry::Surface::floor)) all.push_back({0, s.vertical(), 0.0});
  for (std::size_t axis = 0; axis < s.vertical() && !s.round(); ++axis) {
    if (s.periodic(axis)) continue;
    all.push_back({static_cast<int>(2 * axis + 1), axis, 0.0});
    all.push_back({static_cast<int>(2 * axis + 2), axis, s.size[axis]});
  }
  if (const auto& lid = s.scene.container.lid) all.push_back({5, s.vertical(), *lid});
  return all;
}

std::string walls(const Specimen& s) {
  if (s.scene.container.is_mesh()) return facets(s);
  std::string text = "walls = []\n";
  for (const Plane& plane : planes(s)) {
    text += fmt::format("walls.append(utils.wall({}, axis={}, sense={}, material='walls'))\n", plane.at, plane.axis,
                        plane.at > 0.0 ? -1 : 1);
  }
  return s.round() ? text + mantle(s) : text;
}

/// A line for each contact: two bodies of the script, and the force of friction on the first [N].
std::string springs(const Specimen& s) {
  std::string text;
  const std::vector<Plane> walls = planes(s);
  for (const pack::TouchingRow& row : s.touching) {
    std::int64_t other = row.second;
    if (row.wall >= 0) {
      const auto plane = std::ranges::find(walls, row.wall, &Plane::number);
      if (plane == walls.end()) continue;
      other = s.count + (plane - walls.begin());
    }
    const double along = dot(row.force, row.normal);
    text += fmt::format("{} {} {} {} {}\n", row.first, other, row.force[0] - along * row.normal[0],
                        row.force[1] - along * row.normal[1], row.force[2] - along * row.normal[2]);
  }
  return text;
}

/// In which contacts are found; with springs so short that nothing moves without them.
std::string first_step(const Specimen& s) {
  return s.touching.empty() ? "O.run(1, True)\n"
                            : fmt::format("O.dt = {:g}\nO.run(1, True)\nO.dt = {}\n",
                                          1e-6 * step_of_stronger_dashpot(s), step_of_stronger_dashpot(s));
}

/// After it.
std::string stretch(const Specimen& s) {
  if (s.touching.empty()) return "";
  return fmt::format(
      "# springs of friction: each is given the force it has in the pack, and all stands still again\n"
      "for line in open(os.environ.get('PACK_SPRINGS', {})):\n"
      "    first, second, *force = line.split()\n"
      "    first, second = int(first), int(second)\n"
      "    if not O.interactions.has(first, second) or not O.interactions[first, second].isReal:\n"
      "        continue\n"
      "    i = O.interactions[first, second]\n"
      "    i.phys.shearElastic = Vector3(*map(float, force)) * (-1 if i.id1 == first else 1)\n"
      "for i in ids:\n    O.bodies[i].state.vel = O.bodies[i].state.angVel = Vector3.Zero\n",
      python_string(s.beside(".springs")));
}

/// Degrees of freedom that are fixed.
std::string blocked(const Specimen& s) {
  const std::string turns = s.flat() ? "XY" : "";
  return (s.flat() ? "z" : "") + (s.rotation ? turns : "XYZ");
}

std::string materials(const Specimen& s) {
  const input::Input& in = s.scene.in;
  const double factor = in.contact.wall == input::WallStiffness::rigid ? 1e5 : 1.0;
  constexpr const char* line =
      "O.materials.append(FrictMat(young={}, poisson={}, density={}, frictionAngle=math.atan({}), "
      "label='{}'))\n";
  const input::Particles& p = in.particles;
  return fmt::format(fmt::runtime(line), p.youngs_modulus, p.poisson_ratio, p.density, in.contact.friction,
                     "particles") +
         fmt::format(fmt::runtime(line), factor * p.youngs_modulus, p.poisson_ratio, p.density,
                     in.contact.wall_friction, "walls");
}

constexpr const char* report =
    "def report():\n"
    "    volume = sum(4 / 3 * math.pi * O.bodies[i].shape.radius ** 3 for i in ids)\n"
    "    mass = sum(O.bodies[i].state.mass for i in ids)\n"
    "    force = max((i.phys.normalForce.norm() for i in O.interactions\n"
    "                 if i.isReal and i.id1 < len(ids) and i.id2 < len(ids)), default=0.0)\n"
    "    print('PACK after %d steps: %d particles, volume %.17g m3, mass %.17g kg, largest contact force %.17g N'\n"
    "          % (O.iter, len(ids), volume, mass, force), flush=True)\n\n\n";

std::string script(const Specimen& s) {
  const input::Input& in = s.scene.in;
  const double g = in.jamming.gravity;
  std::string text = notes(s, Fluid::not_carried, "# ");
  text += fmt::format(
      "# not carried over: velocities and spins{0}{3}\n"
      "# yade -n -x THIS: reads the pack, tells what is in it, and lets it settle for some steps.\n"
      "import math\nimport os\nfrom yade import {2}pack, utils\n\n"
      "data = os.environ.get('PACK_DATA', {1})\nsteps = int(os.environ.get('PACK_STEPS', '200'))\n\n",
      remembers(s) ? "" : "; the friction here has a history (Mindlin)", python_string(s.file),
      s.round() ? "geom, " : "",
      remembers(s) && s.touching.empty() ? "; springs of friction, which come back while the pack settles" : "");
  const bool mixture = s.scene.features.mixture;
  text += mixture ? yade_materials(s) : materials(s);
  text += mixture ? yade_reader(s)
                  : fmt::format(
                        "spheres = pack.SpherePack()\nspheres.load(data)\n"
                        "spheres.isPeriodic = {}\n"
                        "ids = list(spheres.toSimulation(material='particles'))\n",
                        s.scene.features.periodic ? "True" : "False");
  text += fmt::format("for i in ids:\n    O.bodies[i].state.blockedDOFs = '{}'\n", blocked(s));
  text += walls(s) + "O.bodies.append(walls)\n\n";
  text += fmt::format(
      "O.engines = [\n    ForceResetter(),\n"
      "    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb(){3}], allowBiggerThanPeriod=True),\n"
      "    InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom(hertzian=True){4}],\n"
      "                    [Ip2_FrictMat_FrictMat_MindlinPhys({0})],\n"
      "                    [Law2_ScGeom_MindlinPhys_Mindlin()]),\n"
      "    NewtonIntegrator(gravity=({1}), damping=0),\n]\nO.dt = {2}\n\n\n",
      mixture ? yade_physics(s) : fmt::format("betan={0}, betas={0}", in.contact.damping_ratio),
      s.flat() ? fmt::format("0, {}, 0", -g) : fmt::format("0, 0, {}", -g), step_of_stronger_dashpot(s),
      s.round() ? ", Bo1_Facet_Aabb()" : "", s.round() ? ", Ig2_Facet_Sphere_ScGeom(hertzian=True)" : "");
  return text + report + first_step(s) + "report()\n" + stretch(s) + "O.run(steps, True)\nreport()\n";
}

}  // namespace

Document make(const Specimen& s) {
  Document document;
  const bool mixture = s.scene.features.mixture;  // the fifth column is for clumps, or read by the script
  document.sections.push_back({cell(s), [mixture](Text& out, const Outgoing& p) {
                                 const Vec3& x = p.row.position;
                                 fmt::format_to(fmt::appender(out), FMT_COMPILE("{:.17g} {:.17g} {:.17g} {:.17g} {}\n"),
                                                x[0], x[1], x[2], p.row.radius, mixture ? p.row.component : -1);
                               }});
  document.companion = script(s);
  if (!s.touching.empty()) document.third = springs(s);
  return document;
}

}  // namespace packmpi::exporters::yade
