#include "run/record.hpp"

#include <algorithm>
#include <cmath>

#include "dynamics/kernel.hpp"
#include "observe/measure.hpp"
#include "packmpi/version.hpp"

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
double asked_sd(const scene::Scene& scene) {
  const input::Radius& radius = scene.in.particles.radius;
  if (radius.distribution == input::SizeDistribution::gaussian) return radius.sd;
  const double mean = scene.sizes.curve().moment(1);
  return std::sqrt(std::max(0.0, scene.sizes.curve().moment(2) - mean * mean));
}

void audit(const Pile& pile, const observe::Contacts& contacts, report::RunRecord& record) {
  const observe::Soundness sound = observe::soundness(pile.comm, pile.store, pile.scene);
  record.audit.expected = pile.count;
  record.audit.found = sound.found;
  record.audit.non_finite = sound.non_finite;
  record.audit.outside = sound.outside;
  record.audit.worst_overlap = contacts.max_overlap;
  record.audit.worst_wall_penetration = contacts.max_wall_penetration;
}

}  // namespace

report::RunRecord asked(const comm::Comm& comm, const scene::Scene& scene) {
  report::RunRecord record;
  record.name = scene.in.name;
  record.scene_file = scene.in.file;
  record.effective_input = scene.in.effective;
  record.seed = scene.in.seed;
  record.dimension = scene.box.dimension;
  record.size = scene.box.size;
  record.height_asked = scene.box.height();
  record.fraction_asked = scene.in.layers.fraction;
  record.mean_radius_asked = scene.sizes.mean();
  record.sd_radius_asked = asked_sd(scene);
  record.min_radius_asked = scene.sizes.smallest();
  record.max_radius_asked = scene.sizes.largest();
  record.time_step = scene.time_step;
  record.ranks = comm.size();
  record.decomposition = name_of(scene.in.parallel.decomposition);
  record.version = version();
  record.git = git_id();
  record.compiler = compiler();
  record.architecture = dynamics::kernel_architecture();
  return record;
}

void got(const Pile& pile, report::RunRecord& record) {
  const comm::Comm& comm = pile.comm;
  const scene::Scene& scene = pile.scene;
  const observe::Contacts contacts =
      observe::contacts(comm, pile.store, scene, pile.neighborhood.pairs(), pile.neighborhood.walls());
  const observe::Density density = observe::density(comm, pile.store, scene);
  const observe::Motion motion = observe::motion(comm, pile.store, scene);
  const observe::SizeStatistics sizes = observe::sizes(comm, pile.store);
  record.particles = pile.count;
  record.top = observe::top(comm, pile.store, scene);
  record.phi = density.phi;
  record.phi_bulk = density.phi_bulk;
  record.coordination = contacts.coordination;
  record.rattlers = contacts.rattlers;
  record.mean_overlap = contacts.mean_overlap;
  record.kinetic_energy = motion.kinetic_energy;
  record.floor_force = observe::floor_force(comm, pile.store, scene, pile.neighborhood.walls());
  record.weight = motion.mass * scene.in.jamming.gravity;
  record.mean_radius = sizes.mean;
  record.sd_radius = sizes.sd;
  record.min_radius = sizes.min;
  record.max_radius = sizes.max;
  record.sizes = observe::size_match(comm, pile.store, scene.sizes.curve());
  record.steps = pile.steps;
  record.thaw_steps = pile.thaw_steps;
  record.duration = pile.time();
  record.particle_steps = pile.particle_steps();
  record.bytes_per_particle = pile.bytes_per_particle();
  audit(pile, contacts, record);
}

}  // namespace packmpi::run
