#include "run/record.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "comm/petsc.hpp"
#include "config/words.hpp"
#include "dynamics/kernel.hpp"
#include "observe/measure.hpp"
#include "packmpi/version.hpp"
#include "report/judge.hpp"
#include "run/search.hpp"
#include "start/taken.hpp"

namespace packmpi::run {
namespace {

const char* name_of(input::Decomposition kind) {
  switch (kind) {
    case input::Decomposition::slab:
      return "slab";
    case input::Decomposition::pencil:
      return "pencil";
    case input::Decomposition::metis:
      return "metis";
  }
  return "";
}

// Of a gaussian before truncation, as the scene has it; else of the distribution.
double target_sd(const scene::Scene& scene) {
  const input::Radius& radius = scene.in.particles.radius;
  if (radius.distribution == input::SizeDistribution::gaussian) return radius.sd;
  const double mean = scene.sizes.curve().moment(1);
  return std::sqrt(std::max(0.0, scene.sizes.curve().moment(2) - mean * mean));
}

// A pack that was taken over and never moved rests as it did; without what its contacts remember that cannot be told.
void forget_limits_of_rest(std::vector<report::Criterion>& criteria) {
  for (report::Criterion& c : criteria) {
    if (!c.of_overlap) c.limit = std::numeric_limits<double>::infinity();
  }
}

report::DensityTarget density_target(const Bed& bed) {
  const control::Filling& filling = bed.progress.filling;
  if (!filling.on) return {};
  report::DensityTarget target{.key = target_key(*bed.scene.in.target),
                               .fraction = filling.target,
                               .tolerance = bed.scene.in.target->tolerance,
                               .confined = bed.scene.in.target->state == input::TargetState::confined,
                               .friction = {},
                               .rolling_friction = {},
                               .buried = filling.layer_fractions};
  for (const control::Knob knob : filling.layer_knobs) {
    const scene::Friction friction = control::friction_of(bed.scene.in, knob);
    target.friction.push_back(friction.particles);
    target.rolling_friction.push_back(friction.rolling);
  }
  return target;
}

void audit(const Bed& bed, report::RunRecord& record) {
  const observe::Contacts contacts =
      observe::contacts(bed.comm, bed.store, bed.scene, bed.neighborhood.pairs(), bed.neighborhood.walls());
  const observe::Validity valid = observe::validity(bed.comm, bed.store, bed.scene);
  record.audit.expected = bed.progress.count;
  record.audit.found = valid.found;
  record.audit.non_finite = valid.non_finite;
  record.audit.outside = valid.outside;
  record.audit.worst_overlap = contacts.max_overlap;
  record.audit.worst_wall_penetration = contacts.max_wall_penetration;
}

}  // namespace

report::RunRecord targets_of(const comm::Comm& comm, const scene::Scene& scene) {
  report::RunRecord record;
  record.name = scene.in.name;
  record.scene_file = scene.in.file;
  record.effective_input = scene.in.effective;
  record.seed = scene.in.seed;
  record.dimension = scene.container.dimension;
  record.shape = input::word(scene.in.container.shape);
  record.size = scene.container.size;
  record.bottom_diameter = 2.0 * scene.container.ends[0], record.top_diameter = 2.0 * scene.container.ends[1];
  record.inner_diameter = 2.0 * scene.container.core;
  record.bottom_width = scene.in.container.bottom_width, record.top_width = scene.in.container.top_width;
  record.target_height = scene.container.height();
  record.target_fraction = scene.in.layers.fraction;
  record.target_particles = scene.in.particles.count;
  record.insertion_alone = insertion_alone(scene.in);
  record.target_mean_radius = scene.sizes.mean();
  record.target_sd_radius = target_sd(scene);
  record.target_min_radius = scene.sizes.smallest();
  record.target_max_radius = scene.sizes.largest();
  record.time_step = scene.time_step;
  record.ranks = comm.size();
  record.decomposition = name_of(scene.in.parallel.decomposition);
  record.version = version();
  record.git = git_id();
  record.compiler = compiler();
  record.architecture = dynamics::kernel_architecture();
  record.petsc_options = comm::petsc_options_in_use();
  record.criteria = report::judge(scene, {});  // their limits; the values come with the bed
  return record;
}

void measure_bed(const Bed& bed, report::RunRecord& record) {
  const comm::Comm& comm = bed.comm;
  const scene::Scene& scene = bed.scene;
  const observe::Bulk bulk = bed.bulk();
  const observe::Density density = observe::density(comm, bed.store, scene, bulk);
  const observe::Motion motion = observe::motion(comm, bed.store, scene);
  const observe::SizeStatistics sizes = observe::sizes(comm, bed.store);
  const pack::Progress& at = bed.progress;
  record.density = density_target(bed);
  record.particles = at.count;
  record.height = at.confined.on ? bed.height() : at.height;
  const bool full = at.confined.on ? at.confined.full : bed.full();
  const bool counted = record.target_particles > 0, weighed = control::by_mass(scene);
  record.reached = counted                  ? at.count == record.target_particles
                   : record.insertion_alone ? !at.layers.empty()
                   : weighed                ? !control::wants_mass(scene, at.mixing)
                                            : full || at.height >= record.target_height;
  record.start = start::taken_words(scene, at);
  record.stop_reason = counted && record.reached   ? "count"
                       : record.insertion_alone    ? "fraction"
                       : full                      ? "full"
                       : weighed && record.reached ? "mass"
                       : record.reached            ? "height"
                                                   : "layers.maximum";
  record.compaction_rate = at.compaction_rate;
  record.layers = at.layers;
  record.relaxations = at.relaxations;
  record.height_before_relaxation = at.height_before_relaxation;
  record.series_rows = at.series.rows;
  record.top = observe::top(comm, bed.store, scene);
  record.phi = density.phi;
  record.phi_bulk = density.phi_bulk;
  record.bulk = bulk;
  record.rest = observe::rest(comm, bed.store, scene, bed.neighborhood);
  record.kinetic_energy = motion.kinetic_energy;
  record.floor_force = observe::floor_force(comm, bed.store, scene, bed.neighborhood.walls());
  record.weight = motion.mass * scene.in.jamming.gravity;
  record.mean_radius = sizes.mean;
  record.sd_radius = sizes.sd;
  record.min_radius = sizes.min;
  record.max_radius = sizes.max;
  record.sizes = observe::size_match(comm, bed.store, scene.sizes.curve());
  record.composition = observe::composition(comm, bed.store, scene, bulk, bed.strata());
  record.component_masses = control::masses_wanted(scene, at.mixing);
  record.steps = at.steps;
  record.relaxation_steps = at.relaxation_steps;
  record.duration = bed.time();
  record.particle_steps = at.particle_steps;
  record.bytes_per_particle = bed.bytes_per_particle();
  record.confined = confine::measure(comm, bed.store, scene, bed.neighborhood, at.confined);
  audit(bed, record);
  record.criteria = report::judge(scene, record.rest);
  if (scene.in.start && at.steps == 0 && start::lacks_springs(scene, at)) forget_limits_of_rest(record.criteria);
  record.missed = report::missed_targets(scene, record);
  record.targets_met = record.missed.empty();
}

}  // namespace packmpi::run
