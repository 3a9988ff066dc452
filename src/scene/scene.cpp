#include "scene/scene.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "config/vessel.hpp"
#include "geometry/volume.hpp"
#include "input/time_step.hpp"
#include "scene/expectation.hpp"
#include "scene/limits.hpp"
#include "scene/mixture.hpp"

namespace packmpi::scene {
namespace {

// Neighbour lists keep pairs up to skin beyond touching. The rate is flat between 0.075 and 0.1 r (doc/performance.md).
constexpr double skin_per_radius = 0.1;
// The same for the many small ones of a wide grading, by the mean radius.
constexpr double skin_per_mean = 0.2;
// Fast particles are listed up to so many skins farther each, in boxes that have so many columns an axis, or whose
// columns are as wide anyway.
constexpr double skins_a_margin = 2.0, plenty_of_columns = 10.0;

[[noreturn]] void refuse(const input::Input& in, const std::string& words) {
  throw Error(ExitCode::bad_input, in.file + ": " + words);
}

input::RadiusRange range(const Sizes& sizes) { return {sizes.smallest(), sizes.largest()}; }

// The step `asked` under `key` for particles of this modulus; none: "auto", from the limit of eq. (23).
double choose_time_step(const input::Input& in, const Sizes& sizes, const char* key, std::optional<double> asked,
                        double youngs_modulus) {
  if (!asked) {
    const double step = input::automatic_step(in, range(sizes), youngs_modulus);
    if (!std::isfinite(step)) {
      refuse(in, fmt::format("{}: \"auto\" needs gravity or a speed at insertion to find the impact speed of eq. (23); "
                             "give a number in seconds",
                             key));
    }
    return step;
  }
  const double speed = input::impact_speed(in, in.layers.thickness);
  const double limit = input::step_limit(in, sizes.mean(), youngs_modulus, speed);
  if (*asked > limit && in.dynamics.theta == 0.0) {  // implicit steps are stable beyond it
    const double damping = input::largest_damping(in);
    refuse(in, fmt::format("{}: {:g} s is beyond the limit of eq. (23), {:.3g} s, for radius {:g} m{} and impact speed "
                           "{:.3g} m/s; use a smaller step, \"auto\", or softer particles",
                           key, *asked, limit, sizes.mean(),
                           damping > 1.0 ? fmt::format(", damping_ratio {:g}", damping) : "", speed));
  }
  return *asked;
}

// Nothing moves, so no step has a limit; what is never used is what would be, or a second.
double unused_step(const input::Input& in, const Sizes& sizes) {
  const double step = input::automatic_step(in, range(sizes), in.particles.youngs_modulus);
  return in.dynamics.time_step.value_or(std::isfinite(step) && step > 0.0 ? step : 1.0);
}

double settling_modulus(const input::Input& in) {
  return in.layers.youngs_modulus.value_or(in.particles.youngs_modulus);
}

bool softer(const input::Input& in) { return settling_modulus(in) < in.particles.youngs_modulus; }

// How layers settle: as the final stage, or softer, or in larger steps.
Stage choose_settling(const input::Input& in, const Sizes& sizes, double time_step) {
  Stage stage{time_step, settling_modulus(in)};
  if (in.layers.time_step || softer(in)) {
    stage.time_step = choose_time_step(in, sizes, "layers.time_step", in.layers.time_step, stage.youngs_modulus);
  }
  return stage;
}

void check_drag(const input::Input& in, const Sizes& sizes, double time_step) {
  const double limit = input::mass(in.particles, sizes.smallest()) / in.drag.coefficient;
  if (time_step > limit) {
    refuse(in,
           fmt::format("drag.coefficient: {:g} N s/m stops the lightest particle within {:.3g} s, less than one time "
                       "step of {:g} s; use a smaller step or coefficient",
                       in.drag.coefficient, limit, time_step));
  }
}

void check_periodic(const input::Input& in, const Scene& scene) {
  for (int axis = 0; axis < scene.container.lateral_axes(); ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const double least = 3.0 * scene.room() * scene.column_width();
    if (scene.container.periodic[a] && scene.container.size[a] < least) {
      refuse(in, fmt::format(
                     "container.size: a periodic axis must be at least {:.6g} m here (three interaction ranges), so "
                     "that no particle meets two images of another; axis {} is {:g} m",
                     least, "xy"[a], scene.container.size[a]));
    }
  }
}

// What a window left frozen, or was filled in with another friction, needs a time of its own to come to rest under what
// was put onto it (doc/theory.md).
double choose_relaxation(const input::Input& in) {
  constexpr double usual = 0.9;  // [s]
  if (insertion_alone(in)) return 0.0;
  const bool changes = in.dynamics.window > 0 || softer(in) || in.target.has_value();
  return in.dynamics.relaxation.value_or(changes ? usual : 0.0);
}

// Ten falls through the whole height, for the final stage to come to rest in (doc/theory.md, "Rest").
double choose_wait(const input::Input& in) {
  constexpr double falls = 10.0;
  const double g = in.jamming.gravity;
  if (insertion_alone(in)) return 0.0;
  return in.rest.wait.value_or(g > 0.0 ? falls * std::sqrt(2.0 * in.container.size.back() / g) : 0.0);
}

// The weight of a bed must not press its particles together beyond what the contact law is for.
void check_softness(const input::Input& in, const Scene& scene, const char* key, double youngs_modulus) {
  constexpr double most = 0.5;  // of a radius, in the mean
  const double overlap = expected_overlap(scene, youngs_modulus);
  if (!(overlap > most)) return;
  refuse(in, fmt::format("{}: {:g} Pa is too soft for this bed: under its weight, density x gravity x H_d = {:.3g} Pa, "
                         "particles would overlap by {:.2g} radii; {:.1e} Pa gives 1 %{}",
                         key, youngs_modulus, softest(in).density * in.jamming.gravity * in.container.size.back(),
                         overlap, modulus_for(scene, 0.01, youngs_modulus),
                         youngs_modulus < 1e4 ? "; a number without a unit is in Pa: \"100 MPa\" has one" : ""));
}

// Contacts under the stress of [confinement] are stiffer than those that eq. (23) thinks of.
double choose_confining_step(const input::Input& in, const Scene& scene) {
  if (!in.confinement) return 0.0;
  constexpr double share = 0.5;  // of the stability limit
  const input::Confinement& asked = *in.confinement;
  const double most = std::max(asked.on_lid(), asked.on_sides().value_or(0.0));
  const double limit = input::step_under(in, range(scene.sizes), in.particles.youngs_modulus, most);
  return std::min(scene.time_step, share * limit);
}

// Refuses a stress that would crush: particles of a modulus that is too low for it.
void check_crushing(const input::Input& in, const Scene& scene) {
  if (!in.confinement) return;
  const double limit = in.rest.mean_overlap;
  const double overlap = confined_overlap(scene);
  if (!(overlap > limit)) return;
  const double times = overlap / limit;
  refuse(in,
         fmt::format(
             "confinement: under a mean stress of {:g} Pa particles would overlap by {:.3g} radii in the mean, beyond "
             "rest.mean_overlap = {:g}: use {} = {:.2g} Pa or more, or less stress",
             mean_stress(*in.confinement), overlap, limit, limiting_key(in),
             1.2 * limiting(in).youngs_modulus * times * std::sqrt(times)));
}

// Does any component, or pair of them, have a coefficient above zero?
bool any(const input::Input& in, double input::Component::*member) {
  return std::ranges::any_of(in.components, [&](const auto& of) { return of.*member > 0.0; });
}
bool any(const input::Input& in, std::optional<double> input::ComponentPair::*member) {
  return std::ranges::any_of(in.pairs, [&](const auto& of) { return (of.*member).value_or(0.0) > 0.0; });
}

Features features_of(const input::Input& in) {
  Features f;
  f.dimension = in.container.dimension;
  f.rotation = in.dynamics.rotation;
  f.mixture = in.components.size() > 1;
  f.friction = input::has_friction(in);
  f.memory = f.friction && in.contact.tangential == input::Tangential::mindlin;
  f.rolling = f.memory &&
              (in.contact.rolling_friction > 0.0 || in.contact.twisting_friction > 0.0 ||
               any(in, &input::Component::rolling_friction) || any(in, &input::Component::twisting_friction) ||
               any(in, &input::ComponentPair::rolling_friction) || any(in, &input::ComponentPair::twisting_friction) ||
               (in.target && in.target->most_rolling_friction > 0.0));
  f.drag = in.drag.coefficient > 0.0;
  f.near_field = in.near_field.has_value();
  f.graded = in.particles.radius.distribution != input::SizeDistribution::equal;
  f.periodic = std::ranges::any_of(in.container.boundary, [](auto b) { return b == input::Boundary::periodic; });
  return f;
}

// Columns beyond four a particle of a layer would mostly be empty: in a wide box they are made wider instead.
std::int64_t most_columns(const Scene& scene) {
  constexpr double always = 0x1p16, countable = 0x1p30, a_particle = 4.0;
  const int power = scene.container.dimension;
  const double mean = geometry::volume(power, 1.0) * scene.sizes.curve().moment(power);
  const double particles = scene.in.layers.fraction * scene.container.mean_area() * scene.in.layers.thickness / mean;
  const double wanted = a_particle * particles;
  return static_cast<std::int64_t>(wanted < countable ? std::max(wanted, always) : countable);  // NaN: countable
}

// The solid fraction of exactly so many particles in the container.
double fraction_of_count(const input::Input& in, const Scene& scene) {
  const int power = scene.container.dimension;
  const double mean = geometry::volume(power, 1.0) * scene.sizes.curve().moment(power);
  const double fraction =
      static_cast<double>(in.particles.count) * mean / scene.container.volume_between(0.0, in.container.size.back());
  if (fraction < 1.0) return fraction;
  refuse(in, fmt::format("particles.count: {} particles have {:.3g} times the container's volume; lower it, or enlarge "
                         "the container",
                         in.particles.count, fraction));
}

// Times that nobody could wait for, and whose steps could not be counted.
void check_times(const input::Input& in, const Scene& scene) {
  const auto check = [&](const char* key, double seconds, double step) {
    if (seconds / step <= 0x1p40) return;
    refuse(in, fmt::format("{}: {:g} s are {:.2g} steps of {:.3g} s, more than 2^40; give less", key, seconds,
                           seconds / step, step));
  };
  check("layers.duration", in.layers.duration, scene.settling.time_step);
  check("dynamics.relaxation", scene.relaxation, scene.time_step);
  check("rest.wait", scene.wait, scene.time_step);
  if (in.confinement) check("confinement.wait", in.confinement->wait.value_or(0.0), scene.confining_step);
}

// Steps, and moduli under which they hold.
void choose_stages(const input::Input& in, Scene& scene) {
  scene.relaxation = choose_relaxation(in);
  scene.wait = choose_wait(in);
  if (insertion_alone(in)) {
    scene.time_step = unused_step(in, scene.sizes);
    scene.settling = scene.last();
    return;
  }
  scene.time_step =
      choose_time_step(in, scene.sizes, "dynamics.time_step", in.dynamics.time_step, in.particles.youngs_modulus);
  scene.settling = choose_settling(in, scene.sizes, scene.time_step);
  scene.confining_step = choose_confining_step(in, scene);
  check_times(in, scene);
  check_softness(in, scene, "particles.youngs_modulus", in.particles.youngs_modulus);
  check_crushing(in, scene);
  if (softer(in)) check_softness(in, scene, "layers.youngs_modulus", *in.layers.youngs_modulus);
  if (scene.features.drag) check_drag(in, scene.sizes, std::max(scene.time_step, scene.settling.time_step));
}

int size_levels(const Sizes& sizes) {
  if (!(sizes.ratio() > input::alike_ratio)) return 1;
  int levels = 1;
  for (double r = 0.5 * sizes.largest(); r >= sizes.smallest() && levels < 32; r *= 0.5) ++levels;
  return levels;
}

// What lists may allow a fast particle to move: as far as columns reach, to a bound. Half a skin for all where walls
// move too, an implicit step may change any speed, or the pairs of the near field are many.
double choose_margin(const Scene& scene) {
  if (scene.in.confinement || scene.in.dynamics.theta > 0.0 || scene.in.near_field) return 0.5 * scene.skin;
  const geometry::ColumnGrid grid = scene.columns();
  double width = HUGE_VAL;
  for (std::size_t a = 0; a < static_cast<std::size_t>(scene.container.lateral_axes()); ++a) {
    if (grid.counts()[a] > 1) width = std::min(width, grid.widths()[a]);
  }
  return std::clamp(0.5 * (width - scene.reach) * (1.0 - 1e-9), 0.5 * scene.skin, skins_a_margin * scene.skin);
}

}  // namespace

geometry::ColumnGrid Scene::columns() const {
  const double wide = reach + 2.0 * skins_a_margin * skin + in.layers.gap;
  bool plenty = !in.confinement && !in.near_field && in.dynamics.theta == 0.0;
  for (std::size_t a = 0; a < static_cast<std::size_t>(container.lateral_axes()); ++a) {
    plenty = plenty && container.size[a] >= plenty_of_columns * wide;
  }
  return {container, room() * (plenty ? wide : column_width()), most_columns};
}

std::int64_t steps_in(double seconds, double time_step) {
  return std::max<std::int64_t>(1, std::llround(std::min(seconds / time_step, 0x1p60)));
}

std::int64_t steps_a_row(const input::Output& output, double time_step) {
  constexpr std::int64_t usual = 100;  // a row costs three steps: 3 %
  return output.log_every ? steps_in(*output.log_every, time_step) : usual;
}

double safe_time_step(const input::Input& in, const Sizes& sizes) {
  return input::safe_step(in, range(sizes), in.particles.youngs_modulus);
}

Scene build(const input::Input& in) {
  Scene scene;
  scene.in = in;
  scene.container = input::container_of(in.container);
  scene.features = features_of(in);
  scene.sizes = Sizes(in.particles.radius, in.seed);
  for (const input::Component& of : in.components) scene.component_sizes.emplace_back(of.particles.radius, in.seed);
  scene.container.deepest = 0.5 * scene.sizes.smallest();
  scene.reach = 2.0 * scene.sizes.largest();
  if (in.near_field) scene.reach = std::max(scene.reach, in.near_field->cutoff);
  scene.skin = std::min(skin_per_radius * scene.sizes.largest(), skin_per_mean * scene.sizes.mean());
  scene.features.size_levels = size_levels(scene.sizes);
  if (insertion_alone(in) && in.particles.count > 0) scene.in.layers.fraction = fraction_of_count(in, scene);
  choose_stages(in, scene);
  check_periodic(in, scene);
  scene.most_columns = most_columns(scene);
  scene.most_margin = choose_margin(scene);
  scene.force_quantum = force_quantum(scene);
  scene.speed_bound = speed_bound(scene);
  return scene;
}

}  // namespace packmpi::scene
