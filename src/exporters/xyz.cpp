// Extended XYZ, as OVITO and ASE read it.
#include <fmt/compile.h>

#include <tuple>

#include "exporters/document.hpp"

namespace packmpi::exporters::xyz {
namespace {

std::string head(const Specimen& s) {
  auto box = inner_box(s);
  if (s.flat()) box[2] = {-s.widest, s.widest};
  const auto flag = [&s](std::size_t axis) { return s.periodic(axis) ? 'T' : 'F'; };
  std::string about;
  for (const std::string& line : header_lines(s)) about += (about.empty() ? "" : "; ") + line;
  for (char& c : about) {
    if (c == '"' || c == '\\') c = '\'';
  }
  return fmt::format(
      "{}\nLattice=\"{:.17g} 0 0 0 {:.17g} 0 0 0 {:.17g}\" Origin=\"{:.17g} {:.17g} {:.17g}\" pbc=\"{} {} {}\" "
      "Properties=id:I:1:type:I:1:pos:R:3:radius:R:1:velo:R:3:n_neighb:I:1:spin:R:3:layer:I:1 Time={:.17g} "
      "comment=\"{}\"\n",
      s.count, box[0].high - box[0].low, box[1].high - box[1].low, box[2].high - box[2].low, box[0].low, box[1].low,
      box[2].low, flag(0), flag(1), flag(2), s.duration, about);
}

}  // namespace

Document make(const Specimen& s) {
  Document document;
  document.sections.push_back({head(s), [](Text& out, const Outgoing& p) {
                                 const auto& [x, v, w] = std::tie(p.row.position, p.row.velocity, p.row.spin);
                                 fmt::format_to(fmt::appender(out),
                                                FMT_COMPILE("{} 1 {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} "
                                                            "{:.17g} {} {:.17g} {:.17g} {:.17g} {}\n"),
                                                p.row.id, x[0], x[1], x[2], p.row.radius, v[0], v[1], v[2],
                                                p.row.contacts, w[0], w[1], w[2], p.row.layer);
                               }});
  return document;
}

}  // namespace packmpi::exporters::xyz
