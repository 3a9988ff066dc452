#include "support/oracle_step.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "geometry/container.hpp"

namespace packmpi::oracle {
namespace {

using dynamics::LawConstants;
using dynamics::StepData;
using scene::Features;

struct Grain {
  Vec3 x{}, v{}, s{};  // s = r omega; in the plane only s[2]
  double r = 0.0, k = 0.0;
  double code = 0.0, inverse_mass = 0.0;  // of several components
};

struct Quanta {
  std::array<std::int64_t, 3> force{}, moment{};
};

/// Force on the first, moment over radius on both, torque on the first and its negative on the second.
struct Effect {
  Vec3 force{}, moment{}, torque{};
  double normal = 0.0;
};

constexpr double tiny = 1e-300;

double dot(const Vec3& a, const Vec3& b, int dimension) {
  double sum = a[0] * b[0] + a[1] * b[1];
  if (dimension == 3) sum += a[2] * b[2];
  return sum;
}

Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Grain read(const Features& features, const StepData& data, LocalIndex i) {
  const particles::Layout layout = features.layout();
  const double* p = data.records + static_cast<std::ptrdiff_t>(i) * layout.stride;
  Grain g;
  for (int a = 0; a < layout.dimension; ++a) {
    g.x[static_cast<std::size_t>(a)] = p[layout.position + a];
    g.v[static_cast<std::size_t>(a)] = p[layout.velocity + a];
  }
  g.r = p[layout.radius];
  g.k = p[layout.curvature];
  if (features.mixture) g.code = p[layout.component], g.inverse_mass = p[layout.component + 1];
  if (layout.rotation && layout.dimension == 3) g.s = {p[layout.spin], p[layout.spin + 1], p[layout.spin + 2]};
  if (layout.rotation && layout.dimension == 2) g.s[2] = p[layout.spin];
  return g;
}

void write(const Features& features, const StepData& data, LocalIndex i, const Grain& g) {
  const particles::Layout layout = features.layout();
  double* p = data.records + static_cast<std::ptrdiff_t>(i) * layout.stride;
  for (int a = 0; a < layout.dimension; ++a) {
    p[layout.position + a] = g.x[static_cast<std::size_t>(a)];
    p[layout.velocity + a] = g.v[static_cast<std::size_t>(a)];
  }
  if (layout.rotation && layout.dimension == 3) std::copy(g.s.begin(), g.s.end(), p + layout.spin);
  if (layout.rotation && layout.dimension == 2) p[layout.spin] = g.s[2];
}

/// What a contact remembers, as rows of numbers: slip, then rolling, then twisting.
struct Springs {
  Vec3 slip{}, roll{};
  double twist = 0.0;
};

/// What a contact is given: u is the velocity of the second relative to the first, s the sum of their r omega, spin
/// omega of the second minus omega of the first.
struct Meeting {
  double reduced_radius, reduced_mass;
  Vec3 n;
  double distance;  // of the centres; infinite at a wall
  double overlap;
  Vec3 u, s, spin;
};

/// So small a drag stands for none.
constexpr double tiny_drag = 1e-100;

/// Where a stored vector is now: in the tangent plane, as long as before times what loading or unloading leaves of it.
Vec3 turn(const Vec3& stored, const Vec3& n, double kept, double overlap) {
  const double off = dot(stored, n, 3);
  Vec3 flat{};
  for (std::size_t a = 0; a < 3; ++a) flat[a] = stored[a] + -off * n[a];
  const double square = 4.0 * dot(flat, flat, 3);
  const double part = (square + 3.0 * (off * off)) * (2.0 * kept) / ((square + off * off) * (overlap + kept) + tiny);
  for (double& x : flat) x = part * x;
  return flat;
}

/// Spring and dashpot in parallel, a slider of `limit` behind them. Advances the spring and returns its pull.
Vec3 drag_along(Vec3& spring, const Vec3& u, double k, double h, double dt, double limit) {
  Vec3 elastic{}, force{};
  for (std::size_t a = 0; a < 3; ++a) {
    elastic[a] = k * spring[a];
    force[a] = elastic[a] + h * u[a];
  }
  const double strength = std::sqrt(dot(force, force, 3) + tiny);
  const double inverse = 1.0 / (strength * (h + tiny_drag));
  const double share = limit * ((h + tiny_drag) * inverse);
  for (double& x : force) x = std::min(1.0, share) * x;
  for (std::size_t a = 0; a < 3; ++a) spring[a] += dt * (strength * inverse) * (force[a] + -1.0 * elastic[a]);
  return force;
}
double drag_along(double& spring, double u, double k, double h, double dt, double limit) {
  const double elastic = k * spring;
  const double trial = elastic + h * u;
  const double force = std::copysign(std::min(std::fabs(trial), limit), trial);
  spring += dt / (h + tiny_drag) * (force - elastic);
  return force;
}

/// Friction, moment and torque of a contact with memory.
void remember(const Features& f, const StepData& data, const LawConstants& c, const Meeting& at, double normal,
              Springs& springs, Effect& e) {
  const double dt = data.time_step;
  const double rate = -dot(at.u, at.n, f.dimension);
  const double area = std::sqrt(at.reduced_radius * at.overlap);
  const double k = c.shear_stiffness * area;
  const double h = k * dt + c.shear_damping * std::sqrt(at.reduced_mass * area);
  const double limit = std::fabs(normal);
  const double bend = 1.0 / at.distance;
  const auto kept = [&](double drift) {
    return std::min(at.overlap, std::max(0.0, at.overlap - dt * (rate + 0.5 * dt * bend * drift)));
  };
  if (f.dimension == 2) {
    const double across = at.u[1] * at.n[0] - at.u[0] * at.n[1];
    const double slip = f.rotation ? across - data.law.spin_slip * at.s[2] : across;
    const double left = kept(across * across);
    const double part = 2.0 * left / (at.overlap + left + tiny);
    springs.slip[0] *= part;
    e.moment[2] = drag_along(springs.slip[0], slip, k, h, dt, c.friction * limit);
    e.force = {-(e.moment[2] * at.n[1]), e.moment[2] * at.n[0], 0.0};
    if (!f.rolling) return;
    springs.roll[0] *= part;
    e.torque[2] = at.reduced_radius *
                  drag_along(springs.roll[0], at.reduced_radius * at.spin[2], k, h, dt, c.rolling_friction * limit);
    return;
  }
  Vec3 across{}, slip{};
  const Vec3 surface = cross(at.s, at.n);
  for (std::size_t a = 0; a < 3; ++a) {
    across[a] = at.u[a] + rate * at.n[a];
    slip[a] = f.rotation ? across[a] + -data.law.spin_slip * surface[a] : across[a];
  }
  const double left = kept(dot(across, across, 3));
  springs.slip = turn(springs.slip, at.n, left, at.overlap);
  e.force = drag_along(springs.slip, slip, k, h, dt, c.friction * limit);
  e.moment = cross(at.n, e.force);
  if (!f.rolling) return;
  const double about = dot(at.spin, at.n, 3);
  Vec3 rolling{};
  for (std::size_t a = 0; a < 3; ++a) rolling[a] = at.reduced_radius * (at.spin[a] + -about * at.n[a]);
  springs.roll = turn(springs.roll, at.n, left, at.overlap);
  springs.twist *= 2.0 * left / (at.overlap + left + tiny);
  const Vec3 against_rolling = drag_along(springs.roll, rolling, k, h, dt, c.rolling_friction * limit);
  const double against_twist =
      drag_along(springs.twist, at.reduced_radius * about, k, h, dt, c.twisting_friction * limit);
  for (std::size_t a = 0; a < 3; ++a) {
    e.torque[a] = at.reduced_radius * (against_rolling[a] + against_twist * at.n[a]);
  }
}

/// Friction and moment of a contact without.
void rub(const Features& f, const StepData& data, const LawConstants& c, const Meeting& at, double normal, Effect& e) {
  const dynamics::Law& law = data.law;
  const auto& [reduced_radius, reduced_mass, n, distance, overlap, u, s, spin] = at;
  const double slip_rate = law.slip_mass * law.slip_rate;
  const double rate = -dot(u, n, f.dimension);
  const double sliding = c.friction * std::fabs(normal);
  if (f.dimension == 2) {  // along (-n_y, n_x)
    const double slip = u[1] * n[0] - u[0] * n[1] - (f.rotation ? law.spin_slip * s[2] : 0.0);
    const double stopping = slip_rate * reduced_mass * std::fabs(slip);
    e.moment[2] = std::copysign(std::min(sliding, stopping), slip);
    e.force = {-(e.moment[2] * n[1]), e.moment[2] * n[0], 0.0};
    return;
  }
  const Vec3 turning = cross(s, n);
  Vec3 slip{};
  for (std::size_t a = 0; a < 3; ++a) {
    slip[a] = u[a] + rate * n[a];
    if (f.rotation) slip[a] -= law.spin_slip * turning[a];
  }
  const double stopping = slip_rate * reduced_mass;
  const double slope = std::min(sliding / std::sqrt(dot(slip, slip, 3) + tiny), stopping);
  for (std::size_t a = 0; a < 3; ++a) e.force[a] = slope * slip[a];
  e.moment = cross(n, e.force);
}

Effect contact(const Features& f, const StepData& data, const LawConstants& c, const Meeting& at, Springs& springs) {
  const double rate = -dot(at.u, at.n, f.dimension);
  const double t = std::sqrt(at.reduced_radius * at.overlap);
  const double normal =
      std::max(c.stiffness * t * at.overlap + c.damping * std::sqrt(at.reduced_mass * t) * rate, data.law.lowest_force);
  Effect e;
  e.normal = normal;
  if (f.memory) {
    remember(f, data, c, at, normal, springs, e);
  } else if (f.friction || f.rotation) {
    rub(f, data, c, at, normal, e);
  }
  for (std::size_t a = 0; a < 3; ++a) e.force[a] -= normal * at.n[a];
  return e;
}

Effect pair_effect(const Features& f, const StepData& data, const Grain& i, const Grain& j, Springs& springs) {
  Vec3 x{}, u{}, s{}, spin{};
  for (std::size_t a = 0; a < 3; ++a) {
    x[a] = j.x[a] - i.x[a];
    u[a] = j.v[a] - i.v[a];
    s[a] = j.s[a] + i.s[a];
    spin[a] = 1.0 / data.law.wall.reduced_radius * (j.s[a] - i.s[a]);
    if (f.graded) spin[a] = 0.5 * (j.k + i.k) * (j.s[a] - i.s[a]) + 0.5 * (j.k - i.k) * s[a];
    if (a < 2 && static_cast<int>(a) < f.dimension - 1 && f.periodic && data.periodic[a]) {
      x[a] = geometry::shortest(x[a], data.size[a]);
    }
  }
  const double distance = std::sqrt(dot(x, x, f.dimension) + tiny);
  const double inverse = 1.0 / distance;
  const Vec3 n = {x[0] * inverse, x[1] * inverse, x[2] * inverse};
  double reduced_radius = data.law.pair.reduced_radius;
  double reduced_mass = data.law.pair.reduced_mass;
  if (f.graded) {
    const double k = j.k + i.k;
    const double r = j.r + i.r;
    const double a = data.law.mass_factor * k * k * (k * r - 3.0);
    const double b = 1.0 / (a * k);
    reduced_radius = a * b;
    reduced_mass = r * k * b;
  }
  if (f.mixture) {
    const double w = j.inverse_mass + i.inverse_mass;
    const double b = 1.0 / ((j.k + i.k) * w);
    reduced_radius = w * b;
    reduced_mass = (j.k + i.k) * b;
  }
  const LawConstants& constants = f.mixture ? data.law.pair_table[static_cast<int>(i.code + j.code)] : data.law.pair;
  const double overlap = std::max(j.r + i.r - distance, 0.0);
  return contact(f, data, constants, {reduced_radius, reduced_mass, n, distance, overlap, u, s, spin}, springs);
}

Effect wall_effect(const Features& f, const StepData& data, const Grain& i, std::int64_t entry, Springs& springs) {
  const neighbor::Wall wall = data.wall[entry];
  const auto up = static_cast<std::size_t>(f.dimension - 1);
  Vec3 n{};
  double distance = 0.0;
  switch (wall) {
    case neighbor::Wall::floor:
      n[up] = -1.0, distance = i.x[up];
      break;
    case neighbor::Wall::x_low:
      n[0] = -1.0, distance = i.x[0];
      break;
    case neighbor::Wall::x_high:
      n[0] = 1.0, distance = data.size[0] - i.x[0];
      break;
    case neighbor::Wall::y_low:
      n[1] = -1.0, distance = i.x[1];
      break;
    case neighbor::Wall::y_high:
      n[1] = 1.0, distance = data.size[1] - i.x[1];
      break;
    case neighbor::Wall::lid:
      n[up] = 1.0, distance = data.planes[5].offset - i.x[up];
      break;
    case neighbor::Wall::mantle:
    case neighbor::Wall::inner:
    case neighbor::Wall::collar: {
      const geometry::RoundWall& round = data.round[static_cast<std::size_t>(wall) - geometry::most_planes];
      double square = 0.0, lean = 0.0;
      for (std::size_t a = 0; a <= up; ++a) {
        square += round.weight[a] * ((i.x[a] - round.centre[a]) * (i.x[a] - round.centre[a]));
        lean += round.lean[a] * i.x[a];
      }
      const double rho = std::sqrt(square + tiny);
      for (std::size_t a = 0; a <= up; ++a) {
        n[a] = round.radial * (round.weight[a] * ((i.x[a] - round.centre[a]) * (1.0 / rho))) + round.lean[a];
      }
      distance = round.offset - round.radial * rho - lean;
      break;
    }
    default:
      n = data.facing[entry].normal, distance = data.facing[entry].distance;
  }
  double reduced_radius = data.law.wall.reduced_radius;
  double reduced_mass = data.law.wall.reduced_mass;
  if (f.graded) {
    reduced_radius = i.r;
    reduced_mass = 1.0 / (data.law.mass_factor * i.k * i.k * i.k);
  }
  if (f.mixture) reduced_mass = 1.0 / i.inverse_mass;
  const LawConstants& constants = f.mixture ? data.law.wall_table[static_cast<int>(i.code)] : data.law.wall;
  const double k = f.graded ? i.k : 1.0 / data.law.wall.reduced_radius;
  const Vec3 u = {-i.v[0], -i.v[1], -i.v[2]};
  const Vec3 spin = {-(k * i.s[0]), -(k * i.s[1]), -(k * i.s[2])};
  const double overlap = std::max(i.r - distance, 0.0);
  return contact(f, data, constants, {reduced_radius, reduced_mass, n, HUGE_VAL, overlap, u, i.s, spin}, springs);
}

/// `sign`: 1 for the first end, -1 for the second; k: its 1/r.
void add(Quanta& sum, const Effect& e, double quantum, int sign, double k) {
  for (std::size_t a = 0; a < 3; ++a) {
    sum.force[a] += sign * std::llrint(e.force[a] / quantum);
    sum.moment[a] += std::llrint((e.moment[a] + sign * (e.torque[a] * k)) / quantum);
  }
}

/// What entry `at` of a list has stored, in the order of the law's rows; and back.
Springs stored_at(const Features& f, const dynamics::StoredVectors& from, std::int64_t at) {
  Springs s;
  if (!f.memory) return s;
  const auto value = [&](int c) { return from.values[c * from.entries + at]; };
  if (f.dimension == 2) {
    s.slip[0] = value(0);
    if (f.rolling) s.roll[0] = value(1);
    return s;
  }
  s.slip = {value(0), value(1), value(2)};
  if (f.rolling) s.roll = {value(3), value(4), value(5)}, s.twist = value(6);
  return s;
}
void store_at(const Features& f, const Springs& s, const dynamics::StoredVectors& to, std::int64_t at) {
  if (!f.memory) return;
  std::vector<double> values = {s.slip[0], s.slip[1], s.slip[2], s.roll[0], s.roll[1], s.roll[2], s.twist};
  if (f.dimension == 2) values = {s.slip[0], s.roll[0]};
  const std::size_t count = f.dimension == 2 ? (f.rolling ? 2 : 1) : (f.rolling ? 7 : 3);
  for (std::size_t c = 0; c < count; ++c) to.values[static_cast<std::int64_t>(c) * to.entries + at] = values[c];
}

void advance(const Features& f, const StepData& data, const Quanta& sum, Grain& g) {
  const double inverse_mass = f.mixture  ? g.inverse_mass
                              : f.graded ? data.law.mass_factor * g.k * g.k * g.k
                                         : 1.0 / data.law.wall.reduced_mass;
  for (std::size_t a = 0; a < static_cast<std::size_t>(f.dimension); ++a) {
    double force = static_cast<double>(sum.force[a]) * data.force_quantum;
    if (f.drag) force -= data.drag * (g.v[a] - data.fluid_velocity[a]);
    g.v[a] += data.time_step * (force * inverse_mass + data.gravity[a]);
    g.x[a] += data.time_step * g.v[a];
    const bool lateral = a < 2 && static_cast<int>(a) < f.dimension - 1;
    if (lateral && f.periodic && data.periodic[a]) g.x[a] = geometry::wrap(g.x[a], data.size[a]);
  }
  if (!f.rotation) return;
  for (std::size_t a = 0; a < 3; ++a) {
    g.s[a] += data.time_step * (static_cast<double>(sum.moment[a]) * data.force_quantum * (2.5 * inverse_mass));
  }
}

/// What the accumulators hold before the contacts: the near field, when they have room for every particle.
void add_prefilled(const Features& f, const StepData& data, std::vector<Quanta>& sums) {
  if (data.ring_mask + 1 < data.owned) return;
  const int each = dynamics::accumulators_of(f.layout());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    for (std::size_t a = 0; a < static_cast<std::size_t>(f.dimension); ++a) {
      sums[i].force[a] += data.ring[i * static_cast<std::size_t>(each) + a];
    }
  }
}

/// Contacts of pairs and walls, summed. The largest normal force.
double add_contacts(const Features& f, const StepData& data, std::vector<Quanta>& sums) {
  double force = 0.0;
  const double k = 1.0 / data.law.wall.reduced_radius;  // of equal particles
  for (std::int64_t p = 0; p < data.pairs; ++p) {
    const auto i = static_cast<std::size_t>(data.first[p]);
    const auto j = static_cast<std::size_t>(data.second[p]);
    const Grain first = read(f, data, data.first[p]);
    const Grain second = read(f, data, data.second[p]);
    Springs springs = stored_at(f, data.stored_pairs, p);
    const Effect e = pair_effect(f, data, first, second, springs);
    store_at(f, springs, data.stored_pairs, p);
    add(sums[i], e, data.force_quantum, 1, f.graded ? 0.5 * ((second.k + first.k) - (second.k - first.k)) : k);
    if (j < sums.size()) {
      add(sums[j], e, data.force_quantum, -1, f.graded ? 0.5 * ((second.k + first.k) + (second.k - first.k)) : k);
    }
    force = std::max(force, std::fabs(e.normal));
  }
  for (std::int64_t w = 0; w < data.walls; ++w) {
    const LocalIndex i = data.wall_particle[w];
    const Grain grain = read(f, data, i);
    Springs springs = stored_at(f, data.stored_walls, w);
    const Effect e = wall_effect(f, data, grain, w, springs);
    store_at(f, springs, data.stored_walls, w);
    add(sums[static_cast<std::size_t>(i)], e, data.force_quantum, 1, f.graded ? grain.k : k);
    force = std::max(force, std::fabs(e.normal));
  }
  return force;
}

}  // namespace

dynamics::StepReport step(const Features& features, const StepData& data) {
  std::vector<Quanta> sums(static_cast<std::size_t>(data.owned));
  add_prefilled(features, data, sums);
  const double force = add_contacts(features, data, sums);
  Vec3 fastest{};
  for (LocalIndex i = 0; i < data.owned; ++i) {
    Grain g = read(features, data, i);
    advance(features, data, sums[static_cast<std::size_t>(i)], g);
    write(features, data, i, g);
    for (std::size_t a = 0; a < 3; ++a) fastest[a] = std::max(fastest[a], std::fabs(g.v[a]));
  }
  return {std::sqrt(dot(fastest, fastest, features.dimension)), force, true};
}

}  // namespace packmpi::oracle
