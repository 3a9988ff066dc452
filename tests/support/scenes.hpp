// Small scenes for tests, as structs: no file is read.
#pragma once
#include "input/input.hpp"
#include "scene/scene.hpp"

namespace packmpi::test {

/// The paper's data with walls, a box of the given lateral size and radius r; layers half a box high.
inline input::Input small_input(int dimension, double length, double r) {
  input::Input in;
  in.name = "test";
  in.file = "test.toml";
  in.container.dimension = dimension;
  in.container.size.assign(static_cast<std::size_t>(dimension), length);
  in.container.boundary.assign(static_cast<std::size_t>(dimension - 1), input::Boundary::wall);
  in.particles.density = 1000.0;
  in.particles.youngs_modulus = 1e8;
  in.particles.poisson_ratio = 0.25;
  in.particles.radius.distribution = input::SizeDistribution::equal;
  in.particles.radius.value = r;
  in.layers.thickness = 0.5 * length;
  in.layers.fraction = dimension == 3 ? 0.2 : 0.35;
  in.layers.duration = 0.01;
  in.layers.attempts = 10000;
  in.jamming.gravity = 2.0;
  in.contact.damping_ratio = 0.1;
  in.contact.friction = in.contact.wall_friction = 0.2;
  in.drag.coefficient = 0.0;
  in.dynamics.rotation = true;
  in.dynamics.time_step = 1e-5;
  return in;
}

/// The same with uniform radii r .. ratio r.
inline input::Input graded_input(int dimension, double length, double r, double ratio) {
  input::Input in = small_input(dimension, length, r);
  in.particles.radius.distribution = input::SizeDistribution::uniform;
  in.particles.radius.min = r;
  in.particles.radius.max = ratio * r;
  in.particles.radius.weighting = input::Weighting::number;
  return in;
}

inline input::Input periodic(input::Input in) {
  for (input::Boundary& b : in.container.boundary) b = input::Boundary::periodic;
  return in;
}

}  // namespace packmpi::test
