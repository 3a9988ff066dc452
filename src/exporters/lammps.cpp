// LAMMPS: read_data for atom_style sphere, and an in-file with the scene's law.
#include <optional>

#include "confine/servo.hpp"
#include "confine/stress.hpp"
#include "exporters/lammps_family.hpp"
#include "exporters/law.hpp"
#include "exporters/mixture.hpp"
#include "exporters/quote.hpp"

namespace packmpi::exporters::lammps {
namespace {

/// The law of pairs or walls of the one material: by its stiffness, as of a wall's modulus LAMMPS makes another E* than
/// of a pair's. `share` of a particle's own E / (1 - nu^2) is E*: 1/2 against its like, 1 against what is rigid.
std::string contact(const Specimen& s, double share, double friction, int runs = 1) {
  const input::Input& in = s.scene.in;
  const double nu = in.particles.poisson_ratio;
  return lammps_law(s,
                    {.normal_modulus = share * in.particles.youngs_modulus / (1.0 - nu * nu),
                     .shear_modulus = share * shear_modulus(s) / (2.0 - nu),
                     .damping_ratio = in.contact.damping_ratio,
                     .friction = {friction, friction, in.contact.rolling_friction, in.contact.twisting_friction}},
                    share, runs);
}

/// Under a lid, without springs: servos and a while of more friction make up for them.
bool servoed(const Specimen& s) { return s.scene.container.lid && s.springs.of.empty(); }

/// Runs for which walls, once defined, are used: see lammps_law().
int runs_with_walls(const Specimen& s) { return s.springs.of.empty() && !s.scene.container.lid ? 1 : 2; }

/// Who touches walls: all particles, or those of one component, whose group `definition` makes; `suffix` ends the names
/// of their fixes.
struct Group {
  std::string name, suffix, definition, law;
};

std::vector<Group> groups(const Specimen& s) {
  const input::Input& in = s.scene.in;
  const double share = in.contact.wall == input::WallStiffness::rigid ? 1.0 : 0.5;
  const int runs = runs_with_walls(s);
  if (!s.scene.features.mixture) return {{"all", "", "", contact(s, share, in.contact.wall_friction, runs)}};
  std::vector<Group> found;
  found.reserve(static_cast<std::size_t>(kinds(s)));
  for (int type = 1; type <= kinds(s); ++type) {
    found.push_back({fmt::format("component{}", type), fmt::format("_{}", type),
                     fmt::format("group           component{0} type {0}\n", type),
                     lammps_law(s, scene::wall_material(in, type - 1), share, runs)});
  }
  return found;
}

/// A floor; over it a lid, which is a region that moves by the variable `lid` [m] if servoed.
std::string floor_and_lid(const Specimen& s, const Group& of) {
  const char up = "xyz"[s.vertical()];
  const auto plane = [&](const char* name, const std::string& places) {
    return fmt::format("fix             {}{} {} wall/gran granular {} {}plane {}\n", name, of.suffix, of.name, of.law,
                       up, places);
  };
  std::string text = s.has(geometry::Surface::floor) ? plane("floor", "0 NULL") : "";
  if (!s.scene.container.lid) return text;
  if (!servoed(s)) return text + plane("lid", fmt::format("NULL {}", *s.scene.container.lid));
  return text +
         fmt::format("fix             lid{} {} wall/gran/region granular {} region lid\n", of.suffix, of.name, of.law);
}

std::string regions(const Specimen& s) {
  std::string text;
  if (s.round() && !s.scene.container.is_polygon()) {
    text =
        "# the law of a curved wall is there that of spheres on its curvature: overlaps differ by a share of r / R\n";
  }
  for (const Region& region : round_regions(s)) text += region.line;
  if (!servoed(s)) return text;
  const double lid = *s.scene.container.lid;
  return text + (s.flat() ? fmt::format("region          lid plane 0 {} 0 0 -1 0 move NULL v_lid NULL\n", lid)
                          : fmt::format("region          lid plane 0 0 {} 0 0 -1 move NULL NULL v_lid\n", lid));
}

std::string walls(const Specimen& s) {
  std::string text = regions(s);
  for (const Group& of : groups(s)) {
    text += of.definition;
    for (const Region& region : round_regions(s)) {
      text += fmt::format("fix             wall_{0}{1} {2} wall/gran/region granular {3} region {0}\n", region.name,
                          of.suffix, of.name, of.law);
    }
    for (std::size_t axis = 0; axis < s.vertical() && !s.round(); ++axis) {
      if (s.periodic(axis)) continue;
      text += fmt::format("fix             wall_{0}{1} {2} wall/gran granular {3} {0}plane 0 {4}\n", "xyz"[axis],
                          of.suffix, of.name, of.law, s.size[axis]);
    }
    text += floor_and_lid(s, of);
  }
  return text;
}

/// The law between particles, with their friction times `rougher`.
std::string pairs(const Specimen& s, double rougher = 1.0) {
  if (s.scene.features.mixture) return lammps_pairs(s, rougher);
  return fmt::format("pair_coeff      * * {}\n", contact(s, 0.5, rougher * s.scene.in.contact.friction));
}

/// Under a lid: the stress of the contacts between particles, axis by axis; LAMMPS' box is higher than the lid, and
/// wider than a vessel of another shape.
std::string stress_measures(const Specimen& s) {
  const geometry::Container& vessel = s.scene.container;
  if (!vessel.lid) return "";
  const std::string larger = vessel.is_box() ? fmt::format("({0}hi-{0}lo)/{1}", "xyz"[s.vertical()], *vessel.lid)
                                             : fmt::format("vol/{}", vessel.volume_between(0.0, *vessel.lid));
  std::string text =
      fmt::format("compute         pairs all pressure NULL pair\nvariable        larger equal {}\n", larger);
  for (std::size_t axis = 0; axis <= s.vertical(); ++axis) {
    text += fmt::format("variable        stress_{} equal c_pairs[{}]*v_larger\n", "xyz"[axis], axis + 1);
  }
  return text;
}
std::string stress_columns(const Specimen& s) {
  std::string text;
  for (std::size_t axis = 0; s.scene.container.lid && axis <= s.vertical(); ++axis) {
    text += fmt::format(" v_stress_{}", "xyz"[axis]);
  }
  return text;
}

/// Servos that keep the stress of step 0, and a while in which springs that are not in the pack come back.
std::string servos(const Specimen& s) {
  if (!servoed(s)) return "";
  const double mass = s.mass / (s.copies[0] * s.copies[1]);
  const double sheet = confine::thickness(s.scene);  // in the plane LAMMPS has forces over lengths
  const double modulus = sheet * confine::gains_of(s.scene, *s.scene.container.lid, mass).modulus;
  const char up = "xyz"[s.vertical()];
  std::string text = fmt::format(
      "# under stress: lid and periods follow servos that keep it. Springs of friction are not in the file; friction "
      "is\n"
      "# ten times its own for the first steps, in which they come back, and no contact slides meanwhile.\n"
      "variable        excess equal v_stress_{0}-$(v_stress_{0})\n"
      "fix             sum all ave/time 1 1 1 v_excess ave running\n"
      "variable        lid equal f_sum*step*{1}/(200*{2})\n",
      up, *s.scene.container.lid, modulus);
  std::string press;
  for (std::size_t axis = 0; s.scene.in.confinement->on_sides() && axis < s.vertical(); ++axis) {
    if (!s.periodic(axis)) continue;
    press += fmt::format(" {0} $(v_stress_{0}/v_larger) $(v_stress_{0}/v_larger) $(200*dt)", "xyz"[axis]);
  }
  if (press.empty()) return text;
  return text +
         fmt::format("fix             sides all press/berendsen{} modulus {}\nfix_modify      sides press pairs\n",
                     press, modulus);
}
std::string hold(const Specimen& s) {
  if (!servoed(s)) return "";
  constexpr double rougher = 10.0;
  return fmt::format("variable        holding index 4000\n{}run             ${{holding}}\n{}", pairs(s, rougher),
                     pairs(s));
}

std::string drag(const Specimen& s) {
  const input::Drag& drag = s.scene.in.drag;
  if (!(drag.coefficient > 0.0)) return "";
  std::string text = fmt::format("fix             drag all viscous {}\n", drag.coefficient);
  const Vec3& u = drag.fluid_velocity;
  if (u[0] != 0.0 || u[1] != 0.0 || u[2] != 0.0) {
    text += fmt::format("fix             stream all addforce {} {} {}\n", drag.coefficient * u[0],
                        drag.coefficient * u[1], drag.coefficient * u[2]);
  }
  return text;
}

std::string in_file(const Specimen& s) {
  const input::Input& in = s.scene.in;
  std::string text = notes(s, Fluid::carried, "# ", Rolling::carried);
  text += fmt::format(
      "# lmp -in THIS [-var steps N]: reads the pack, tells what is in it, and lets it settle for some steps.\n"
      "variable        data index {}\nvariable        steps index 200\n\n"
      "units           si\ndimension       {}\natom_style      sphere\nboundary       {}\ncomm_modify     vel yes\n"
      "read_data       ${{data}}\n\n"
      "neighbor        {} bin\nneigh_modify    delay 0 every 1 check yes\n"
      "pair_style      granular\n{}",
      lammps_word(s.file), s.flat() ? 2 : 3, boundary_words(s), s.scene.skin,
      s.scene.features.mixture ? fmt::format("# {}\n", kinds_words(s, "type", 1)) + pairs(s) : pairs(s));
  text += fmt::format("fix             gravity all gravity {} vector {}\n", in.jamming.gravity,
                      s.flat() ? "0 -1 0" : "0 0 -1");
  text += drag(s);
  constexpr const char* report =
      "print           \"PACK at step $(step): $(atoms) particles, volume $(v_volume_now:%.17g) m3, mass "
      "$(mass(all):%.17g) kg, largest contact force $(v_force_now:%.17g) N\"\n";
  text += fmt::format(
      "\ncompute         diameter all property/atom diameter\n"
      "variable        volume atom PI/6*c_diameter*c_diameter*c_diameter\n"
      "compute         volume all reduce sum v_volume\n"
      "compute         contact all pair/local force\n"
      "compute         strongest all reduce max c_contact\n"
      "variable        volume_now equal c_volume\n"
      "variable        force_now equal c_strongest\n"
      "{8}{3}thermo_style    custom step atoms ke c_volume c_strongest{9}{4}\n"
      "thermo_modify   lost error norm no\nthermo          100\n\n"
      "run             0\n{0}\n"
      "# LAMMPS 29 Sep 2021 takes a wall's restitution for that of its damping once more at each run: define the walls "
      "anew before another one\n"
      "{5}{1}{2}{7}{6}run             ${{steps}}\n{0}{10}",
      report, walls(s), s.flat() ? "fix             plane all enforce2d\n" : "", stress_measures(s), stress_columns(s),
      servos(s), hold(s), begin_to_move(s, s.step(), "set             group all omega 0 0 0\n"), watch_displacement(),
      displacement_columns, drift_line(s));
  return text;
}

}  // namespace

Document make(const Specimen& s) {
  Document document;
  document.sections.push_back({data_head(s, "LAMMPS", kinds(s), "Atoms  # sphere"),
                               [&s](Text& out, const Outgoing& p) { atom_row(out, p, density_of(s, p)); }});
  document.sections.push_back(velocities(s));
  document.companion = in_file(s);
  return document;
}

}  // namespace packmpi::exporters::lammps
