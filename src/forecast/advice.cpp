#include "library/advice.hpp"

#include <fmt/core.h>

namespace packmpi::library {
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
      fmt::format("particles.youngs_modulus: under the bed's weight particles will overlap by about {:.2g} radii "
                  "in the mean, beyond rest.mean_overlap = {:g}: the run is going to end with code 3; {:.1e} Pa "
                  "or more would do",
                  overlap, limit, scene::modulus_for(scene, limit, modulus)));
}

void warn_of_fines(const scene::Scene& scene, Warnings& warnings) {
  constexpr double many = 1e6, most = 0.5;
  const auto fines = scene::fines(scene);
  if (!fines || fines->particles < many || fines->share < most) return;
  const auto& [from, to] = scene.in.particles.radius.keep_percent;
  warnings.push_back(
      fmt::format("particles.radius: {}; keep_percent = [{:g}, {:g}] leaves them out, and about {:.2g} particles "
                  "in their place",
                  fines_words(*fines), from + 0.05 * (to - from), to, fines->without));
}

}  // namespace

std::string fines_words(const scene::Fines& fines) {
  return fmt::format("the finest 5 % by mass, below {:.3g} m, are {:.0f} % of about {:.2g} particles", fines.diameter,
                     100.0 * fines.share, fines.particles);
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

std::vector<std::string> warnings_of(const scene::Scene& scene) {
  Warnings warnings;
  if (!insertion_alone(scene.in)) {
    warn_of_step(scene, warnings);
    warn_of_softness(scene, warnings);
  }
  warn_of_fines(scene, warnings);
  return warnings;
}

}  // namespace packmpi::library
