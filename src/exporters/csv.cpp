// Comma separated values: comment lines with '#', a line of names, a row a particle.
#include <fmt/compile.h>

#include <tuple>

#include "exporters/document.hpp"
#include "exporters/mixture.hpp"

namespace packmpi::exporters::csv {

Document make(const Specimen& s) {
  Document document;
  const bool mixture = s.scene.features.mixture;
  const std::string names = mixture ? "# " + kinds_words(s, "component", 0) + "\n" : "";
  document.sections.push_back(
      {header(s, "# ") + names + "id,x,y,z,radius,vx,vy,vz,wx,wy,wz,layer,contacts" + (mixture ? ",component" : "") +
           "\n",
       [mixture](Text& out, const Outgoing& p) {
         const auto& [x, v, w] = std::tie(p.row.position, p.row.velocity, p.row.spin);
         fmt::format_to(
             fmt::appender(out),
             FMT_COMPILE("{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},"
                         "{},{}"),
             p.row.id, x[0], x[1], x[2], p.row.radius, v[0], v[1], v[2], w[0], w[1], w[2], p.row.layer, p.row.contacts);
         if (mixture) fmt::format_to(fmt::appender(out), FMT_COMPILE(",{}"), p.row.component);
         out.push_back('\n');
       }});
  return document;
}

}  // namespace packmpi::exporters::csv
