// step_bench [particles = 107000] [runs = 9]: the step kernel alone on a heap like a settled bed, particle-steps a
// second. A body-centred lattice with gaps has the neighbours of a real bed: 3.2 listed pairs a particle, half of them
// touching.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <random>
#include <string>
#include <vector>

#include "dynamics/kernel.hpp"
#include "particles/store.hpp"
#include "scene/pair_channels.hpp"

namespace packmpi {
namespace {

constexpr double radius = 0.02;  // [m]
constexpr double skin = 0.0015;

struct alignas(64) Line {
  std::int64_t sums[8] = {};
};

double uniform(std::mt19937_64& engine) { return static_cast<double>(engine() >> 11) * 0x1p-53; }

/// A bed with about `count` particles, sorted as the program sorts them: columns by x, then y; z fastest.
struct Bed {
  Bed(const scene::Features& f, int count) : features(f), store(f.layout()) {
    const bool deep = f.dimension == 3;
    const double apart = (deep ? 2.0 / std::sqrt(3.0) : 1.0) * 2.0 * radius * 0.9995;  // lattice constant
    const double cells = deep ? std::cbrt(count / (2.0 * 0.85)) : std::sqrt(count / 0.85);
    side = static_cast<int>(std::lround(cells));
    const double edge = (side + 0.5) * apart;
    size = {edge, deep ? edge : 0.0, 0.0};
    std::mt19937_64 engine(1);
    for (int column = 0; column < (deep ? 2 * side * side : side); ++column) fill(column, apart, engine);
    list(apart);
    const auto slots = dynamics::ring_slots(pairs.window);
    ring.resize(static_cast<std::size_t>(slots + 1));
    make_data(slots);
  }

  /// One column of the lattice; in 3D odd ones are the centres of the cells.
  void fill(int column, double apart, std::mt19937_64& engine) {
    const bool deep = features.dimension == 3;
    const int shift = deep ? column % 2 : 0;
    const int cell = deep ? column / 2 : column;
    for (int level = 0; level < side; ++level) {
      const bool gap = uniform(engine) < 0.15;
      const auto place = [&](int n, bool centre) {
        return (n + 0.5 + (centre ? 0.5 : 0.0)) * apart + (uniform(engine) - 0.5) * 0.04 * radius;
      };
      const Vec3 x =
          deep ? Vec3{place(cell / side, shift == 1), place(cell % side, shift == 1), place(level, shift == 1)}
               : Vec3{place(cell, false), place(level, false), 0.0};
      const double r = features.graded ? radius * (1.0 + 0.004 * (uniform(engine) - 0.5)) : radius;
      const Vec3 v = {uniform(engine) - 0.5, uniform(engine) - 0.5, deep ? uniform(engine) - 0.5 : 0.0};
      if (!gap) store.add(store.owned(), x, r, v, deep ? Vec3{1.0, 2.0, 3.0} : Vec3{0.0, 0.0, 3.0});
    }
  }

  /// Pairs within the skin, by cells of a lattice constant; walls likewise.
  void list(double apart) {
    const auto cell_of = [&](double x) { return std::clamp(static_cast<int>(x / (1.1 * apart)), 0, 2 * side + 1); };
    const int many = 2 * side + 2;
    const int layers = features.dimension == 3 ? many : 1;
    std::vector<std::vector<LocalIndex>> cells(static_cast<std::size_t>(many * many * layers));
    const auto bin = [&](int x, int y, int z) -> std::vector<LocalIndex>& {
      return cells[static_cast<std::size_t>((x * many + y) * layers + z)];
    };
    const auto depth = [&](const Vec3& x) { return layers == 1 ? 0 : cell_of(x[2]); };
    for (LocalIndex i = 0; i < store.owned(); ++i) {
      const Vec3 x = store.position(i);
      bin(cell_of(x[0]), cell_of(x[1]), depth(x)).push_back(i);
    }
    for (LocalIndex i = 0; i < store.owned(); ++i) {
      const Vec3 a = store.position(i);
      const int cx = cell_of(a[0]);
      const int cy = cell_of(a[1]);
      const int cz = depth(a);
      const std::size_t begin = pairs.second.size();
      for (int x = std::max(cx - 1, 0); x <= std::min(cx + 1, many - 1); ++x) {
        for (int y = std::max(cy - 1, 0); y <= std::min(cy + 1, many - 1); ++y) {
          for (int z = std::max(cz - 1, 0); z <= std::min(cz + 1, layers - 1); ++z) {
            for (const LocalIndex j : bin(x, y, z)) {
              const Vec3 b = store.position(j);
              const double d = std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
              const double reach = store.radius(i) + store.radius(j);
              if (j <= i || d >= reach + skin) continue;
              touching += d < reach ? 1 : 0;
              pairs.first.push_back(i);
              pairs.second.push_back(j);
              pairs.window = std::max(pairs.window, j - i + 1);
            }
          }
        }
      }
      std::sort(pairs.second.begin() + static_cast<std::ptrdiff_t>(begin), pairs.second.end());
      add_walls(i, a);
    }
  }

  void add_walls(LocalIndex i, const Vec3& x) {
    const auto near = [&](double distance, neighbor::Wall wall) {
      if (distance > radius + skin) return;
      walls.particle.push_back(i);
      walls.wall.push_back(wall);
    };
    near(x[static_cast<std::size_t>(features.dimension - 1)], neighbor::Wall::floor);
    near(x[0], neighbor::Wall::x_low);
    near(size[0] - x[0], neighbor::Wall::x_high);
    if (features.dimension == 3) near(x[1], neighbor::Wall::y_low), near(size[1] - x[1], neighbor::Wall::y_high);
  }

  void make_data(std::int64_t slots) {
    const double modulus = 1e8 / (2.0 * (1.0 - 0.0625));
    const double mass_factor = 3.0 / (4.0 * 3.141592653589793 * 1000.0);
    const double mass = radius * radius * radius / mass_factor;
    const double damping = 0.2 * std::sqrt(2.0 * modulus);
    data = {.records = store.records(),
            .owned = store.owned(),
            .begin = 0,
            .end = store.owned(),
            .first = pairs.first.data(),
            .second = pairs.second.data(),
            .pairs = static_cast<std::int64_t>(pairs.first.size()),
            .wall_particle = walls.particle.data(),
            .wall = walls.wall.data(),
            .walls = static_cast<std::int64_t>(walls.particle.size()),
            .ring = ring.front().sums,
            .ring_mask = slots - 1,
            .law = {.pair = {4.0 / 3.0 * modulus, damping, 0.2, 0.5 * radius, 0.5 * mass},
                    .wall = {8.0 / 3.0 * modulus, damping, 0.2, radius, mass},
                    .mass_factor = mass_factor,
                    .spin_slip = 1.0,
                    .slip_rate = 1e4,
                    .slip_mass = 2.0 / 7.0,
                    .lowest_force = 0.0},
            .force_quantum = 0x1p-36,
            .time_step = 1e-12,  // the bed stays as it is; the work does not depend on the values
            .gravity = {0.0, 0.0, -2.0},
            .drag = 0.005,
            .fluid_velocity = {},
            .size = size,
            .periodic = {features.periodic, features.periodic},
            .planes = dynamics::planes_of({features.dimension, size, {}})};
    if (!features.memory) return;
    const auto doubles = static_cast<std::size_t>(scene::stored_doubles(features));
    pair_stored.assign(doubles * pairs.first.size(), 0.0);
    wall_stored.assign(doubles * walls.particle.size(), 0.0);
    data.stored_pairs = {pair_stored.data(), std::ssize(pairs.first)};
    data.stored_walls = {wall_stored.data(), std::ssize(walls.particle)};
    for (dynamics::LawConstants* c : {&data.law.pair, &data.law.wall}) {
      c->shear_stiffness = 1.3 * c->stiffness;
      c->shear_damping = 0.6 * c->damping;
      c->rolling_friction = c->twisting_friction = features.rolling ? 0.1 : 0.0;
    }
  }

  scene::Features features;
  particles::Store store;
  int side = 0;
  Vec3 size{};
  neighbor::PairList pairs;
  neighbor::WallList walls;
  std::int64_t touching = 0;
  std::vector<double> pair_stored, wall_stored;
  std::vector<Line> ring;
  dynamics::StepData data{};
};

/// Particle-steps a second of each run, ascending.
std::vector<double> rates(Bed& bed, int runs) {
  const dynamics::Kernel kernel = dynamics::select_kernel(bed.features);
  const int steps = std::max(2, static_cast<int>(4000000 / std::max(bed.store.owned(), 1)));
  std::vector<double> result;
  for (int run = 0; run < runs; ++run) {
    const std::clock_t begin = std::clock();  // time of this process, so that other processes disturb little
    for (int s = 0; s < steps; ++s) {
      if (!kernel(bed.data).in_range) std::abort();
    }
    const double time = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    result.push_back(static_cast<double>(bed.store.owned()) * steps / time);
  }
  std::sort(result.begin(), result.end());
  return result;
}

struct Case {
  const char* name;
  scene::Features features;
};

void run(int count, int runs) {
  const scene::Features full = {.dimension = 3, .rotation = true, .friction = true, .drag = true};
  std::vector<Case> cases = {{"3D equal rotation", full}};
  cases.push_back({"3D graded rotation", full});
  cases.back().features.graded = true;
  cases.push_back({"3D equal rotation periodic", full});
  cases.back().features.periodic = true;
  cases.push_back({"3D equal no rotation", full});
  cases.back().features.rotation = false;
  cases.push_back({"3D equal rotation no friction", full});
  cases.back().features.friction = false;
  cases.push_back({"3D equal rotation no drag", full});
  cases.back().features.drag = false;
  cases.push_back({"3D equal rotation memory", full});
  cases.back().features.memory = true;
  cases.push_back({"3D graded rotation memory", full});
  cases.back().features.memory = cases.back().features.graded = true;
  cases.push_back({"3D equal rotation memory rolling", full});
  cases.back().features.memory = cases.back().features.rolling = true;
  cases.push_back({"2D equal rotation memory", full});
  cases.back().features.dimension = 2;
  cases.back().features.memory = true;
  cases.push_back({"3D equal nothing else", {.dimension = 3, .rotation = false, .friction = false, .drag = false}});
  cases.push_back({"2D equal rotation", full});
  cases.back().features.dimension = 2;
  cases.push_back({"2D equal nothing else", {.dimension = 2, .rotation = false, .friction = false, .drag = false}});
  fmt::print("{}, {} runs each\n", dynamics::kernel_architecture(), runs);
  for (const Case& c : cases) {
    Bed bed(c.features, count);
    const std::vector<double> r = rates(bed, runs);
    const double median = r[r.size() / 2];
    const double n = bed.store.owned();
    fmt::print(
        "{:30s} N {:8d}  pairs/N {:.2f} touching/N {:.2f} window {:6d}  {:5.1f}e6/s (best {:5.1f})  {:5.1f} ns, {} "
        "bytes "
        "a record\n",
        c.name, bed.store.owned(), static_cast<double>(bed.pairs.first.size()) / n,
        static_cast<double>(bed.touching) / n, bed.pairs.window, median * 1e-6, r.back() * 1e-6, 1e9 / median,
        bed.store.layout().record_bytes());
  }
}

}  // namespace
}  // namespace packmpi

int main(int argc, char** argv) {
  packmpi::run(argc > 1 ? std::atoi(argv[1]) : 107000, argc > 2 ? std::atoi(argv[2]) : 9);
  return 0;
}
