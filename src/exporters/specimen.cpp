#include "exporters/specimen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>

#include "base/error.hpp"
#include "disk/scatter.hpp"
#include "exporters/quote.hpp"
#include "geometry/volume.hpp"
#include "packmpi/version.hpp"
#include "scene/mixture.hpp"

namespace packmpi::exporters {
namespace {

constexpr std::int64_t batch_rows = 1 << 14;
constexpr double volume_quanta = 0x1p32;  // of the largest sphere: sums in 64 bits are exact for 2^30 particles

double sphere(double radius) { return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius; }

pack::ParticleRow row_of(const pack::PackRows& rows, std::size_t k) {
  return {rows.id[k],     rows.position[k], rows.velocity[k], rows.spin.empty() ? Vec3{} : rows.spin[k],
          rows.radius[k], rows.layer[k],    rows.contacts[k], rows.component.empty() ? 0 : rows.component[k]};
}

/// What one rank finds.
struct Found {
  std::int64_t count = 0, quanta = 0, mass_quanta = 0;  // the last: of several components, in the densest's
  double top = 0.0, widest = 0.0;
  Vec3 lowest{}, highest{};
};

Found look(const comm::Comm& comm, const Selection& selection, const scene::Scene& scene) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const disk::IdBlocks share{selection.places(), comm.size()};
  const auto up = static_cast<std::size_t>(scene.container.vertical());
  const double scale = volume_quanta / sphere(scene.sizes.largest());
  Found found;
  found.lowest.fill(infinity);
  found.highest.fill(-infinity);
  selection.visit(share.begin(comm.rank()), share.begin(comm.rank() + 1), [&](const pack::ParticleRow& row) {
    ++found.count;
    found.quanta += std::llround(sphere(row.radius) * scale);
    if (scene.features.mixture) {
      const auto component = static_cast<std::size_t>(row.component);
      const double density = scene.in.components[component].particles.density / scene::densest(scene.in);
      found.mass_quanta += std::llround(sphere(row.radius) * scale * density);
    }
    found.top = std::max(found.top, row.position[up] + row.radius);
    found.widest = std::max(found.widest, row.radius);
    for (std::size_t c = 0; c < 3; ++c) {
      found.lowest[c] = std::min(found.lowest[c], row.position[c]);
      found.highest[c] = std::max(found.highest[c], row.position[c]);
    }
  });
  return found;
}

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

bool Selection::kept(const pack::ParticleRow& row) const {
  if (cut_.on()) return cut_.keeps(row.position, row.radius);
  const double centre = row.position[static_cast<std::size_t>(scene_->container.vertical())];
  switch (trim_) {
    case Trim::drop:
      return centre + row.radius <= scene_->container.height();
    case Trim::cut:
      return centre <= scene_->container.height();
    case Trim::none:
      break;
  }
  return true;
}

pack::PackRows Selection::read(std::int64_t first, std::int64_t count) const {
  try {
    pack::PackRows rows = file_->rows(first, count);
    pack::check_in_scene(rows, *scene_);
    return rows;
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("cannot read {}: {}", pack_, error.what()));
  }
}

void Selection::visit_batch(std::int64_t copy, const pack::PackRows& rows,
                            const std::function<void(const pack::ParticleRow&)>& take) const {
  const std::array<std::int64_t, 2> at{copy % copies_[0], copy / copies_[0]};
  for (std::size_t k = 0; k < rows.id.size(); ++k) {
    pack::ParticleRow row = row_of(rows, k);
    if (!kept(row)) continue;
    row.id += copy * file_->count() + 1;
    if (cut_.on()) row.position = cut_.place(row.position);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      if (at[axis] == 0) continue;
      const double end = scene_->container.size[axis] * copies_[axis];  // rounding must not reach it
      row.position[axis] = std::min(row.position[axis] + static_cast<double>(at[axis]) * scene_->container.size[axis],
                                    std::nextafter(end, 0.0));
    }
    take(row);
  }
}

void Selection::visit(std::int64_t begin, std::int64_t end,
                      const std::function<void(const pack::ParticleRow&)>& take) const {
  const std::int64_t n = file_->count();
  while (begin < end) {
    const std::int64_t first = begin % n;
    const std::int64_t count = std::min({batch_rows, end - begin, n - first});
    visit_batch(begin / n, read(first, count), take);
    begin += count;
  }
}

std::int64_t Selection::solid_quanta(std::int64_t begin, std::int64_t end, double quanta_a_volume) const {
  std::int64_t quanta = 0;
  while (begin < end) {
    const std::int64_t count = std::min(batch_rows, end - begin);
    const pack::PackRows rows = read(begin, count);
    for (std::size_t k = 0; k < rows.id.size(); ++k) {
      quanta += std::llround(cut_.solid(rows.position[k], rows.radius[k]) * quanta_a_volume);
    }
    begin += count;
  }
  return quanta;
}

namespace {

/// Collective. What is known of a specimen that is cut out; its container stands around it.
void survey_cut(const comm::Comm& comm, const Selection& selection, const scene::Scene& scene, Specimen& s) {
  const handover::Cut& cut = selection.cut();
  if (!cut.on()) return;
  const disk::IdBlocks share{selection.places(), comm.size()};
  const double whole = geometry::volume(scene.container.dimension, scene.sizes.largest());
  std::int64_t quanta = 0;
  comm::agree_on(comm, [&] {
    quanta = selection.solid_quanta(share.begin(comm.rank()), share.begin(comm.rank() + 1), volume_quanta / whole);
  });
  s.cut = cut.words();
  s.cut_fraction = static_cast<double>(comm.sum(quanta)) * (whole / volume_quanta) / cut.volume();
  s.scene.container = cut.container();
}

}  // namespace

Specimen survey(const comm::Comm& comm, const pack::PackFile& file, const Selection& selection,
                const ConvertRequest& request, const scene::Scene& scene) {
  Specimen s;
  Found found;
  comm::agree_on(comm, [&] {
    s.pack = std::filesystem::path(request.pack).filename().string();
    s.file = std::filesystem::path(request.file).filename().string();
    s.version = file.text("/provenance", "version");
    s.duration = file.number("/summary", "duration");
    found = look(comm, selection, scene);
  });
  s.scene = scene;
  s.rotation = file.rotation();
  s.trim = request.trim;
  s.copies = request.copies;
  s.count = comm.sum(found.count);
  s.volume = static_cast<double>(comm.sum(found.quanta)) * (sphere(scene.sizes.largest()) / volume_quanta);
  s.mass = s.volume * scene.in.particles.density;
  if (scene.features.mixture) {
    s.mass = static_cast<double>(comm.sum(found.mass_quanta)) * (sphere(scene.sizes.largest()) / volume_quanta) *
             scene::densest(scene.in);
  }
  survey_cut(comm, selection, scene, s);
  s.size = s.scene.container.size;
  for (std::size_t axis = 0; axis < s.vertical(); ++axis) s.size[axis] *= request.copies[axis];
  s.top = comm.max(found.top);
  s.widest = s.count > 0 ? comm.max(found.widest) : comm.max(1.0);
  for (std::size_t c = 0; c < 3; ++c) {
    const double low = comm.min(found.lowest[c]);
    const double high = comm.max(found.highest[c]);
    s.lowest[c] = s.count > 0 ? low : 0.0;
    s.highest[c] = s.count > 0 ? high : 0.0;
  }
  return s;
}

ConeEnds cone_ends(const Specimen& s) {
  const double low = s.scene.container.ends[0];
  const double rise = (s.scene.container.ends[1] - low) / s.scene.container.height();
  const auto radius = [&](double z) { return std::max(0.0, low + rise * z); };
  double from = -s.widest, to = inner_box(s)[2].high + 4.0 * s.widest;
  if (rise > 0.0) from = std::max(from, -0.9 * (low / rise));
  if (rise < 0.0) to = std::min(to, -(low / rise));
  return {{from, to}, {radius(from), radius(to)}};
}

std::array<Extent, 3> inner_box(const Specimen& s) {
  std::array<Extent, 3> box{};
  for (std::size_t axis = 0; axis < s.vertical(); ++axis) box[axis] = {0.0, s.size[axis]};
  box[s.vertical()] = {0.0, s.scene.container.lid.value_or(std::max(s.size[s.vertical()], s.top))};
  if (s.scene.container.is_mesh()) box[2].high = std::max(box[2].high, s.scene.container.interior->high()[2]);
  return box;
}

std::array<Extent, 3> padded_box(const Specimen& s) {
  std::array<Extent, 3> box = inner_box(s);
  for (std::size_t axis = 0; axis <= s.vertical(); ++axis) {
    if (s.periodic(axis)) continue;
    box[axis].low = std::min(box[axis].low, s.lowest[axis]) - s.widest;
    box[axis].high = std::max(box[axis].high, s.highest[axis]) + s.widest;
  }
  if (s.flat()) box[2] = {-0.5, 0.5};
  return box;
}

std::string Specimen::beside(const char* ending) const {
  return std::filesystem::path(file).replace_extension(ending).string();
}

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
