#include "support/cloud.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "geometry/container.hpp"
#include "mesh/shapes.hpp"
#include "scene/mixture.hpp"
#include "scene/pair_channels.hpp"

namespace packmpi::support {
namespace {

constexpr double radius = 0.02;  // [m] of equal particles

/// Of two and three components, that is of their codes 0, 1 and 3: each pair has constants of its own.
void add_components(const scene::Features& features, Dice& dice, dynamics::Law& law) {
  auto tables = std::make_shared<std::vector<dynamics::LawConstants>>(
      static_cast<std::size_t>(scene::pair_codes + scene::wall_codes), law.pair);
  for (dynamics::LawConstants& c : *tables) {
    c.stiffness *= dice(0.1, 1.0), c.damping *= dice(0.1, 1.0), c.friction *= dice();
    c.shear_stiffness *= dice(0.1, 1.0), c.shear_damping *= dice();
    if (features.rolling) c.rolling_friction *= dice(), c.twisting_friction *= dice();
  }
  law.pair_table = tables->data();
  law.wall_table = tables->data() + scene::pair_codes;
  law.tables = tables;
}

dynamics::Law random_law(const scene::Features& features, Dice& dice) {
  dynamics::Law law{};
  const double modulus = 1e6;
  law.mass_factor = 3.0 / (4.0 * 3.141592653589793 * 1000.0);
  const double mass = 1.0 / (law.mass_factor / (radius * radius * radius));
  law.pair = {4.0 / 3.0 * modulus, 2.0 * 0.1 * std::sqrt(2.0 * modulus), dice(0.1, 0.6), 0.5 * radius, 0.5 * mass};
  law.wall = {8.0 / 3.0 * modulus, 2.0 * 0.1 * std::sqrt(4.0 * modulus), dice(0.1, 0.6), radius, mass};
  law.spin_slip = dice() < 0.7 ? 1.0 : 0.0;
  law.slip_rate = dice() < 0.7 ? 1e4 : 1e150;
  law.slip_mass = dice() < 0.7 ? 2.0 / 7.0 : 1.0;
  law.lowest_force = dice() < 0.7 ? 0.0 : -HUGE_VAL;
  for (dynamics::LawConstants* c : {&law.pair, &law.wall}) {
    if (!features.memory) continue;
    c->shear_stiffness = 1.3 * c->stiffness;
    c->shear_damping = 2.0 * 0.1 * std::sqrt(c->shear_stiffness * law.slip_mass);
    if (features.rolling) c->rolling_friction = dice(0.0, 0.2), c->twisting_friction = dice(0.0, 0.1);
  }
  if (features.mixture) add_components(features, dice, law);
  return law;
}

}  // namespace

Cloud::Cloud(const scene::Features& f, const CloudPlan& p) : features(f), plan(p) {
  Dice dice(plan.seed);
  law = random_law(features, dice);
  drag = features.drag ? 0.05 : 0.0;
  if (features.periodic) periodic = {true, f.dimension == 3 && dice() < 0.5};
  if (features.periodic && f.dimension == 3 && dice() < 0.3) periodic = {false, true};
  const double count = plan.owned + plan.ghosts;  // an edge that packs them tightly
  const double edge = 1.7 * radius * (f.dimension == 3 ? std::cbrt(count) : std::sqrt(count)) + 4.0 * radius;
  size = {edge, f.dimension == 3 ? edge : 0.0, 0.0};
  if (plan.mesh && f.dimension == 3 && !f.periodic) {
    testing::Soup soup = testing::box({0, 0, 0}, {edge, edge, edge}, 3);
    for (const mesh::Corners& corners :
         testing::box({0.3 * edge, 0.35 * edge, 0.4 * edge}, {0.6 * edge, 0.6 * edge, 0.6 * edge}, 2)) {
      soup.push_back(corners);  // looks outside, and is turned: a hole
    }
    interior = std::make_shared<const mesh::Surface>(soup, "interior");
  }
  fill(dice);
  list(dice);
  make_ring(dice);
  remember(dice);
}

void Cloud::fill(Dice& dice) {
  const particles::Layout layout = features.layout();
  const LocalIndex total = plan.owned + plan.ghosts;
  const double poison = std::numeric_limits<double>::quiet_NaN();  // in every place that holds no state
  records.assign(static_cast<std::size_t>(total) * static_cast<std::size_t>(layout.stride) + 8, poison);
  for (LocalIndex i = 0; i < total; ++i) {
    double* p = records.data() + static_cast<std::ptrdiff_t>(i) * layout.stride;
    const double r = features.graded ? radius * dice(0.5, 1.5) : radius;
    for (int a = 0; a < layout.dimension; ++a) {
      const bool wraps = a < layout.dimension - 1 && periodic[static_cast<std::size_t>(a)];
      p[a] = wraps ? dice(0.0, size[0]) : dice(-0.3 * radius, size[0] + 0.3 * radius);  // some beyond the walls
      p[layout.velocity + a] = dice(-1.0, 1.0);
    }
    if (plan.round &&
        !features.periodic) {  // those outside the mantle come in, some as far as to be a little behind it
      const double rho = std::hypot(p[0] - 0.5 * size[0], p[1] - 0.5 * size[0]);
      const double wall = 0.5 * size[0] + 0.3 * radius;
      const double scale = rho > wall ? wall * std::sqrt(dice()) / rho : 1.0;
      for (int a = 0; a < 2; ++a) p[a] = 0.5 * size[0] + scale * (p[a] - 0.5 * size[0]);
    }
    p[layout.radius] = r;
    p[layout.curvature] = 1.0 / r;
    for (int a = 0; a < layout.spin_components(); ++a) p[layout.spin + a] = dice(-1.0, 1.0);
    if (dice() < 0.1) std::fill_n(p + layout.velocity, layout.dimension, 0.0);
    if (layout.component >= 0) {
      p[layout.component] = scene::code_of(static_cast<int>(dice.below(3)));
      p[layout.component + 1] = law.mass_factor / (r * r * r) * dice(0.2, 1.0);
    }
    ids.push_back(i);
  }
}

void Cloud::list(Dice& dice) {
  const int dimension = features.dimension;
  const LocalIndex total = plan.owned + plan.ghosts;
  const double margin = plan.skin * radius;
  for (LocalIndex i = 0; i < plan.owned; ++i) {
    const double* a = record(i);
    const double r = a[features.layout().radius];
    const auto begin = static_cast<std::ptrdiff_t>(pairs.second.size());
    for (LocalIndex j = i + 1; j < total; ++j) {
      if (j < plan.owned && j - i >= plan.window) continue;
      double square = 0.0;
      for (int axis = 0; axis < dimension; ++axis) {
        const bool wraps = axis < dimension - 1 && periodic[static_cast<std::size_t>(axis)];
        const double d = record(j)[axis] - a[axis];
        square += wraps ? std::pow(geometry::shortest(d, size[0]), 2) : d * d;
      }
      if (std::sqrt(square) > r + record(j)[features.layout().radius] + margin) continue;
      pairs.first.push_back(i);
      pairs.second.push_back(j);
      if (j < plan.owned) pairs.window = std::max(pairs.window, j - i + 1);
    }
    for (auto end = pairs.second.end(); end - pairs.second.begin() > begin + 1; --end) {  // any order will do
      const auto count = static_cast<std::uint64_t>(end - pairs.second.begin() - begin);
      std::iter_swap(end - 1, pairs.second.begin() + begin + static_cast<std::ptrdiff_t>(dice.below(count)));
    }
    const auto near = [&](double distance, neighbor::Wall wall) {
      if (distance > r + margin) return;
      walls.particle.push_back(i);
      walls.wall.push_back(wall);
    };
    if (interior) {
      mesh::NearFeatures found;
      interior->near({a[0], a[1], a[2]}, r + margin, 0.25 * radius, found);
      for (const std::int32_t feature : found.feature) {
        near(0.0, static_cast<neighbor::Wall>(static_cast<std::int32_t>(geometry::most_surfaces) + feature));
        const mesh::Touch at = interior->touch_of(feature, {a[0], a[1], a[2]}, 0.25 * radius);
        walls.facing.push_back({at.distance, {at.normal[0], at.normal[1], at.normal[2]}});
      }
      continue;
    }
    near(a[dimension - 1], neighbor::Wall::floor);
    if (plan.round && !features.periodic) {
      for (std::size_t k = 0; k < geometry::most_round; ++k) {
        near(round_walls()[k].facing({a[0], a[1], dimension == 3 ? a[2] : 0.0}).distance,
             static_cast<neighbor::Wall>(geometry::most_planes + k));
      }
      continue;
    }
    if (!periodic[0]) near(a[0], neighbor::Wall::x_low), near(size[0] - a[0], neighbor::Wall::x_high);
    if (dimension == 3 && !periodic[1]) near(a[1], neighbor::Wall::y_low), near(size[1] - a[1], neighbor::Wall::y_high);
  }
}

void Cloud::make_ring(Dice& dice) {
  const auto window = static_cast<std::uint64_t>(static_cast<double>(pairs.window) * plan.ring_slack);
  const std::uint64_t slots =
      std::bit_ceil(plan.near_field ? std::max(window, static_cast<std::uint64_t>(plan.owned)) : window);
  const auto each = static_cast<std::uint64_t>(dynamics::accumulators_of(features.layout()));
  ring_mask = static_cast<std::int64_t>(slots) - 1;
  ring.assign((slots + 1) * each / 8 + 1, {});
  if (!plan.near_field) return;
  std::int64_t* sums = ring.front().sums;
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(plan.owned); ++i) {
    for (std::uint64_t a = 0; a < static_cast<std::uint64_t>(features.dimension); ++a) {
      sums[i * each + a] = static_cast<std::int64_t>(dice(-1.0, 1.0) * 0x1p40);
    }
  }
}

bool Cloud::ring_is_clear() const {
  return std::all_of(ring.begin(), ring.end(), [](const Line& line) {
    return std::all_of(std::begin(line.sums), std::end(line.sums), [](std::int64_t sum) { return sum == 0; });
  });
}

Cloud Cloud::renumbered(std::uint64_t seed) const {
  Cloud other = *this;
  Dice dice(seed);
  std::vector<std::size_t> order(ids.size());  // slot -> old slot
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto shuffle = [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = end - begin; n > 1; --n) std::swap(order[begin + n - 1], order[begin + dice.below(n)]);
  };
  shuffle(0, static_cast<std::size_t>(plan.owned));
  shuffle(static_cast<std::size_t>(plan.owned), order.size());
  const auto stride = static_cast<std::size_t>(features.layout().stride);
  for (std::size_t i = 0; i < order.size(); ++i) {
    std::copy_n(records.data() + order[i] * stride, stride, other.records.data() + i * stride);
    other.ids[i] = ids[order[i]];
  }
  other.pairs = {};
  other.walls = {};
  other.list(dice);
  other.make_ring(dice);
  const auto doubles = static_cast<std::size_t>(scene::stored_doubles(features));
  const auto signs = scene::stored_signs(features);
  const auto fill = [&](std::vector<double>& values, std::size_t entries, std::size_t entry, GlobalId a, GlobalId b) {
    const std::vector<double> old = stored(b < 0 ? a : std::min(a, b), b < 0 ? b : std::max(a, b));
    for (std::size_t c = 0; c < doubles; ++c) {
      values[c * entries + entry] = b >= 0 && a > b ? signs[c] * old[c] : old[c];
    }
  };
  const auto id = [&](LocalIndex i) { return other.ids[static_cast<std::size_t>(i)]; };
  other.pair_stored.assign(doubles * other.pairs.first.size(), 0.0);
  other.wall_stored.assign(doubles * other.walls.particle.size(), 0.0);
  for (std::size_t p = 0; p < other.pairs.first.size(); ++p) {
    fill(other.pair_stored, other.pairs.first.size(), p, id(other.pairs.first[p]), id(other.pairs.second[p]));
  }
  for (std::size_t w = 0; w < other.walls.particle.size(); ++w) {
    fill(other.wall_stored, other.walls.particle.size(), w, id(other.walls.particle[w]),
         -1 - static_cast<GlobalId>(other.walls.wall[w]));
  }
  return other;
}

// Of all listed contacts, some of them not touching: what a step must drop. Some slide, some stick.
void Cloud::remember(Dice& dice) {
  const auto doubles = static_cast<std::size_t>(scene::stored_doubles(features));
  pair_stored.assign(doubles * pairs.first.size(), 0.0);
  wall_stored.assign(doubles * walls.particle.size(), 0.0);
  for (std::vector<double>* values : {&pair_stored, &wall_stored}) {
    for (double& x : *values) x = dice() < 0.8 ? dice(-1.0, 1.0) * std::pow(10.0, dice(-7.0, -3.0)) : 0.0;
  }
}

std::vector<double> Cloud::stored(GlobalId first, GlobalId second) const {
  std::vector<double> values(static_cast<std::size_t>(scene::stored_doubles(features)), 0.0);
  const auto signs = scene::stored_signs(features);
  const auto id = [&](LocalIndex i) { return ids[static_cast<std::size_t>(i)]; };
  const std::size_t entries = pairs.first.size();
  for (std::size_t p = 0; p < entries; ++p) {
    const GlobalId a = id(pairs.first[p]), b = id(pairs.second[p]);
    if (std::min(a, b) != first || std::max(a, b) != second) continue;
    for (std::size_t c = 0; c < values.size(); ++c) {
      values[c] = (a < b ? 1.0 : signs[c]) * pair_stored[c * entries + p];
    }
  }
  const std::size_t contacts = walls.particle.size();
  for (std::size_t w = 0; w < contacts; ++w) {
    if (id(walls.particle[w]) != first || -1 - static_cast<GlobalId>(walls.wall[w]) != second) continue;
    for (std::size_t c = 0; c < values.size(); ++c) values[c] = wall_stored[c * contacts + w];
  }
  return values;
}

// A cylinder, a thin one seen from outside, and what has a point, a slope and a radius.
geometry::RoundWalls Cloud::round_walls() const {
  const double half = 0.5 * size[0];
  const geometry::RoundWall mantle{{half, half, 0.0}, half}, inner{{half, half, 0.0}, -0.3 * radius, -1.0};
  const double up = features.dimension == 3 ? 1.0 : 0.0;
  return {mantle, inner,
          geometry::RoundWall{
              {half, half, up * half}, 1.06 * half, 0.8, {1.0, 1.0, up}, {0.0, 0.6 * (up - 1.0), -0.6 * up}}};
}

dynamics::StepData Cloud::data() {
  return {.records = records.data(),
          .owned = plan.owned,
          .begin = 0,
          .end = plan.owned,
          .first = pairs.first.data(),
          .second = pairs.second.data(),
          .pairs = static_cast<std::int64_t>(pairs.first.size()),
          .wall_particle = walls.particle.data(),
          .wall = walls.wall.data(),
          .walls = static_cast<std::int64_t>(walls.particle.size()),
          .ring = ring.front().sums,
          .ring_mask = ring_mask,
          .law = law,
          .force_quantum = 0x1p-36,
          .time_step = 1e-4,
          .gravity = features.dimension == 3 ? Vec3{0.0, 0.0, -2.0} : Vec3{0.0, -2.0, 0.0},
          .drag = drag,
          .fluid_velocity = {0.1, -0.2, features.dimension == 3 ? 0.3 : 0.0},
          .size = size,
          .periodic = periodic,
          .planes = dynamics::planes_of({features.dimension, size, periodic}),
          .round = round_walls(),
          .facing = walls.facing.empty() ? nullptr : walls.facing.data(),
          .stored_pairs = {pair_stored.data(), std::ssize(pairs.first)},
          .stored_walls = {wall_stored.data(), std::ssize(walls.particle)}};
}

}  // namespace packmpi::support
