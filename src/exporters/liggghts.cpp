// LIGGGHTS: read_data for atom_style granular, and an in-file with the scene's law.
#include <algorithm>

#include "exporters/lammps_family.hpp"
#include "exporters/law.hpp"
#include "exporters/mixture.hpp"
#include "exporters/quote.hpp"

namespace packmpi::exporters::liggghts {
namespace {

constexpr double rigid_factor = 1e5;        // a wall so much stiffer than the particles is rigid to five digits
constexpr double least_restitution = 0.05;  // that LIGGGHTS takes; the damping of a ratio of 0.63

std::string material(const Specimen& s) {
  const input::Input& in = s.scene.in;
  const double e = std::max(least_restitution, restitution(in.contact.damping_ratio));
  const double modulus = in.particles.youngs_modulus;
  const double wall = in.contact.wall == input::WallStiffness::rigid ? rigid_factor * modulus : modulus;
  const double mu = in.contact.friction;
  const double mu_wall = in.contact.wall_friction;
  return fmt::format(
      "# type 1: particles; type 2: walls\n"
      "fix             m1 all property/global youngsModulus peratomtype {0} {1}\n"
      "fix             m2 all property/global poissonsRatio peratomtype {2} {2}\n"
      "fix             m3 all property/global coefficientRestitution peratomtypepair 2 {3} {3} {3} "
      "{3}\n"
      "fix             m4 all property/global coefficientFriction peratomtypepair 2 {4} {5} {5} "
      "{5}\n{6}",
      modulus, wall, in.particles.poisson_ratio, e, mu, mu_wall,
      in.contact.rolling_friction > 0.0
          ? fmt::format("fix             m5 all property/global coefficientRollingFriction peratomtypepair 2 {0} {0} "
                        "{0} {0}\n",
                        in.contact.rolling_friction)
          : "");
}

/// LIGGGHTS' spring of rolling is k_t r*, as the scene's.
const char* rolling(const Specimen& s) {
  const bool mixture = s.scene.features.mixture && s.scene.features.rolling;
  return mixture || s.scene.in.contact.rolling_friction > 0.0 ? " rolling_friction epsd2" : "";
}

/// Settings of the model: twisting shares the limit of rolling; no attraction while particles part, if the scene has
/// none.
std::string limit(const Specimen& s) {
  const input::Contact& c = s.scene.in.contact;
  const bool twists = c.rolling_friction > 0.0 && c.twisting_friction > 0.0;
  return fmt::format("{}{}", twists ? " torsionTorque on" : "", c.tension_cutoff ? " limitForce on" : "");
}

std::string walls(const Specimen& s) {
  constexpr const char* line =
      "fix             wall_{0}{1} all wall/gran model hertz tangential ${{tangential}}{4} primitive type {5} {0}plane "
      "{2}{3}\n";
  const int type = kinds(s) + 1;
  std::string text;
  const char up = "xyz"[s.vertical()];
  if (s.scene.container.lid) {
    text = fmt::format(fmt::runtime(line), up, "lid", *s.scene.container.lid, limit(s), rolling(s), type);
  }
  if (s.scene.container.is_mesh()) {
    return text + fmt::format(
                      "variable        surface index {0}\n"
                      "fix             surface all mesh/surface file ${{surface}} type {1}\n"
                      "fix             wall_mesh all wall/gran model hertz tangential ${{tangential}}{2} mesh n_meshes "
                      "1 meshes "
                      "surface{3}\n",
                      liggghts_word(s.beside(".stl")), type, rolling(s), limit(s));
  }
  const auto cylinder = [&](const char* name, double radius) {
    text += fmt::format(
        "fix             wall_{4} all wall/gran model hertz tangential ${{tangential}}{1} primitive type {2} "
        "zcylinder {5} {0} {0}{3}\n",
        s.radius(), rolling(s), type, limit(s), name, radius);
  };
  if (s.round()) cylinder("mantle", s.radius());
  if (s.has(geometry::Surface::inner)) cylinder("inner", s.scene.container.core);
  for (std::size_t axis = 0; axis < s.vertical() && !s.round(); ++axis) {
    if (s.periodic(axis)) continue;
    text += fmt::format(fmt::runtime(line), "xyz"[axis], "lo", 0.0, limit(s), rolling(s), type);
    text += fmt::format(fmt::runtime(line), "xyz"[axis], "hi", s.size[axis], limit(s), rolling(s), type);
  }
  if (!s.has(geometry::Surface::floor)) return text;
  return text + fmt::format(fmt::runtime(line), up, "floor", 0.0, limit(s), rolling(s), type);
}

std::string in_file(const Specimen& s) {
  const input::Input& in = s.scene.in;
  std::string text = notes(s, Fluid::at_rest, "# ", Rolling::carried);
  text += fmt::format(
      "# liggghts -in THIS [-var steps N]: reads the pack, tells what is in it, and lets it settle for some steps.\n"
      "variable        data index {}\nvariable        steps index 200\n"
      "# history: friction with memory; no_history: sliding, whose slip is damped by the restitution, so none without\n"
      "variable        tangential index {}\n\n"
      "units           si\ndimension       {}\natom_style      granular\natom_modify     map array\nhard_particles  "
      "yes\nboundary       "
      "{}\nnewton          off\ncommunicate     single vel yes\nread_data       ${{data}}\n\n"
      "neighbor        {} bin\nneigh_modify    delay 0 every 1 check yes\n",
      liggghts_word(s.file), in.contact.damping_ratio > 0.0 && !remembers(s) ? "no_history" : "history",
      s.flat() ? 2 : 3, boundary_words(s), s.scene.skin);
  text += s.scene.features.mixture ? liggghts_material(s) : material(s);
  text += fmt::format("pair_style      gran model hertz tangential ${{tangential}}{}{}\npair_coeff      * *\n",
                      rolling(s), limit(s));
  text += fmt::format("fix             gravity all gravity {} vector {}\n", in.jamming.gravity,
                      s.flat() ? "0 -1 0" : "0 0 -1");
  if (in.drag.coefficient > 0.0) text += fmt::format("fix             drag all viscous {}\n", in.drag.coefficient);
  text += walls(s);
  if (s.flat()) text += "fix             plane all enforce2d\n";
  constexpr const char* report =
      "print           \"PACK after ${now} steps: ${count} particles, volume ${volume_now} m3, mass ${mass_now} kg, "
      "largest force on a particle ${force_now} N\"\n";
  text += fmt::format(
      "\ncompute         diameter all property/atom diameter\n"
      "variable        volume atom PI/6*c_diameter*c_diameter*c_diameter\n"
      "compute         volume all reduce sum v_volume\n"
      "variable        force atom sqrt(fx*fx+fy*fy+fz*fz)\n"
      "compute         strongest all reduce max v_force\n"
      "variable        now equal step\nvariable        count equal atoms\nvariable        volume_now equal c_volume\n"
      "variable        mass_now equal mass(all)\nvariable        force_now equal c_strongest\n"
      "{2}thermo_style    custom step atoms ke c_volume c_strongest{3}\n"
      "thermo_modify   lost error norm no\nthermo          100\n\n"
      "run             0\n{0}{1}run             ${{steps}}\n{0}{4}",
      report, begin_to_move(s, step_of_stronger_dashpot(s), "set             group all omegax 0 omegay 0 omegaz 0\n"),
      watch_displacement(), displacement_columns, drift_line(s));
  return text;
}

}  // namespace

Document make(const Specimen& s) {
  const bool flat = s.flat();  // its particles are then discs of unit thickness; ours are spheres in a plane
  Document document;
  document.sections.push_back(
      {data_head(s, "LIGGGHTS", kinds(s) + 1, "Atoms"), [&s, flat](Text& out, const Outgoing& p) {
         const double density = density_of(s, p);
         atom_row(out, p, flat ? 4.0 / 3.0 * p.row.radius * density : density);
       }});
  document.sections.push_back(velocities(s));
  document.companion = in_file(s);
  if (s.scene.container.is_mesh()) document.third = mesh::text_stl(s.scene.container.interior->shell());
  return document;
}

}  // namespace packmpi::exporters::liggghts
