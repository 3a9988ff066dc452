// YADE: text for SpherePack.load, which carries the period, and a script with the scene's law.
#include <fmt/compile.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <vector>

#include "exporters/document.hpp"
#include "exporters/law.hpp"
#include "exporters/mixture.hpp"
#include "exporters/quote.hpp"
#include "exporters/yade_walls.hpp"

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

bool has_facets(const Specimen& s) { return s.scene.container.is_mesh() || s.scene.container.is_polygon(); }
bool has_round_walls(const Specimen& s) { return s.round() && !has_facets(s); }

bool is_round(int wall) {
  return wall >= static_cast<int>(geometry::most_planes) && wall < static_cast<int>(geometry::most_surfaces);
}

/// A plane wall, by its number in the pack.
struct Plane {
  int number;
  std::size_t axis;
  double at;
};

/// In the order in which the script has them.
std::vector<Plane> planes(const Specimen& s) {
  std::vector<Plane> all;
  if (s.has(geometry::Surface::floor)) all.push_back({0, s.vertical(), 0.0});
  for (std::size_t axis = 0; axis < s.vertical(); ++axis) {
    const int low = static_cast<int>(2 * axis + 1);
    if (s.has(static_cast<geometry::Surface>(low))) all.push_back({low, axis, 0.0});
    if (s.has(static_cast<geometry::Surface>(low + 1))) all.push_back({low + 1, axis, s.size[axis]});
  }
  if (const auto& lid = s.scene.container.lid) all.push_back({5, s.vertical(), *lid});
  return all;
}

std::string facets_words(const std::vector<mesh::Corners>& triangles) {
  std::string text = "[utils.facet(corners, material='walls') for corners in [\n";
  for (const auto& [a, b, c] : triangles) {
    text += "    (";
    for (const Vec3& x : {a, b, c}) text += fmt::format("({}, {}, {}), ", x[0], x[1], x[2]);
    text += "),\n";
  }
  return text + "]]\n";
}

std::string walls(const Specimen& s) {
  std::string text = "walls = []\n";
  for (const Plane& plane : planes(s)) {
    text += fmt::format("walls.append(utils.wall({}, axis={}, sense={}, material='walls'))\n", plane.at, plane.axis,
                        plane.at > 0.0 ? -1 : 1);
  }
  if (s.scene.container.is_polygon()) text += "walls += " + facets_words(facets(s));
  if (s.scene.container.is_mesh()) text += "walls += " + facets_words(facets(*s.scene.container.interior));
  return text;
}

/// How many faces of a polygon or mesh are walls, each with a body of its own; 0 where several facets are one wall.
std::size_t faces(const geometry::Container& vessel) {
  if (vessel.is_polygon()) return vessel.polygon->sloping().size();
  if (!vessel.is_mesh()) return 0;
  const auto all = static_cast<std::size_t>(vessel.interior->features().edge_begin());
  return facets(*vessel.interior).size() == all ? all : 0;
}

/// Walls of the pack among the bodies of the script.
class WallBodies {
 public:
  explicit WallBodies(const Specimen& s) : first_(s.count) {
    std::ranges::transform(planes(s), std::back_inserter(numbers_), &Plane::number);
    for (std::size_t k = 0; k < faces(s.scene.container); ++k) {
      numbers_.push_back(static_cast<int>(geometry::most_surfaces + k));
    }
  }
  /// Its body, or the negative number of a round wall; none if no body is just this wall.
  [[nodiscard]] std::optional<std::int64_t> of(int wall) const {
    if (is_round(wall)) return -wall;
    const auto found = std::ranges::find(numbers_, wall);
    if (found == numbers_.end()) return std::nullopt;
    return first_ + (found - numbers_.begin());
  }

 private:
  std::int64_t first_;
  std::vector<int> numbers_;
};

/// A line for each contact: two bodies of the script, or one and the negative number of a round wall, and the force of
/// friction on the first [N].
std::string springs(const Specimen& s) {
  std::string text;
  const WallBodies walls(s);
  for (const pack::TouchingRow& row : s.touching) {
    const std::optional<std::int64_t> other = row.wall >= 0 ? walls.of(row.wall) : row.second;
    if (!other) continue;
    const double along = dot(row.force, row.normal);
    text += fmt::format("{} {} {} {} {}\n", row.first, *other, row.force[0] - along * row.normal[0],
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
      "{}"
      "    if not O.interactions.has(first, second) or not O.interactions[first, second].isReal:\n"
      "        continue\n"
      "    i = O.interactions[first, second]\n"
      "    i.phys.shearElastic = Vector3(*map(float, force)) * (-1 if i.id1 == first else 1)\n"
      "for i in ids:\n    O.bodies[i].state.vel = O.bodies[i].state.angVel = Vector3.Zero\n",
      python_string(s.beside(".springs")),
      has_round_walls(s) ? "    if second < 0:\n        round_springs[first, -second] = Vector3(*map(float, force))\n"
                           "        continue\n"
                         : "");
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

/// How far particles have moved since the pack; YADE's positions are not wrapped.
std::string drift(const Specimen& s) {
  return fmt::format(
      "moved = [b.state.displ().norm() / {} for b in (O.bodies[i] for i in ids)]\n"
      "print('DRIFT the farthest particle has moved by %g mean diameters, all by %g on average'\n"
      "      % (max(moved), sum(moved) / len(moved)), flush=True)\n",
      2.0 * s.scene.sizes.mean());
}

std::string engines(const Specimen& s) {
  const bool faceted = has_facets(s);
  const double g = s.scene.in.jamming.gravity;
  const double xi = s.scene.in.contact.damping_ratio;
  return fmt::format(
      "newton = NewtonIntegrator(gravity=({1}), damping=0)\n"
      "O.engines = [\n    ForceResetter(),\n"
      "    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb(){3}], allowBiggerThanPeriod=True),\n"
      "    InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom(hertzian=True){4}],\n"
      "                    [Ip2_FrictMat_FrictMat_MindlinPhys({0})],\n"
      "                    [Law2_ScGeom_MindlinPhys_Mindlin()]),\n"
      "{5}    newton,\n]\nO.dt = {2}\n\n\n",
      s.scene.features.mixture ? yade_physics(s) : fmt::format("betan={0}, betas={0}", xi),
      s.flat() ? fmt::format("0, {}, 0", -g) : fmt::format("0, 0, {}", -g), step_of_stronger_dashpot(s),
      faceted ? ", Bo1_Facet_Aabb()" : "", faceted ? ", Ig2_Facet_Sphere_ScGeom(hertzian=True)" : "",
      has_round_walls(s) ? "    PyRunner(command='push_off_round_walls()', iterPeriod=1, initRun=True),\n" : "");
}

std::string script(const Specimen& s) {
  std::string text = notes(s, Fluid::not_carried, "# ");
  text += fmt::format(
      "# not carried over: velocities and spins{0}{2}\n"
      "# yade -n -x THIS: reads the pack, tells what is in it, and lets it settle for some steps.\n"
      "import math\nimport os\nfrom yade import pack, utils\n\n"
      "data = os.environ.get('PACK_DATA', {1})\nsteps = int(os.environ.get('PACK_STEPS', '200'))\n\n",
      remembers(s) ? "" : "; the friction here has a history (Mindlin)", python_string(s.file),
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
  if (has_round_walls(s)) text += round_walls(s);
  text += engines(s);
  return text + report + first_step(s) + "report()\n" + stretch(s) + "O.run(steps, True)\nreport()\n" + drift(s);
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
