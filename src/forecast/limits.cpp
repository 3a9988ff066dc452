#include "forecast/limits.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "comm/petsc.hpp"
#include "run/search.hpp"

namespace packmpi::forecast {
namespace {

report::State state_of(const input::Input& in, const std::vector<control::Trial>& trials) {
  const scene::Friction friction = control::friction_of(in, trials.front().knob);
  report::State state{.friction = friction.particles,
                      .wall_friction = friction.walls,
                      .rolling_friction = friction.rolling,
                      .twisting_friction = friction.twisting,
                      .fractions = {},
                      .coordinations = {}};
  for (const control::Trial& trial : trials) {
    state.fractions.push_back(trial.relaxed);
    state.coordinations.push_back(trial.coordination);
  }
  return state;
}

// A target there must be, for its knobs; which one does not matter here.
input::Input with_target(const comm::Comm& comm, const std::string& path, const input::Overrides& overrides) {
  input::Input in = input::read(comm, path, overrides);
  if (in.target) return in;
  if (!in.strata.empty()) {
    throw Error(ExitCode::bad_input, path + ": limits are found on a sample of one recipe, and strata have several");
  }
  input::Overrides more = overrides;
  more.set.emplace_back("target.relative_density=0.5");
  return input::read(comm, path, more);
}

std::string protocol_of(const input::Input& in, const control::Sample& sample) {
  return fmt::format(
      "{}, {} seeds each, filled in layers of {:g} m at solid fraction {:g}, {:g} s each\n"
      "under gravity {:g} m/s2 with the friction below; then {:g} s and until it rests with the scene's own\n"
      "({}friction {:g}, walls {:g}, rolling {:g}, twisting {:g}); solid fractions are those of the bulk",
      sample.whole ? "the scene itself" : fmt::format("a sample of about {:.0f} particles", sample.particles),
      run::seeds_of_extremes, in.layers.thickness, in.layers.fraction, in.layers.duration, in.jamming.gravity,
      sample.scene.relaxation, in.components.empty() ? "" : "components' own, in proportion to ", in.contact.friction,
      in.contact.wall_friction, in.contact.rolling_friction, in.contact.twisting_friction);
}

}  // namespace

report::LimitsReport limits(const comm::Comm& comm, const std::string& path, const input::Overrides& overrides) {
  const input::Input in = with_target(comm, path, overrides);
  comm::petsc_options(in.petsc.options);
  const scene::Scene scene = scene::build(in);
  const control::Sample sample = control::sample_of(scene);
  const run::Extremes found = run::find_extremes(comm, scene);
  return {.scene_file = path,
          .seeds = found.seeds,
          .whole = sample.whole,
          .particles = sample.particles,
          .size = sample.scene.in.container.size,
          .scale = sample.scale,
          .protocol = protocol_of(in, sample),
          .densest = state_of(in, found.densest),
          .loosest = state_of(in, found.loosest)};
}

}  // namespace packmpi::forecast
