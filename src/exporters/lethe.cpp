// Lethe: the table that "insertion method = file" reads, and the parameters that go with it.
#include <fmt/compile.h>

#include <cmath>
#include <tuple>

#include "exporters/document.hpp"
#include "exporters/law.hpp"
#include "exporters/quote.hpp"

namespace packmpi::exporters::lethe {
namespace {

std::string properties(const Specimen& s) {
  const input::Input& in = s.scene.in;
  const input::Particles& p = in.particles;
  const double factor = in.contact.wall == input::WallStiffness::rigid ? 1e5 : 1.0;
  const double e = restitution(in.contact.damping_ratio);
  return fmt::format(
      "  set number of particle types = 1\n  subsection particle type 0\n    set number of particles = {}\n"
      "    set diameter = {}\n    set density particles = {}\n    set young modulus particles = {}\n"
      "    set poisson ratio particles = {}\n    set restitution coefficient particles = {}\n"
      "    set friction coefficient particles = {}\n    set rolling friction particles = 0\n  end\n"
      "  set young modulus wall = {}\n  set poisson ratio wall = {}\n  set restitution coefficient wall = "
      "{}\n  set friction coefficient wall = {}\n  set rolling friction wall = 0\n",
      s.count, 2.0 * s.widest, p.density, p.youngs_modulus, p.poisson_ratio, e, in.contact.friction,
      factor * p.youngs_modulus, p.poisson_ratio, e, in.contact.wall_friction);
}

/// A box of cells at least two largest diameters wide; its faces have the numbers 0 to 5, or 0 to 3.
std::string mesh(const Specimen& s) {
  if (s.round()) {
    return fmt::format(
        "# not carried over: the cylinder. Give a mesh of its inside: radius {0} m about x = y = {0} m, from z = 0 to "
        "{1} m{2}\nsubsection mesh\n  set type = gmsh\n  set file name = cylinder.msh\nend\n",
        s.radius(), inner_box(s)[2].high, s.scene.container.lid ? ", where the lid is" : " at least");
  }
  const auto box = inner_box(s);
  std::string cells, low, high;
  for (std::size_t axis = 0; axis <= s.vertical(); ++axis) {
    const bool open = axis == s.vertical() && !s.scene.container.lid;
    const double end = open ? box[axis].high + 2.0 * s.widest : box[axis].high;
    const char* between = axis == 0 ? "" : ",";
    cells += fmt::format("{}{:.0f}", between, std::fmax(1.0, std::floor(end / (4.0 * s.widest))));
    low += fmt::format("{}0", between);
    high += fmt::format("{}{}", between, end);
  }
  return fmt::format(
      "subsection mesh\n  set type = dealii\n  set grid type = subdivided_hyper_rectangle\n"
      "  set grid arguments = {} : {} : {} : true\n  set initial refinement = 0\nend\n",
      cells, low, high);
}

std::string periods(const Specimen& s) {
  std::string text;
  int number = 0;
  for (std::size_t axis = 0; axis < s.vertical(); ++axis) {
    if (!s.periodic(axis)) continue;
    text += fmt::format(
        "  subsection boundary condition {}\n    set type = periodic\n    set periodic id 0 = {}\n    set periodic id "
        "1 "
        "= {}\n    set periodic direction = {}\n  end\n",
        number++, 2 * axis, 2 * axis + 1, axis);
  }
  if (number == 0) return "";
  return fmt::format("subsection DEM boundary conditions\n  set number of boundary conditions = {}\n{}end\n", number,
                     text);
}

std::string parameters(const Specimen& s) {
  const double g = s.scene.in.jamming.gravity;
  const double dt = s.step();
  std::string text = notes(s, Fluid::not_carried, "# ");
  text += fmt::format(
      "# Parameters of Lethe 1.0 for lethe-particles; names differ between versions.\n"
      "set dimension = {}\n\nsubsection simulation control\n  set time step = {}\n  set time end = {}\nend\n"
      "subsection model parameters\n  set particle particle contact force method = hertz_mindlin_limit_overlap\n"
      "  set particle wall contact force method = nonlinear\n  set rolling resistance torque method = "
      "no_resistance\nend\n"
      "subsection lagrangian physical properties\n  set g = {}\n{}end\n"
      "subsection insertion info\n  set insertion method = file\n  set list of input files = {}\n  set insertion "
      "frequency = 1000000\nend\n",
      s.flat() ? 2 : 3, dt, 200.0 * dt, s.flat() ? fmt::format("0.0, {}, 0.0", -g) : fmt::format("0.0, 0.0, {}", -g),
      properties(s), lethe_file(s.file));
  return text + mesh(s) + periods(s);
}

}  // namespace

Document make(const Specimen& s) {
  Document document;
  document.sections.push_back(
      {"p_x; p_y; p_z; v_x; v_y; v_z; w_x; w_y; w_z; diameters; fem_force_x; fem_force_y; fem_force_z; fem_torque_x; "
       "fem_torque_y; fem_torque_z; \n",
       [](Text& out, const Outgoing& p) {
         const auto& [x, v, w] = std::tie(p.row.position, p.row.velocity, p.row.spin);
         fmt::format_to(fmt::appender(out),
                        FMT_COMPILE("{:.17g}; {:.17g}; {:.17g}; {:.17g}; {:.17g}; {:.17g}; {:.17g}; {:.17g}; {:.17g}; "
                                    "{:.17g}; 0; 0; 0; 0; 0; 0;\n"),
                        x[0], x[1], x[2], v[0], v[1], v[2], w[0], w[1], w[2], 2.0 * p.row.radius);
       }});
  document.companion = parameters(s);
  return document;
}

}  // namespace packmpi::exporters::lethe
