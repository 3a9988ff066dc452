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
};

struct Quanta {
  std::array<std::int64_t, 3> force{}, moment{};
};

struct Effect {
  Vec3 force{}, moment{};
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

/// What a contact is given: u is the velocity of the second relative to the first, s the sum of their r omega.
struct Meeting {
  double reduced_radius, reduced_mass;
  Vec3 n;
  double overlap;
  Vec3 u, s;
};

Effect contact(const Features& f, const StepData& data, const LawConstants& c, const Meeting& at) {
  const dynamics::Law& law = data.law;
  const auto& [reduced_radius, reduced_mass, n, overlap, u, s] = at;
  const double spin_slip = law.spin_slip;
  const double slip_rate = law.slip_mass * law.slip_rate;
  const double rate = -dot(u, n, f.dimension);
  const double t = std::sqrt(reduced_radius * overlap);
  double normal = c.stiffness * t * overlap + c.damping * std::sqrt(reduced_mass * t) * rate;
  normal = std::max(normal, law.lowest_force);
  Vec3 friction{}, moment{};
  const bool rubs = f.friction || f.rotation;
  const double sliding = c.friction * std::fabs(normal);
  if (rubs && f.dimension == 2) {  // along (-n_y, n_x)
    const double slip = u[1] * n[0] - u[0] * n[1] - (f.rotation ? spin_slip * s[2] : 0.0);
    const double stopping = slip_rate * reduced_mass * std::fabs(slip);
    moment[2] = std::copysign(std::min(sliding, stopping), slip);
    friction = {-(moment[2] * n[1]), moment[2] * n[0], 0.0};
  }
  if (rubs && f.dimension == 3) {
    const Vec3 turning = cross(s, n);
    Vec3 slip;
    for (std::size_t a = 0; a < 3; ++a) {
      slip[a] = u[a] + rate * n[a];
      if (f.rotation) slip[a] -= spin_slip * turning[a];
    }
    const double stopping = slip_rate * reduced_mass;
    const double slope = std::min(sliding / std::sqrt(dot(slip, slip, 3) + tiny), stopping);
    for (std::size_t a = 0; a < 3; ++a) friction[a] = slope * slip[a];
    moment = cross(n, friction);
  }
  Effect e{.force = {}, .moment = moment, .normal = normal};
  for (std::size_t a = 0; a < 3; ++a) e.force[a] = friction[a] - normal * n[a];
  return e;
}

std::pair<Vec3, double> normal_of(const Vec3& x, int dimension) {
  const double distance = std::sqrt(dot(x, x, dimension) + tiny);
  const double inverse = 1.0 / distance;
  return {{x[0] * inverse, x[1] * inverse, x[2] * inverse}, distance};
}

Effect pair_effect(const Features& f, const StepData& data, const Grain& i, const Grain& j) {
  Vec3 x{}, u{}, s{};
  for (std::size_t a = 0; a < 3; ++a) {
    x[a] = j.x[a] - i.x[a];
    u[a] = j.v[a] - i.v[a];
    s[a] = j.s[a] + i.s[a];
    if (a < 2 && static_cast<int>(a) < f.dimension - 1 && f.periodic && data.periodic[a]) {
      x[a] = geometry::shortest(x[a], data.size[a]);
    }
  }
  const auto [n, distance] = normal_of(x, f.dimension);
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
  const double overlap = std::max(j.r + i.r - distance, 0.0);
  return contact(f, data, data.law.pair, {reduced_radius, reduced_mass, n, overlap, u, s});
}

Effect wall_effect(const Features& f, const StepData& data, const Grain& i, neighbor::Wall wall) {
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
  }
  double reduced_radius = data.law.wall.reduced_radius;
  double reduced_mass = data.law.wall.reduced_mass;
  if (f.graded) {
    const double k = i.k;
    reduced_radius = i.r;
    reduced_mass = 1.0 / (data.law.mass_factor * k * k * k);
  }
  const Vec3 u = {-i.v[0], -i.v[1], -i.v[2]};
  const double overlap = std::max(i.r - distance, 0.0);
  return contact(f, data, data.law.wall, {reduced_radius, reduced_mass, n, overlap, u, i.s});
}

/// `sign`: 1 for the first end, -1 for the second.
void add(Quanta& sum, const Effect& e, double quantum, std::int64_t sign) {
  for (std::size_t a = 0; a < 3; ++a) {
    sum.force[a] += sign * std::llrint(e.force[a] / quantum);
    sum.moment[a] += std::llrint(e.moment[a] / quantum);
  }
}

void advance(const Features& f, const StepData& data, const Quanta& sum, Grain& g) {
  const double inverse_mass = f.graded ? data.law.mass_factor * g.k * g.k * g.k : 1.0 / data.law.wall.reduced_mass;
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
double add_contacts(const Features& features, const StepData& data, std::vector<Quanta>& sums) {
  double force = 0.0;
  for (std::int64_t p = 0; p < data.pairs; ++p) {
    const auto i = static_cast<std::size_t>(data.first[p]);
    const auto j = static_cast<std::size_t>(data.second[p]);
    const Effect e =
        pair_effect(features, data, read(features, data, data.first[p]), read(features, data, data.second[p]));
    add(sums[i], e, data.force_quantum, 1);
    if (j < sums.size()) add(sums[j], e, data.force_quantum, -1);
    force = std::max(force, std::fabs(e.normal));
  }
  for (std::int64_t w = 0; w < data.walls; ++w) {
    const LocalIndex i = data.wall_particle[w];
    const Effect e = wall_effect(features, data, read(features, data, i), data.wall[w]);
    add(sums[static_cast<std::size_t>(i)], e, data.force_quantum, 1);
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
