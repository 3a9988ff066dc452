// mpirun -n 1 readings SCENE SEED FROM SHIFT OF ENDS [KEY=VALUE ...]
//
// Algorithm 1 of the paper (doc/theory.md) under another reading of where a layer is inserted, for
// scripts/study/readings.py. Bed, contact law and steps are those of packmpi; the insertion is a serial loop of its own
// that rejects overlaps with the bed too, so that a region may begin below the highest top.
//   FROM    the region begins at: highest (top), surface (mean over columns of the highest tops), tenth (mean of the
//           highest tenth of them)
//   SHIFT   ... plus so many mean diameters
//   OF      phi_0 is a fraction of: region (the region's volume), centres (the volume that its centres may be in)
//   ENDS    names of those below, with commas
// One trunk of layers, as long as they end below H_d, has three ends: "open", where they go on beyond H_d; "container",
// where a region ends at H_d; "whole", the same with as many particles as a whole layer would have. What finds no
// room in layers.attempts trials is left out. Prints a line of CSV for each layer of the trunk and of each end, after
// its dynamics; an end is over when nothing can be inserted, an open one when every height has come to H_d.
#include <fmt/core.h>
#include <mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "base/random.hpp"
#include "comm/session.hpp"
#include "geometry/volume.hpp"
#include "input/read.hpp"
#include "rsa/cells.hpp"
#include "run/bed.hpp"
#include "scene/limits.hpp"

namespace packmpi {
namespace {

struct Reading {
  std::string from;
  double shift = 0.0;       // [mean diameters]
  bool of_centres = false;  // phi_0 is of their volume
};
enum class End { trunk, open, container, whole };
constexpr std::array<const char*, 4> end_names{"trunk", "open", "container", "whole"};

// The highest top of each lateral column about one largest diameter wide, ascending; 0 of an empty one. [m]
std::vector<double> column_tops(const run::Bed& bed) {
  const geometry::Container& box = bed.scene.container;
  const double width = 2.0 * bed.scene.sizes.largest();
  std::array<std::size_t, 2> counts{1, 1};
  const auto axes = static_cast<std::size_t>(box.lateral_axes());
  for (std::size_t a = 0; a < axes; ++a) counts[a] = static_cast<std::size_t>(box.size[a] / width);
  std::vector<double> tops(counts[0] * counts[1], 0.0);
  for (LocalIndex i = 0; i < bed.store.owned(); ++i) {
    const Vec3 x = bed.store.position(i);
    std::size_t column = 0;
    for (std::size_t a = 0; a < axes; ++a) {
      const double place = x[a] / box.size[a] * static_cast<double>(counts[a]);
      column = column * counts[a] + std::min(counts[a] - 1, static_cast<std::size_t>(std::max(0.0, place)));
    }
    tops[column] = std::max(tops[column], x[axes] + bed.store.radius(i));
  }
  std::ranges::sort(tops);
  return tops;
}

double mean_of(const std::vector<double>& values, std::size_t from = 0) {
  return std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(from), values.end(), 0.0) /
         static_cast<double>(values.size() - from);
}

// The heights a bed may be said to have [m].
struct Heights {
  double highest, surface, tenth;
};
Heights heights_of(const run::Bed& bed) {
  const std::vector<double> tops = column_tops(bed);
  return {tops.back(), mean_of(tops), mean_of(tops, tops.size() - std::max<std::size_t>(1, tops.size() / 10))};
}

double base_of(const Reading& reading, const Heights& heights) {
  if (reading.from == "highest") return heights.highest;
  if (reading.from == "surface") return heights.surface;
  if (reading.from == "tenth") return heights.tenth;
  throw std::invalid_argument("FROM is highest, surface or tenth");
}

struct Region {
  double bottom, thickness;  // [m]
};

// Solid volume to insert [m3] (2D: m2) into a region so thick [m].
double wanted(const scene::Scene& scene, const Reading& reading, double thickness) {
  const geometry::Container& box = scene.container;
  if (!reading.of_centres) return scene.in.layers.fraction * box.mean_area() * thickness;
  const double d = 2.0 * scene.sizes.mean();
  double volume = thickness - d;
  for (std::size_t a = 0; a < static_cast<std::size_t>(box.lateral_axes()); ++a)
    volume *= box.size[a] - (box.periodic[a] ? 0.0 : d);
  return scene.in.layers.fraction * volume;
}

// Radii of a layer in the order drawn until they have the volume, then the largest first, as in src/rsa.
std::vector<double> radii_of(const scene::Scene& scene, std::uint32_t layer, double volume) {
  std::vector<double> radii;
  for (double sum = 0.0; sum < volume;) {
    radii.push_back(scene.sizes.draw(layer, radii.size()));
    sum += geometry::volume(scene.container.dimension, radii.back());
  }
  std::ranges::stable_sort(radii, std::greater{});
  return radii;
}

// Inserts a layer. The number placed.
std::int64_t insert(run::Bed& bed, std::uint32_t layer, double volume, const Region& region) {
  const scene::Scene& scene = bed.scene;
  const auto up = static_cast<std::size_t>(scene.container.vertical());
  const auto at_height = [&](double z) { return z + scene.sizes.largest() > region.bottom; };
  const rsa::LayerRegion cells{.layer = layer, .bottom = std::max(region.bottom, 0.0), .thickness = region.thickness};
  const rsa::CellGrids grids(scene, bed.ownership, cells, bed.store.owned());
  rsa::Bins there(grids, rsa::Metric(scene.container));  // one level of sizes in these scenes: all find all
  for (LocalIndex i = 0; i < bed.store.owned(); ++i) {
    const rsa::Sphere sphere{bed.store.position(i), bed.store.radius(i)};
    if (at_height(sphere.centre[up])) there.add(sphere, 0);
  }
  bed.store.set_ghosts(0);
  std::int64_t placed = 0;
  std::uint64_t particle = 0;
  for (const double radius : radii_of(scene, layer, volume)) {
    for (std::uint32_t attempt = 0; attempt < scene.in.layers.attempts; ++attempt) {
      const auto u = random::uniforms({scene.in.seed, random::Purpose::trial, layer, particle, attempt});
      const rsa::Sphere trial{
          scene.container.draw({u[0], u[1], u[2]}, radius, std::max(region.bottom, 0.0), region.thickness), radius};
      if (there.overlaps(trial)) continue;
      there.add(trial, 0);
      bed.store.add(bed.progress.count + placed++, trial.centre, radius, {}, {});
      break;
    }
    ++particle;
  }
  return placed;
}

// The fraction of the container below a height that is solid.
double phi_below(const run::Bed& bed, double height) {
  const geometry::Container& box = bed.scene.container;
  const auto up = static_cast<std::size_t>(box.vertical());
  double solid = 0.0;
  for (LocalIndex i = 0; i < bed.store.owned(); ++i)
    solid += geometry::volume_below(box.dimension, bed.store.radius(i), bed.store.position(i)[up], height);
  return solid / (box.mean_area() * height);
}

void print_row(const run::Bed& bed, End end, std::uint32_t layer, std::int64_t inserted, const Region& region) {
  const Heights h = heights_of(bed);
  const double target = bed.scene.container.height();
  fmt::print("{},{},{},{},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f}\n",
             end_names[static_cast<std::size_t>(end)], layer + 1, inserted, bed.progress.count, region.bottom,
             region.thickness, h.highest, h.surface, h.tenth, phi_below(bed, target), phi_below(bed, h.highest),
             phi_below(bed, h.surface));
  std::fflush(stdout);
}

// Lays layers from `layer` on: the trunk's until one would not fit, or all of an end. The next layer.
std::uint32_t fill(run::Bed& bed, const Reading& reading, End end, std::uint32_t layer) {
  const scene::Scene& scene = bed.scene;
  const double target = scene.container.height();
  const double radius = scene.sizes.mean();
  const auto steps = static_cast<std::int64_t>(std::llround(scene.in.layers.duration / scene.time_step));
  for (const auto most = static_cast<std::uint32_t>(2 * scene::most_layers(scene)); layer < most; ++layer) {
    const Heights now = heights_of(bed);
    if (now.surface - radius >= target) break;
    const double whole = scene.in.layers.thickness;
    Region region{std::max(0.0, base_of(reading, now) + reading.shift * 2.0 * radius), whole};
    if (end == End::trunk && region.bottom + whole > target) break;
    if (end != End::open) region.thickness = std::min(whole, target - region.bottom);
    if (region.thickness < 2.0 * scene.sizes.largest()) break;
    const double volume = wanted(scene, reading, end == End::whole ? whole : region.thickness);
    const std::int64_t inserted = insert(bed, layer, volume, region);
    if (inserted == 0) break;
    bed.progress.count += inserted;
    bed.balance();
    bed.advance(steps);
    bed.check();
    print_row(bed, end, layer, inserted, region);
  }
  return layer;
}

void make(const comm::Comm& comm, const scene::Scene& scene, const Reading& reading, std::string_view ends) {
  run::Bed trunk(comm, scene);
  trunk.stepper.use(scene.settling);
  const std::uint32_t layers = fill(trunk, reading, End::trunk, 0);
  trunk.store.set_ghosts(0);
  for (const End end : {End::container, End::whole, End::open}) {
    if (ends.find(end_names[static_cast<std::size_t>(end)]) == std::string_view::npos) continue;
    run::Bed bed(comm, scene);  // friction by sliding remembers nothing: particles are all there is
    bed.stepper.use(scene.settling);
    for (LocalIndex i = 0; i < trunk.store.owned(); ++i)
      bed.store.add_record(trunk.store.ids()[static_cast<std::size_t>(i)], trunk.store.record(i));
    bed.progress.count = trunk.progress.count;
    fill(bed, reading, end, layers);
  }
}

}  // namespace
}  // namespace packmpi

int main(int argc, char** argv) {
  using namespace packmpi;
  if (argc < 7) {
    fmt::print(stderr, "usage: readings SCENE SEED FROM SHIFT OF ENDS [KEY=VALUE ...]\n");
    return 2;
  }
  const comm::Session session(argc, argv);
  const comm::Comm comm(MPI_COMM_WORLD);
  input::Overrides overrides;
  overrides.set.assign(argv + 7, argv + argc);
  overrides.set.push_back(fmt::format("seed={}", argv[2]));
  const scene::Scene scene = scene::build(input::read(comm, argv[1], overrides));
  fmt::print("end,layer,inserted,particles,bottom,thickness,highest,surface,tenth,phi,phi_highest,phi_surface\n");
  make(comm, scene, {argv[3], std::stod(argv[4]), std::string_view(argv[5]) == "centres"}, argv[6]);
  return 0;
}
