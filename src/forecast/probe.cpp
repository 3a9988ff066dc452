#include "forecast/probe.hpp"

#include <algorithm>
#include <cmath>

#include "base/timer.hpp"
#include "rsa/insert.hpp"
#include "run/bed.hpp"
#include "run/settle.hpp"
#include "scene/expectation.hpp"

namespace packmpi::forecast {
namespace {

constexpr int probe_layers = 3;               // so that most particles have others above and below
constexpr double particles_wanted = 900.0;    // in a layer: small enough to settle within the time
constexpr double least_in_columns = 4.0;      // a periodic axis takes three
constexpr double thickness_in_largest = 2.0;  // thickness, in largest diameters
constexpr std::int64_t explicit_steps = 100;  // between looks at the clock
constexpr std::int64_t implicit_steps = 2;

// The same scene on a smaller floor; if that is still too much, with thinner layers.
scene::Scene small_scene(const scene::Scene& scene) {
  input::Input in = scene.in;
  in.layers.region = input::RegionRule::open;  // whole layers are what most of a run is
  in.particles.count = 0;
  if (in.container.shape != input::VesselShape::cylinder) in.container.shape = input::VesselShape::box;
  const auto axes = static_cast<std::size_t>(scene.container.lateral_axes());
  const double share = particles_wanted / static_cast<double>(scene::particles_a_layer(scene));
  const double factor = axes == 2 ? std::sqrt(share) : share;
  double area_left = share;
  for (std::size_t axis = 0; axis < axes; ++axis) {
    const double least = least_in_columns * scene.column_width();
    const double side = std::min(in.container.size[axis], std::max(least, factor * in.container.size[axis]));
    area_left *= in.container.size[axis] / side;
    in.container.size[axis] = side;
  }
  const double least = std::min(in.layers.thickness, thickness_in_largest * 2.0 * scene.sizes.largest());
  in.layers.thickness = std::clamp(area_left * in.layers.thickness, least, in.layers.thickness);
  return scene::build(in);
}

struct Clock {
  double inserting = 0.0, settling = 0.0;  // [s]
};

void insert(run::Bed& bed, Clock& clock) {
  const Stopwatch watch;
  bed.store.set_ghosts(0);
  const rsa::LayerRegion region = bed.next_region();
  bed.progress.first_ids.push_back(bed.progress.count);
  bed.progress.count += rsa::insert(bed.comm, bed.scene, bed.ownership, region, bed.store).inserted;
  clock.inserting += watch.seconds();
}

// A layer's steps, or as many as there is time for.
void settle_for(run::Bed& bed, double seconds, Clock& clock) {
  const Stopwatch watch;
  const std::int64_t most = steps_of(bed.scene, run::Part::layer);
  const std::int64_t chunk = bed.scene.in.dynamics.theta > 0.0 ? implicit_steps : explicit_steps;
  bed.balance();
  for (std::int64_t done = 0; done < most && watch.seconds() < seconds;) {
    const std::int64_t next = std::min(chunk, most - done);
    bed.advance(next);
    done += next;
  }
  clock.settling += watch.seconds();
}

}  // namespace

report::Probe probe(const scene::Scene& scene, double seconds) {
  const comm::Comm alone(MPI_COMM_SELF);
  const scene::Scene small = small_scene(scene);
  run::Bed bed(alone, small);
  bed.stepper.use(small.settling);
  Clock clock;
  for (int layer = 0; layer < probe_layers; ++layer) {
    insert(bed, clock);
    settle_for(bed, seconds / probe_layers, clock);
  }
  return {.particles = bed.progress.count,
          .steps = bed.progress.steps,
          .seconds = clock.inserting + clock.settling,
          .particle_steps_per_second = static_cast<double>(bed.progress.particle_steps) / clock.settling,
          .insertions_per_second = static_cast<double>(bed.progress.count) / clock.inserting};
}

}  // namespace packmpi::forecast
