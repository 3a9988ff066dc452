#include "scene/limits.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"
#include "base/error.hpp"
#include "geometry/volume.hpp"
#include "input/radius_range.hpp"
#include "input/time_step.hpp"
#include "scene/mixture.hpp"

namespace packmpi::scene {
namespace {

// The last layers of a stratum are cut to size, in so many goes at most.
constexpr std::int64_t layers_a_cut = 6;
// Room above the largest force of a regular impact before the integer sums give up, and their range in quanta.
constexpr double force_headroom = 256.0;
constexpr double largest_quanta = 1125899906842624.0;  // 2^50, see dynamics/kernel.hpp
// A quantum may be so much of the weight of the smallest particle at most.
constexpr double coarsest = 1e-3;
// Collisions pass energy on from large to small: a chain of three elastic impacts gives 7 times the speed.
constexpr double speed_headroom = 16.0;

// |f| of the near field with a particle one smallest radius away, deep inside contact [N].
double largest_near_force(const Scene& scene) {
  if (!scene.in.near_field) return 0.0;
  const input::NearField& near = *scene.in.near_field;
  const double d = scene.sizes.smallest();
  const double force = std::abs(near.alpha1) * elementary::power(d, -near.beta1) +
                       std::abs(near.alpha2) * elementary::power(d, -near.beta2);
  if (std::isfinite(force)) return force;
  throw Error(ExitCode::bad_input,
              fmt::format("{}: near_field: the force at a distance of {:g} m is beyond the range of numbers; lower the "
                          "exponents, and check the units of alpha1 and alpha2",
                          scene.in.file, d));
}

// Elastic force [N] of a particle of radius r on a rigid wall at an overlap [m].
double elastic_force(const input::Particles& particles, double r, double overlap) {
  return 4.0 / 3.0 * 2.0 * input::pair_modulus(particles, particles.youngs_modulus) * std::sqrt(r * overlap) * overlap;
}

// Largest force one contact may have: far above any impact of a falling layer and the weight of a whole column, but
// never above the elastic force at an overlap of a whole radius. Beyond it the run stops with a message (exit 4).
double largest_force(const Scene& scene) {
  const input::Input& in = scene.in;
  const double r = scene.sizes.largest();
  const double k = 4.0 / 3.0 * 2.0 * input::pair_modulus(in.particles, in.particles.youngs_modulus) *
                   std::sqrt(r);  // against a rigid wall: r* = r, m* = m
  input::Particles heaviest = in.particles;
  heaviest.density = densest(in);
  const double m = input::mass(heaviest, r);
  const double drop = scene.container.height() + 2.0 * in.layers.thickness;
  const double speed = input::impact_speed(in, drop);
  const double square = 5.0 * m * speed * speed / (4.0 * k);
  const double overlap = square > 0.0 ? elementary::power(square, 0.4) : 0.0;
  const double column = m * in.jamming.gravity * drop / r;
  const double elastic = k * r * std::sqrt(r);
  const double impact = k * overlap * std::sqrt(overlap);
  const double contact =
      std::max(impact > 0.0 ? std::min(force_headroom * impact, elastic) : elastic, force_headroom * column);
  const double force = std::max(contact, 4.0 * largest_near_force(scene));
  double friction = std::max(in.contact.friction, in.contact.wall_friction);
  for (const input::Component& of : in.components) friction = std::max({friction, of.friction, of.wall_friction});
  for (const input::ComponentPair& of : in.pairs) friction = std::max(friction, of.friction.value_or(0.0));
  return force * (1.0 + friction);
}

// What the sums must resolve: the weight of the smallest particle, or without gravity a light touch of it.
double least_force(const Scene& scene) {
  const input::Input& in = scene.in;
  const double r = scene.sizes.smallest();
  if (in.jamming.gravity > 0.0) return input::mass(in.particles, r) * in.jamming.gravity;
  return elastic_force(in.particles, r, 1e-3 * r);
}

// Speed that near forces can give the lightest particle: more than their work from the cut-off to deep inside contact,
// by all particles that may be so near.
double near_speed(const Scene& scene) {
  if (!scene.in.near_field) return 0.0;
  const double r = scene.sizes.smallest();
  const double cutoff = scene.in.near_field->cutoff;
  const double neighbors = elementary::power(cutoff / r, scene.container.dimension);
  return std::sqrt(2.0 * largest_near_force(scene) * cutoff * neighbors / input::mass(scene.in.particles, r));
}

}  // namespace

std::int64_t most_layers(const Scene& scene) {
  const input::Input& in = scene.in;
  if (insertion_alone(in)) return 1;
  if (in.layers.maximum > 0) return in.layers.maximum;
  if (in.particles.count > 0 && scene.container.straight()) {
    constexpr double uneven = 1.5;  // of the volumes that happen to be drawn
    const int power = scene.container.dimension;
    const double mean = geometry::volume(power, 1.0) * scene.sizes.curve().moment(power);
    const double a_layer = in.layers.fraction * scene.container.mean_area() * in.layers.thickness;
    return static_cast<std::int64_t>(std::ceil(uneven * static_cast<double>(in.particles.count) * mean / a_layer)) + 2;
  }
  const input::Layers& layers = in.layers;
  const double sloping = scene.container.straight() ? 1.0 : 2.0;  // layers above have less room than the bed below them
  const auto whole =
      static_cast<std::int64_t>(std::ceil(sloping * in.container.size.back() / (layers.fraction * layers.thickness))) +
      2;
  if (layers.region == input::RegionRule::open) return whole + layers_a_cut * std::ssize(in.strata);
  // Each of those that end at H_d leaves 1 - phi_0 of the room at most, down to a diameter; twice that, as they may
  // hold less than phi_0.
  const double diameters = 0.5 * layers.thickness / input::radius_range(in.particles.radius).largest;
  return whole + 2 * static_cast<std::int64_t>(std::ceil(std::log(diameters) / layers.fraction)) + 2;
}

double speed_bound(const Scene& scene) {
  const input::Input& in = scene.in;
  const double drop =
      static_cast<double>(most_layers(scene)) * in.layers.thickness;  // were every layer on the last one
  const double fluid = scene.features.drag ? norm(in.drag.fluid_velocity) : 0.0;
  const double spin = scene.features.rotation ? norm(in.layers.spin) * scene.sizes.largest() : 0.0;
  return speed_headroom * (input::impact_speed(in, drop) + fluid + spin + near_speed(scene));
}

namespace {

/// How a grading is rid of particles whose weight is too small by `factor`; "" if it is none.
std::string without_fines(const Scene& scene, double factor) {
  const input::Radius& radius = scene.in.particles.radius;
  const bool graded = radius.distribution == input::SizeDistribution::grading;
  if (!graded || radius.weighting != input::Weighting::mass || !(scene.in.jamming.gravity > 0.0)) return "";
  const double r = scene.sizes.smallest() * std::cbrt(factor);
  const auto& [from, to] = radius.keep_percent;
  const double passing = from + (to - from) * scene.sizes.curve().passing(input::Weighting::mass, r);
  return fmt::format(" (particles.radius.keep_percent = [{:.1f}, {:g}] leaves out those below a diameter of {:.2g} m)",
                     0.1 * std::ceil(10.0 * passing + 0.5), to, 2.0 * r);
}

}  // namespace

double force_quantum(const Scene& scene) {
  const double exact = largest_force(scene) / largest_quanta;
  if (!std::isfinite(exact) || exact <= 0.0) {
    throw Error(ExitCode::bad_input, scene.in.file +
                                         ": particles: the forces of these radii and moduli are out of the range of "
                                         "numbers; check the units");
  }
  int exponent = 0;
  std::frexp(exact, &exponent);  // exact <= 2^exponent
  const double quantum = std::ldexp(1.0, exponent);
  const double least = least_force(scene);
  if (quantum <= coarsest * least) return quantum;
  constexpr double any_surface = 1e3;
  throw Error(
      ExitCode::bad_input,
      fmt::format(
          "{}: {}: forces up to {:.2g} N cannot be summed beside {:.2g} N, the {} of the "
          "smallest particle: they are 2^50 apart at most; lower {}, friction or moduli, narrow the radii{}, or "
          "raise density or gravity",
          scene.in.file, scene.in.contact.friction > any_surface ? "contact.friction" : "jamming.gravity",
          quantum * largest_quanta, least, scene.in.jamming.gravity > 0.0 ? "weight" : "lightest contact",
          scene.in.near_field ? "the near field" : "layers.velocity",
          without_fines(scene, quantum / coarsest / least)));
}

}  // namespace packmpi::scene
