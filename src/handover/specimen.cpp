#include "handover/specimen.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>

#include "disk/scatter.hpp"
#include "geometry/volume.hpp"
#include "scene/mixture.hpp"

namespace packmpi::handover {
namespace {

constexpr double volume_quanta = 0x1p32;  // of the largest sphere: sums in 64 bits are exact for 2^30 particles

double sphere(double radius) { return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius; }

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

/// Collective. What is known of a specimen that is cut out; its container stands around it.
void survey_cut(const comm::Comm& comm, const Selection& selection, const scene::Scene& scene, Specimen& s) {
  const Cut& cut = selection.cut();
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
                const scene::Scene& scene) {
  const Choice& choice = selection.choice();
  Specimen s;
  Found found;
  comm::agree_on(comm, [&] {
    s.pack = std::filesystem::path(choice.pack).filename().string();
    s.version = file.text("/provenance", "version");
    s.duration = file.number("/summary", "duration");
    found = look(comm, selection, scene);
  });
  s.scene = scene;
  s.rotation = file.rotation();
  s.trim = choice.trim;
  s.copies = choice.copies;
  s.count = comm.sum(found.count);
  s.volume = static_cast<double>(comm.sum(found.quanta)) * (sphere(scene.sizes.largest()) / volume_quanta);
  s.mass = s.volume * scene.in.particles.density;
  if (scene.features.mixture) {
    s.mass = static_cast<double>(comm.sum(found.mass_quanta)) * (sphere(scene.sizes.largest()) / volume_quanta) *
             scene::densest(scene.in);
  }
  survey_cut(comm, selection, scene, s);
  s.size = s.scene.container.size;
  for (std::size_t axis = 0; axis < s.vertical(); ++axis) s.size[axis] *= choice.copies[axis];
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

}  // namespace packmpi::handover
