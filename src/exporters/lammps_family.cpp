#include "exporters/lammps_family.hpp"

#include <fmt/compile.h>

#include "exporters/law.hpp"

namespace packmpi::exporters {
namespace {

constexpr std::size_t longest_line = 250;   // 254 characters are read
constexpr double step_of_springs = 1000.0;  // [s]

void velocity_row(Text& out, const Outgoing& p) {
  const Vec3& v = p.row.velocity;
  const Vec3& w = p.row.spin;
  fmt::format_to(fmt::appender(out), FMT_COMPILE("{} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n"), p.row.id,
                 v[0], v[1], v[2], w[0], w[1], w[2]);
}

}  // namespace

std::string data_head(const Specimen& s, const char* code, int kinds, const char* section) {
  std::string first = fmt::format("{} data file by ", code);
  for (const std::string& line : header_lines(s)) first += line + "; ";
  const auto box = padded_box(s);
  return fmt::format(
      "{}\n\n{} atoms\n{} atom types\n\n{:.17g} {:.17g} xlo xhi\n{:.17g} {:.17g} ylo yhi\n{:.17g} {:.17g} zlo "
      "zhi\n\n{}\n\n",
      first.substr(0, longest_line), s.count, kinds, box[0].low, box[0].high, box[1].low, box[1].high, box[2].low,
      box[2].high, section);
}

void atom_row(Text& out, const Outgoing& p, double density) {
  fmt::format_to(fmt::appender(out), FMT_COMPILE("{} {} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n"), p.row.id,
                 p.row.component + 1, 2.0 * p.row.radius, density, p.row.position[0], p.row.position[1],
                 p.row.position[2]);
}

Section velocities(const Specimen& s) {
  const char* head = "\nVelocities\n\n";
  if (s.springs.of.empty()) return {head, velocity_row};
  const auto particles = static_cast<GlobalId>(s.springs.of.size());
  return {head, [&s, particles](Text& out, const Outgoing& p) {
            const handover::Motion& motion = s.springs.of[static_cast<std::size_t>((p.row.id - 1) % particles)];
            Outgoing moved = p;
            for (std::size_t c = 0; c < 3; ++c) {
              moved.row.velocity[c] = motion.displacement[c] / step_of_springs;
              moved.row.spin[c] = motion.turn[c] / step_of_springs;
            }
            velocity_row(out, moved);
          }};
}

std::string begin_to_move(const Specimen& s, double step, const char* stand) {
  const std::string move =
      fmt::format("fix             move all {}\ntimestep        {}\n", s.rotation ? "nve/sphere" : "nve", step);
  if (s.springs.of.empty()) {
    return (remembers(s) ? "# not carried over: springs of friction; they come back while the pack settles\n" : "") +
           move;
  }
  return fmt::format(
      "# springs of friction: velocities in the data file are no motion of the pack, but make each spring as long as "
      "it "
      "is\n"
      "# in one step so long that no dashpot counts, in which nothing moves; then all stands still\n"
      "timestep        {}\nrun             1\nvelocity        all set 0 0 0\n{}reset_timestep  0\n{}",
      step_of_springs, stand, move);
}

std::string watch_displacement() {
  return "compute         moved all displace/atom\n"
         "compute         farthest all reduce max c_moved[4]\n"
         "compute         apart all reduce ave c_moved[4]\n";
}

std::string drift_line(const Specimen& s) {
  const double diameter = 2.0 * s.scene.sizes.mean();
  return fmt::format(
      "variable        farthest_now equal c_farthest/{0}\nvariable        apart_now equal c_apart/{0}\n"
      "print           \"DRIFT the farthest particle has moved by ${{farthest_now}} mean diameters, all by "
      "${{apart_now}} on average\"\n",
      diameter);
}

std::string boundary_words(const Specimen& s) {
  std::string words;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    words += s.periodic(axis) || (axis == 2 && s.flat()) ? " p" : " f";
  }
  return words;
}

namespace {

/// The sides of a polygon but floor and lid; a plane's normal looks into the interior.
std::vector<Region> side_regions(const geometry::Container& vessel) {
  std::vector<Region> regions;
  vessel.near_walls({}, HUGE_VAL, [&](geometry::Surface wall, double) {
    if (wall == geometry::Surface::floor || wall == geometry::Surface::lid) return;
    const auto [distance, normal, velocity] = vessel.facing(wall, {});
    const std::string name = fmt::format("side{}", regions.size() + 1);
    regions.push_back(
        {name, fmt::format("region          {} plane {} {} 0 {} {} 0 side in units box\n", name,
                           distance * normal[0] + 0.0, distance * normal[1] + 0.0, 0.0 - normal[0], 0.0 - normal[1])});
  });
  return regions;
}

}  // namespace

std::vector<Region> round_regions(const Specimen& s) {
  using geometry::Surface;
  std::vector<Region> regions;
  if (!s.round()) return regions;
  if (s.scene.container.is_polygon()) return side_regions(s.scene.container);
  const double c = s.radius();
  const auto cylinder = [&](const char* name, double radius, const char* side) {
    regions.push_back({name, fmt::format("region          {} cylinder z {} {} {} INF INF side {} units box\n", name, c,
                                         c, radius, side)});
  };
  switch (s.scene.container.shape) {
    case geometry::Shape::frustum: {
      const auto [height, radius] = cone_ends(s);
      regions.push_back(
          {"mantle",
           fmt::format("region          mantle cone z {0} {0} {1} {2} {3} {4} side in units box open 1 open 2\n", c,
                       radius.low, radius.high, height.low, height.high)});
      break;
    }
    case geometry::Shape::sphere:
      if (s.flat()) {
        cylinder("mantle", c, "in");
        break;
      }
      regions.push_back(
          {"mantle", fmt::format("region          mantle sphere {0} {0} {0} {0} side in units box\n", c)});
      break;
    default:
      cylinder("mantle", c, "in");
  }
  if (s.has(Surface::inner)) cylinder("inner", s.scene.container.core, "out");
  if (s.has(Surface::collar)) cylinder("collar", s.scene.container.ends[1], "in");
  return regions;
}

}  // namespace packmpi::exporters
