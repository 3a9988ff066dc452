#include "exporters/header.hpp"

#include <fmt/format.h>

#include "exporters/quote.hpp"
#include "packmpi/version.hpp"

namespace packmpi::exporters {

using handover::Specimen;
using handover::Trim;

namespace {

std::string axis_words(const Specimen& s, std::size_t axis) {
  const char name = "xyz"[axis];
  const std::optional<double>& lid = s.scene.container.lid;
  if (axis == s.vertical() && lid) return fmt::format("{} from the floor at 0 to a lid at {}", name, *lid);
  if (axis == s.vertical()) return fmt::format("{} from the floor at 0, open above, H_d {}", name, s.size[axis]);
  return fmt::format("{} 0 to {} {}", name, s.size[axis], s.periodic(axis) ? "periodic" : "between walls");
}

std::string vessel_words(const Specimen& s) {
  const geometry::Container& vessel = s.scene.container;
  switch (vessel.shape) {
    case geometry::Shape::frustum:
      return fmt::format("frustum: wall of radius {} at the floor and {} at H_d around x = y = {}", vessel.ends[0],
                         vessel.ends[1], s.radius());
    case geometry::Shape::sphere:
      return s.flat() ? fmt::format("circle: wall of radius {0} around x = y = {0}", s.radius())
                      : fmt::format("sphere: wall of radius {0} around x = y = z = {0}", s.radius());
    case geometry::Shape::annulus:
      return fmt::format("annulus: walls of radius {0} and {1} around x = y = {0}", s.radius(), vessel.core);
    case geometry::Shape::mesh:
      return fmt::format("mesh: the interior of {:.9g} m3 inside {} triangles, from z = 0 to {}",
                         vessel.interior->volume(), vessel.interior->shell().triangles.size(),
                         vessel.interior->high()[2]);
    case geometry::Shape::polygon:
      return fmt::format("polygon: walls on {} sloping sides between x = 0 and {}", vessel.polygon->sloping().size(),
                         vessel.polygon->width());
    default:
      return fmt::format("cylinder: wall of radius {0} around x = y = {0}", s.radius());
  }
}

}  // namespace

std::vector<std::string> header_lines(const Specimen& s) {
  std::string box = s.round() ? vessel_words(s) : "box: " + axis_words(s, 0);
  const bool mesh = s.scene.container.is_mesh();
  for (std::size_t axis = s.round() ? s.vertical() : 1; axis <= s.vertical() && !mesh; ++axis)
    box += "; " + axis_words(s, axis);
  std::vector<std::string> lines{
      fmt::format("packmpi {}: units si (m, kg, s)", version()),
      fmt::format("{} {} of {} (made by packmpi {}), seed {}; solid volume {:.9g} m3, mass {:.9g} kg", s.count,
                  s.flat() ? "spheres in a plane" : "spheres", comment(s.pack), comment(s.version), s.scene.in.seed,
                  s.volume, s.mass),
      box};
  if (s.trim == Trim::drop) lines.emplace_back("trimmed: particles that reach above H_d are left out");
  if (s.trim == Trim::cut) lines.emplace_back("trimmed: particles with their centre above H_d are left out");
  if (!s.cut.empty()) {
    lines.push_back(
        fmt::format("cut out of the pack: {}, particles wholly inside; its solid fraction, spheres cut by "
                    "its sides, is {:.9f}",
                    comment(s.cut), s.cut_fraction));
  }
  if (s.copies[0] * s.copies[1] > 1) {
    lines.push_back(fmt::format("replicated: {} x {} copies of one periodic pack side by side, no larger random pack",
                                s.copies[0], s.copies[1]));
  }
  return lines;
}

std::string header(const Specimen& s, std::string_view comment_mark) {
  std::string text;
  for (const std::string& line : header_lines(s)) text += fmt::format("{}{}\n", comment_mark, line);
  return text;
}

}  // namespace packmpi::exporters
