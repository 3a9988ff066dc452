// PFC: commands a line each, and a script for PFC's Python that runs the same file faster.
#include <fmt/compile.h>

#include "exporters/document.hpp"
#include "exporters/law.hpp"
#include "exporters/quote.hpp"

namespace packmpi::exporters::pfc {
namespace {

/// PFC wants radii below a quarter of the smallest extent: axes without period are as wide as that takes.
std::string domain(const Specimen& s) {
  auto box = padded_box(s);
  std::string extent, condition;
  for (std::size_t axis = 0; axis <= s.vertical(); ++axis) {
    const double missing = 8.0 * s.widest - (box[axis].high - box[axis].low);
    if (!s.periodic(axis) && missing > 0.0) box[axis] = {box[axis].low - missing / 2, box[axis].high + missing / 2};
    extent += fmt::format(" {:.17g} {:.17g}", box[axis].low, box[axis].high);
    condition += s.periodic(axis) ? " periodic" : " destroy";
  }
  return fmt::format("model domain extent{} condition{}\n", extent, condition);
}

std::string law(const Specimen& s) {
  const input::Input& in = s.scene.in;
  const double g = in.jamming.gravity;
  return fmt::format(
             "contact cmat default model hertz property hz_shear {} hz_poiss {} fric {} dp_nratio "
             "{}\n",
             shear_modulus(s), in.particles.poisson_ratio, in.contact.friction, in.contact.damping_ratio) +
         (s.flat() ? fmt::format("model gravity 0 {}\n", -g) : fmt::format("model gravity 0 0 {}\n", -g));
}

std::string walls(const Specimen& s) {
  const auto plane = [&](std::size_t axis, double at) {
    Vec3 point{}, normal{};
    point[axis] = at;
    normal[axis] = 1.0;
    if (s.flat()) {
      return fmt::format("wall generate plane position {} {} dip {}\n", point[0], point[1], axis == 0 ? 90 : 0);
    }
    return fmt::format("wall generate plane position {} {} {} dip {} dip-direction {}\n", point[0], point[1], point[2],
                       axis == 2 ? 0 : 90, axis == 0 ? 90 : 0);
  };
  std::string text;
  if (s.round()) {
    text = fmt::format("wall generate cylinder base {0} {0} {1} axis 0 0 1 height {2} radius {0} cap false false\n",
                       s.radius(), -s.widest, inner_box(s)[2].high + 4.0 * s.widest);
  }
  for (std::size_t axis = 0; axis < s.vertical() && !s.round(); ++axis) {
    if (!s.periodic(axis)) text += plane(axis, 0.0) + plane(axis, s.size[axis]);
  }
  if (s.scene.container.lid) text += plane(s.vertical(), *s.scene.container.lid);
  return text + plane(s.vertical(), 0.0);
}

std::string head(const Specimen& s) {
  return notes(s, Fluid::not_carried, "; ") +
         "; not carried over: velocities and spins\n"
         "; program call THIS, or run the script beside it in PFC's Python\nmodel new\n" +
         domain(s) + law(s) + walls(s);
}

std::string script(const Specimen& s) {
  return header(s, "# ") +
         fmt::format(
             "# In PFC's Python: the commands of the data file, balls by the fast way. Ids are then PFC's own.\n"
             "import itasca\n\n"
             "for line in open({}, encoding=\"utf-8\"):\n"
             "    words = line.split()\n"
             "    if words[:2] == [\"ball\", \"create\"]:\n"
             "        itasca.ball.create(float(words[5]), tuple(float(word) for word in words[7::2]))\n"
             "    elif words and not line.startswith(\";\"):\n"
             "        itasca.command(line)\n",
             python_string(s.file));
}

void ball_3d(Text& out, const Outgoing& p) {
  const Vec3& x = p.row.position;
  fmt::format_to(
      fmt::appender(out),
      FMT_COMPILE("ball create id {} radius {:.17g} position-x {:.17g} position-y {:.17g} position-z {:.17g}\n"),
      p.row.id, p.row.radius, x[0], x[1], x[2]);
}

void ball_2d(Text& out, const Outgoing& p) {
  const Vec3& x = p.row.position;
  fmt::format_to(fmt::appender(out),
                 FMT_COMPILE("ball create id {} radius {:.17g} position-x {:.17g} position-y {:.17g}\n"), p.row.id,
                 p.row.radius, x[0], x[1]);
}

}  // namespace

Document make(const Specimen& s) {
  const double density = s.scene.in.particles.density;
  Document document;
  document.sections.push_back({head(s), s.flat() ? ball_2d : ball_3d});
  if (s.flat() && s.scene.features.graded) {  // discs of unit thickness there, spheres in a plane here
    document.sections.push_back({"", [density](Text& out, const Outgoing& p) {
                                   fmt::format_to(fmt::appender(out),
                                                  FMT_COMPILE("ball attribute density {:.17g} range id {}\n"),
                                                  4.0 / 3.0 * p.row.radius * density, p.row.id);
                                 }});
  } else {
    const double same = s.flat() ? 4.0 / 3.0 * s.widest * density : density;
    document.tail = fmt::format("ball attribute density {:.17g}\n", same);
  }
  document.companion = script(s);
  return document;
}

}  // namespace packmpi::exporters::pfc
