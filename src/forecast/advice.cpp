#include "forecast/advice.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "forecast/estimate.hpp"
#include "input/fidelity.hpp"
#include "input/time_step.hpp"
#include "run/settle.hpp"
#include "scene/mixture.hpp"

namespace packmpi::forecast {
namespace {

using Warnings = std::vector<std::string>;

void warn_of_step(const scene::Scene& scene, Warnings& warnings) {
  const double safe = scene::safe_time_step(scene.in, scene.sizes);
  if (scene.time_step > safe) {
    warnings.push_back(fmt::format(
        "time step {:g} s is beyond eq. (23) for the smallest particles ({:.3g} s), though not for the mean",
        scene.time_step, safe));
  }
}

void warn_of_softness(const scene::Scene& scene, Warnings& warnings) {
  const double modulus = scene.in.particles.youngs_modulus;
  const double overlap = scene::expected_overlap(scene, modulus);
  const double limit = scene.in.rest.mean_overlap;
  if (overlap <= limit) return;
  warnings.push_back(
      fmt::format("{}: under the bed's weight particles will overlap by about {:.2g} radii in the mean, beyond "
                  "rest.mean_overlap = {:g}: the run is going to end with code 3; {:.1e} Pa or more would do",
                  scene::limiting_key(scene.in), overlap, limit,
                  scene::modulus_for(scene, limit, modulus) * (scene::softest(scene.in).youngs_modulus / modulus)));
}

// Forces in packs have an exponential tail: the largest of n was 0.8 to 1.5 log n times that of the mean overlap in
// beds and specimens of like spheres (700 to 110,000), and overlaps are as their 2/3.
void warn_of_worst_overlap(const scene::Scene& scene, Warnings& warnings) {
  constexpr double tail = 1.4, contacts_a_particle = 2.5, margin = 1.1;
  const double modulus = scene.in.particles.youngs_modulus;
  const double mean = scene.in.confinement ? scene::confined_overlap(scene) : scene::expected_overlap(scene, modulus);
  const double limit = scene.in.rest.worst_overlap;
  const std::int64_t particles = scene::expected_filling(scene, scene::expected_fraction(scene).value).particles;
  const double contacts = contacts_a_particle * static_cast<double>(particles);
  if (!(contacts > 1.0) || mean > scene.in.rest.mean_overlap) return;
  const double worst = mean * std::pow(tail * std::log(contacts), 2.0 / 3.0);
  if (!(worst > limit)) return;
  warnings.push_back(
      fmt::format("{}: the worst of about {:.1g} contacts may overlap by {:.2g} radii, beyond "
                  "rest.worst_overlap = {:g}: the run may end with code 3; {:.2g} Pa or more would do",
                  scene::limiting_key(scene.in), contacts, worst, limit,
                  margin * scene::limiting(scene.in).youngs_modulus * std::pow(worst / limit, 1.5)));
}

void warn_of_fines(const scene::Scene& scene, Warnings& warnings) {
  constexpr double many = 1e6, most = 0.5, step = 0.05, largest_part = 0.9;
  const auto fines = scene::fines(scene);
  if (!fines || fines->particles < many || fines->share < most) return;
  if (scene.features.mixture) {
    warnings.push_back(
        fmt::format("component.radius: {}; keep_percent = [5, 100] of the component that has them leaves "
                    "most of them out",
                    fines_words(*fines)));
    return;
  }
  const auto keep = [&](double part) {
    const auto& [from, to] = scene.in.particles.radius.keep_percent;
    return fmt::format("keep_percent = [{:.4g}, {:g}]", from + part * (to - from), to);
  };
  std::string words = fmt::format("particles.radius: {}; {} leaves them out, and about {:.2g} particles in their place",
                                  fines_words(*fines), keep(fines->part), fines->without);
  std::optional<scene::Fines> more = fines;
  for (double part = fines->part + step; more->without > many && part < largest_part; part += step)
    more = scene::fines(scene, part);
  if (more->part > fines->part)
    words += fmt::format("; {} leaves about {:.2g} in all", keep(more->part), more->without);
  warnings.push_back(words);
}

// Millions of steps that nothing is gained by: layers that go on after they have settled, particles harder than their
// overlaps show. What would do is what "balanced" takes.
void warn_of_length(const scene::Scene& scene, Warnings& warnings) {
  constexpr double many_steps = 5e6, many_falls = 30.0, enough_falls = 2.0, small_overlap = 1e-4, worth = 3.0;
  const double gravity = scene.in.jamming.gravity, modulus = scene.in.particles.youngs_modulus;
  const double layers = static_cast<double>(scene::expected_layers(scene, scene::expected_fraction(scene).value));
  const double steps = layers * static_cast<double>(run::steps_of(scene, run::Part::layer));
  if (!(gravity > 0.0) || steps < many_steps) return;
  const double fall = input::fall_time(scene.in);
  const double falls = scene.in.layers.duration / fall;
  const double softer = scene::modulus_for(scene, small_overlap, modulus);
  double left = steps;  // of steps, which are as long as E^-0.4
  std::string why, instead;
  if (falls > many_falls) {
    why = fmt::format("layers.duration = {:.3g} s is {:.0f} falls through a layer", scene.in.layers.duration, falls);
    instead = fmt::format("layers.duration = {:.2g} ({:g} falls)", enough_falls * fall, enough_falls);
    left *= enough_falls / falls;
  }
  if (!scene.features.mixture && softer * worth < modulus) {  // components have moduli of their own
    why += fmt::format(
        "{}particles.youngs_modulus = {:.3g} Pa asks for steps of {:.2g} s, for overlaps of {:.2g} radii",
        why.empty() ? "" : " and ", modulus, scene.settling.time_step, scene::expected_overlap(scene, modulus));
    instead += fmt::format("{}particles.youngs_modulus = {:.2g} (overlaps of {:g})", instead.empty() ? "" : ", ",
                           softer, small_overlap);
    left *= std::pow(softer / modulus, 0.4);
  }
  if (why.empty()) return;
  warnings.push_back(fmt::format("{:.2g} steps: {}; about {:.2g} would do with {}", steps, why, left, instead));
}

}  // namespace

std::string fines_words(const scene::Fines& fines) {
  return fmt::format("the finest {:.0f} % by mass, below {:.3g} m, are {:.0f} % of about {:.2g} particles",
                     100.0 * fines.part, fines.diameter, 100.0 * fines.share, fines.particles);
}

std::vector<std::string> notes_of(const scene::Scene& scene, int ranks, int on_machine, int cores) {
  constexpr std::int64_t few = 1000;  // particles a rank, below which ranks wait for each other more than they work
  Warnings notes;
  if (ranks == 1) return notes;
  if (cores > 0 && on_machine > cores) {
    notes.push_back(fmt::format("{} ranks share {} core{} of this machine, and wait for each other; {} would be faster",
                                on_machine, cores, cores == 1 ? "" : "s", cores));
  }
  const std::int64_t particles = scene::expected_filling(scene, scene::expected_fraction(scene).value).particles;
  if (particles < few * ranks) {
    notes.push_back(fmt::format("about {} particles on {} ranks: below {} a rank, fewer ranks are mostly as fast",
                                particles, ranks, few));
  }
  return notes;
}

std::string preset_note(const scene::Scene& scene) {
  if (scene.in.fidelity == "paper") return "";
  const input::PresetOverrides overrides = input::preset_overrides(scene.in);
  if (overrides.words.empty()) return "";
  const auto cost = [](const scene::Scene& s) {
    const std::int64_t layers = scene::expected_layers(s, scene::expected_fraction(s).value);
    return static_cast<double>(particle_steps_of(s, layers, scene::particles_a_layer(s)));
  };
  std::string keys;
  for (const std::string& line : overrides.words) keys += (keys.empty() ? "" : ", ") + line;
  return fmt::format("fidelity = \"{}\" is not all of it, the scene has {}: about {:.2g} times the particle-steps",
                     scene.in.fidelity, keys, cost(scene) / cost(scene::build(overrides.as_preset)));
}

std::vector<std::string> warnings_of(const scene::Scene& scene) {
  Warnings warnings;
  if (!insertion_alone(scene.in)) {
    warn_of_step(scene, warnings);
    warn_of_softness(scene, warnings);
    warn_of_worst_overlap(scene, warnings);
    warn_of_length(scene, warnings);
  }
  warn_of_fines(scene, warnings);
  return warnings;
}

}  // namespace packmpi::forecast
