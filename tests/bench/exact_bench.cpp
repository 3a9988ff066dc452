// Exactly solvable problems against the time step: relative errors and observed orders, as Markdown tables, and what
// step the law itself can bear. scripts/study/exact_problems.py writes them into doc/accuracy.md.
#include <fmt/core.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "comm/session.hpp"
#include "input/time_step.hpp"
#include "observe/measure.hpp"
#include "rsa/insert.hpp"
#include "run/bed.hpp"
#include "scene/limits.hpp"
#include "support/scenes.hpp"
#include "support/tiny_world.hpp"

namespace packmpi {
namespace {

using support::plain_scene;
using support::World;

constexpr double r = 0.01;       // [m]
constexpr double gravity = 2.0;  // [m/s2]

scene::Scene smooth(double step) {
  scene::Scene s = plain_scene(3, r);
  s.time_step = step;
  return s;
}

scene::Scene rough(double step, double friction) {
  scene::Scene s = smooth(step);
  s.features.rotation = true;
  support::add_friction(s, friction);
  return s;
}

double weight(const scene::Scene& s) { return input::mass(s.in.particles, r) * gravity; }
double pair_stiffness() { return 4.0 / 3.0 * 1e8 / (2.0 * (1.0 - 0.0625)) * std::sqrt(0.5 * r); }
double wall_stiffness() { return 4.0 / 3.0 * 1e8 / (1.0 - 0.0625) * std::sqrt(r); }
double rolling(const World& world) { return world.store().spin(0)[1] * r; }

/// Duration of eq. (23) for two of them that meet at `speed`: what steps are measured by.
double contact(double speed) {
  const scene::Scene s = smooth(1.0);
  return input::contact_duration(0.5 * input::mass(s.in.particles, r), 0.5 * r,
                                 input::pair_modulus(s.in.particles, 1e8), speed);
}

// Two spheres that meet at +-v/2, first touching after a fraction of a step: the error would depend on it, so it is the
// mean of its square over several.
constexpr int phases = 8;

template <class Error>
double over_phases(Error&& error) {
  double squares = 0.0;
  for (int k = 0; k < phases; ++k) squares += std::pow(error((k + 0.5) / phases), 2);
  return std::sqrt(squares / phases);
}

World meeting(const scene::Scene& s, double speed, double phase) {
  World world(s);
  const double gap = 0.5 * speed * s.time_step * phase;
  world.add({50.0 - r - gap, 50.0, 50.0}, {0.5 * speed, 0.0, 0.0});
  world.add({50.0 + r + gap, 50.0, 50.0}, {-0.5 * speed, 0.0, 0.0});
  return world;
}

double hertz_overlap(double dt) {
  return over_phases([&](double phase) {
    const scene::Scene s = smooth(dt);
    World world = meeting(s, 0.6, phase);
    double deepest = 0.0;
    for (double t = 0.0; t < 1.5 * contact(0.6); t += dt) {
      world.step();
      deepest = std::max(deepest, 2.0 * r - (world.position(1)[0] - world.position(0)[0]));
    }
    const double m = 0.5 * input::mass(s.in.particles, r);
    return deepest / std::pow(5.0 * m * 0.36 / (4.0 * pair_stiffness()), 0.4) - 1.0;
  });
}

double elastic_rebound(double dt) {
  return over_phases([&](double phase) {
    World world = meeting(smooth(dt), 0.6, phase);
    world.run(2.5 * contact(0.6));
    return (world.velocity(1)[0] - world.velocity(0)[0]) / 0.6 - 1.0;
  });
}

double restitution(double dt) {
  constexpr double xi = 0.1;
  const double b = xi * std::sqrt(6.0 / 5.0);
  const double exact = std::exp(-std::numbers::pi * b / std::sqrt(1.0 - b * b));
  return over_phases([&](double phase) {
    scene::Scene s = smooth(dt);
    s.in.contact.damping_ratio = xi;
    s.in.contact.tension_cutoff = false;
    World world = meeting(s, 0.6, phase);
    world.run(2.5 * contact(0.6));
    return (world.velocity(1)[0] - world.velocity(0)[0]) / 0.6 / exact - 1.0;
  });
}

World thrown(double dt, double along, double phase) {
  World world(rough(dt, 0.2));
  world.add({50.0, 50.0, r + 0.3 * dt * phase}, {along, 0.0, -0.3});
  world.run(3.0 * contact(0.3));
  return world;
}

double gross_slip(double dt) {  // beyond 7/2 mu (1 + e) = 1.4 times the normal speed
  return over_phases(
      [&](double phase) { return thrown(dt, 0.6, phase).velocity(0)[0] / (0.6 - 0.2 * 2.0 * 0.3) - 1.0; });
}

double ends_rolling(double dt) {
  return over_phases([&](double phase) { return rolling(thrown(dt, 0.1, phase)) / (5.0 / 7.0 * 0.1) - 1.0; });
}

double slides_then_rolls(double dt) {
  constexpr double v0 = 0.4, mu = 0.2;
  scene::Scene s = rough(dt, mu);
  s.in.jamming.gravity = gravity;
  s.in.contact.damping_ratio = 0.1;
  World world(s);
  world.add({50.0, 50.0, r - std::pow(weight(s) / wall_stiffness(), 2.0 / 3.0)}, {v0, 0.0, 0.0});
  const double end = 2.0 * v0 / (7.0 * mu * gravity);  // of slip
  world.run(1.2 * end);
  return std::abs(rolling(world) / (5.0 / 7.0 * v0) - 1.0);
}

double column(double dt) {
  constexpr int n = 6;
  scene::Scene s = smooth(dt);
  s.in.jamming.gravity = gravity;
  s.in.contact.damping_ratio = 0.4;
  World world(s);
  for (int i = 0; i < n; ++i) world.add({50.0, 50.0, r * (1.0 + 2.0 * i)}, {});
  world.run(0.5);
  double worst = 0.0;
  for (int i = 0; i + 1 < n; ++i) {
    const double overlap = 2.0 * r - (world.up(i + 1) - world.up(i));
    const double exact = std::pow((n - 1 - i) * weight(s) / pair_stiffness(), 2.0 / 3.0);
    worst = std::max(worst, std::abs(overlap / exact - 1.0));
  }
  return worst;
}

double free_fall(double dt) {  // half of the terminal speed
  scene::Scene s = smooth(dt);
  s.features.drag = true;
  s.in.jamming.gravity = gravity;
  s.in.drag.coefficient = 0.5;
  const double rate = 0.5 / input::mass(s.in.particles, r), time = std::log(2.0) / rate;
  const auto steps = std::ceil(time / dt);
  s.time_step = time / steps;
  World world(s);
  world.add({50.0, 50.0, 50.0}, {});
  world.run(time);
  return std::abs(world.up(0) - 50.0 + gravity / (rate * rate) * (std::log(2.0) - 0.5)) /
         (gravity / (rate * rate) * (std::log(2.0) - 0.5));
}

double terminal_speed(double dt) {
  scene::Scene s = smooth(dt);
  s.features.drag = true;
  s.in.jamming.gravity = gravity;
  s.in.drag.coefficient = 0.5;
  const double rate = 0.5 / input::mass(s.in.particles, r);
  World world(s);
  world.add({50.0, 50.0, 50.0}, {});
  world.run(40.0 / rate);
  return std::abs(world.velocity(0)[2] / (-gravity / rate) - 1.0);
}

/// A layer of spheres without losses that collide in a box: largest departure of the energy, over the energy given.
double ledger(double dt) {
  input::Input in = test::small_input(3, 0.5, 0.02);
  in.particles.youngs_modulus = 1e7;
  in.layers.thickness = 0.2;
  in.layers.fraction = 0.1;
  in.layers.velocity = {0.7, 0.3, -1.0};
  in.contact.damping_ratio = in.contact.friction = in.contact.wall_friction = 0.0;
  in.dynamics.time_step = dt;
  const comm::Comm comm(MPI_COMM_WORLD);
  const scene::Scene scene = scene::build(in);
  run::Bed bed(comm, scene);
  bed.progress.count = rsa::insert(comm, scene, bed.ownership, {0, 0.3, in.layers.thickness, 0}, bed.store).inserted;
  bed.progress.first_ids = {0};
  const double given = observe::energy_of(comm, bed.store, scene, 0, bed.progress.count);
  bed.neighborhood.rebuild(bed.store);
  double worst = 0.0;
  for (int k = 0; k < 40; ++k) {
    bed.stepper.advance(bed.store, bed.neighborhood, std::llround(0.01 / dt));
    const observe::Ledger now = observe::ledger(comm, bed.store, scene, bed.stepper.law(), bed.neighborhood);
    worst = std::max(worst, std::abs(now.kinetic_energy + now.potential_energy + now.elastic_energy - given) / given);
  }
  return worst;
}

using Problem = double (*)(double);

// Steps are `unit` divided by the numbers of the table's head.
void row(const char* name, Problem problem, double unit, const std::vector<double>& parts) {
  std::vector<double> errors;
  for (const double part : parts) errors.push_back(problem(unit / part));
  std::string text = fmt::format("| {} |", name);
  for (const double error : errors) text += fmt::format(" {:.1e} |", error);
  const double first = errors[errors.size() - 3], last = errors.back();
  const double order = std::log(first / last) / std::log(parts.back() / parts[parts.size() - 3]);
  fmt::print("{} {} |\n", text, last > 2e-8 ? fmt::format("{:.2f}", order) : "exact");
}

void exact_problems() {
  const std::vector<double> parts{5.0, 10.0, 20.0, 40.0, 80.0, 160.0};
  fmt::print("| problem | T/5 | T/10 | T/20 | T/40 | T/80 | T/160 | order |\n|---|---|---|---|---|---|---|---|\n");
  const double meet = contact(0.6), fall = contact(0.3), rest = contact(0.6);
  row("Hertz impact of two spheres: largest overlap", hertz_overlap, meet, parts);
  row("the same: speed of separation, elastic", elastic_rebound, meet, parts);
  row("the same, damping ratio 0.1, no cut-off of tension: restitution", restitution, meet, parts);
  row("oblique impact on the floor in gross slip: lateral speed", gross_slip, fall, parts);
  row("steep oblique impact that ends rolling: spin", ends_rolling, fall, parts);
  row("sliding on the floor until it rolls: spin", slides_then_rolls, rest, parts);
  row("column of six under gravity: worst overlap", column, rest, parts);
  row("fall with drag to half the terminal speed (T = 10 ms): distance", free_fall, 0.01, parts);
  row("the same: terminal speed", terminal_speed, 0.01, parts);
  row("75 lossless spheres in a box (T = 0.5 ms): largest drift of the energy", ledger, 5e-4, parts);
}

// A loose layer falls, and comes to rest in steps of `factor` times what time_step = "auto" gives. Valid: no guard
// speaks, and the energy, of which damping takes, never rises by a hundredth of what was given.
bool is_valid(const input::Input& in, double factor) {
  const comm::Comm comm(MPI_COMM_WORLD);
  const scene::Scene scene = scene::build(in);
  run::Bed bed(comm, scene);
  bed.progress.count = rsa::insert(comm, scene, bed.ownership, {0, 0.0, in.layers.thickness, 0}, bed.store).inserted;
  bed.progress.first_ids = {0};
  const double given = observe::energy_of(comm, bed.store, scene, 0, bed.progress.count);
  bed.neighborhood.rebuild(bed.store);
  const double step = factor * scene.time_step;
  bed.stepper.use({step, in.particles.youngs_modulus});
  const double fall = std::sqrt(2.0 * in.layers.thickness / in.jamming.gravity);
  constexpr int looks = 20;
  double before = given;
  try {
    for (int k = 0; k < looks; ++k) {
      bed.stepper.advance(bed.store, bed.neighborhood, std::llround(2.0 * fall / looks / step));
      const observe::Ledger now = observe::ledger(comm, bed.store, scene, bed.stepper.law(), bed.neighborhood);
      const double energy = now.kinetic_energy + now.potential_energy + now.elastic_energy;
      if (!(energy < before + 0.01 * given)) return false;
      before = energy;
    }
  } catch (const Error&) {
    return false;
  }
  return true;
}

void guard_row(const input::Input& in, const std::string& name) {
  double valid = 0.0, broken = 0.0;
  for (const double factor : {1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.25, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0}) {
    if (!is_valid(in, factor)) {
      broken = factor;
      break;
    }
    valid = factor;
  }
  const scene::Scene scene = scene::build(in);
  fmt::print("| {} | {:.2e} | {:.2e} | {:g} | {} |\n", name, scene.time_step, valid * scene.time_step, valid,
             broken > 0.0 ? fmt::format("{:g}", broken) : "none tried");
}

input::Input falling(double modulus) {
  input::Input in = test::small_input(3, 0.2, 0.01);
  in.particles.youngs_modulus = modulus;
  in.layers.thickness = 0.1;
  in.dynamics.time_step.reset();
  return in;
}

void guard_study() {
  fmt::print("| scene | \"auto\", s | still valid, s | times \"auto\" | broken at |\n|---|---|---|---|---|\n");
  for (const double modulus : {1e6, 1e7, 1e8, 1e9, 1e10}) {
    guard_row(falling(modulus), fmt::format("equal, E {:.0e} Pa", modulus));
  }
  for (const double ratio : {2.0, 5.0, 10.0, 20.0}) {
    input::Input in = falling(1e8);
    input::Radius& radius = in.particles.radius;
    radius.distribution = input::SizeDistribution::bidisperse;
    radius.small = 0.02 / ratio;
    radius.large = 0.02;
    radius.large_share = ratio > 2.0 ? 0.04 : 0.5;  // by number
    guard_row(in, fmt::format("radii 1:{:g}, E 1e+08 Pa", ratio));
  }
}

}  // namespace
}  // namespace packmpi

int main(int argc, char** argv) {
  const packmpi::comm::Session session(argc, argv);
  const std::string what = argc > 1 ? argv[1] : "";
  what == "guard" ? packmpi::guard_study() : packmpi::exact_problems();
}
