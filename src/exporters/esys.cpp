// ESyS-Particle and GenGeo: LSMGeometry 1.2. The format has no comments, so these are in a text beside it.
#include <fmt/compile.h>

#include "config/restitution.hpp"
#include "exporters/document.hpp"
#include "exporters/law.hpp"

namespace packmpi::exporters::esys {
namespace {

/// Six lines, then the number of particles: YADE's reader looks for it there.
std::string head(const Specimen& s) {
  const auto box = inner_box(s);
  return fmt::format(
      "LSMGeometry 1.2\nBoundingBox {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\nPeriodicBoundaries {} {} {}\n"
      "Dimension {}\nBeginParticles\nSimple\n{}\n",
      box[0].low, box[1].low, box[2].low, box[0].high, box[1].high, box[2].high, s.periodic(0) ? 1 : 0,
      s.periodic(1) ? 1 : 0, 0, s.flat() ? "2D" : "3D", s.count);
}

std::string note(const Specimen& s) {
  const input::Input& in = s.scene.in;
  return notes(s, Fluid::not_carried, "") +
         fmt::format(
             "not carried over: velocities and spins; the tag of every particle is 0\n"
             "density {} kg/m3\nYoung's modulus {} Pa\nPoisson's ratio {}\nfriction {}, at walls "
             "{}\n"
             "damping ratio {}, restitution {}\ngravity {} m/s2\ntime step {} s\n",
             in.particles.density, in.particles.youngs_modulus, in.particles.poisson_ratio, in.contact.friction,
             in.contact.wall_friction, in.contact.damping_ratio,
             input::restitution_of(in.contact.damping_ratio, in.contact.tension_cutoff), in.jamming.gravity, s.step());
}

}  // namespace

Document make(const Specimen& s) {
  Document document;
  document.sections.push_back({head(s), [](Text& out, const Outgoing& p) {
                                 const Vec3& x = p.row.position;
                                 fmt::format_to(fmt::appender(out),
                                                FMT_COMPILE("{:.17g} {:.17g} {:.17g} {:.17g} {} 0\n"), x[0], x[1], x[2],
                                                p.row.radius, p.row.id);
                               }});
  document.tail = "EndParticles\nBeginConnect\n0\nEndConnect\n";
  document.companion = note(s);
  return document;
}

}  // namespace packmpi::exporters::esys
