// The step kernel against its slow twin, bit for bit: every feature, every instruction set, many heaps.
#include "dynamics/kernel.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "support/cloud.hpp"
#include "support/oracle_step.hpp"

namespace packmpi {
namespace {

using dynamics::StepReport;
using scene::Features;
using support::Cloud;
using support::CloudPlan;

/// Sets PACKMPI_ARCH for a scope.
class Architecture {
 public:
  explicit Architecture(const char* name) { setenv("PACKMPI_ARCH", name, 1); }
  Architecture(const Architecture&) = delete;
  Architecture& operator=(const Architecture&) = delete;
  ~Architecture() { unsetenv("PACKMPI_ARCH"); }
};

/// The instruction sets this build has and this machine runs.
std::vector<std::string> architectures() {
  std::vector<std::string> found;
  for (const char* name : {"x86-64", "x86-64-v3", "x86-64-v4"}) {
    const Architecture wish(name);
    try {
      if (std::string(name) == dynamics::kernel_architecture()) found.emplace_back(name);
    } catch (const Error&) {  // not in this build
    }
  }
  return found;
}

std::vector<Features> all_features() {
  std::vector<Features> all;
  for (int bits = 0; bits < 256; ++bits) {
    Features f;
    f.dimension = (bits & 1) != 0 ? 3 : 2;
    f.rotation = (bits & 2) != 0;
    f.friction = (bits & 4) != 0;
    f.drag = (bits & 8) != 0;
    f.graded = (bits & 16) != 0;
    f.periodic = (bits & 32) != 0;
    f.memory = (bits & 64) != 0;
    f.rolling = (bits & 128) != 0;
    const bool whole = (!f.memory || f.friction) && (!f.rolling || (f.memory && f.rotation));
    if (whole) all.push_back(f);
    f.mixture = true;
    if (whole && f.graded && f.friction && f.drag) all.push_back(f);
  }
  return all;
}

std::string words(const Features& f) {
  std::string text = f.dimension == 3 ? "3D" : "2D";
  if (f.rotation) text += " rotation";
  if (f.friction) text += " friction";
  if (f.drag) text += " drag";
  if (f.graded) text += " graded";
  if (f.periodic) text += " periodic";
  if (f.memory) text += " memory";
  if (f.rolling) text += " rolling";
  if (f.mixture) text += " components";
  return text;
}

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

/// The first slot whose record differs in a bit, or -1.
LocalIndex first_difference(const Cloud& a, const Cloud& b) {
  const std::size_t bytes = a.features.layout().record_bytes();
  for (LocalIndex i = 0; i < a.plan.owned + a.plan.ghosts; ++i) {
    if (std::memcmp(a.record(i), b.record(i), bytes) != 0) return i;
  }
  return -1;
}

/// The plans: what a block, a ring or a list can look like.
std::vector<CloudPlan> plans() {
  return {
      {.owned = 150, .ghosts = 40, .seed = 1},
      {.owned = 150, .ghosts = 0, .ring_slack = 3.0, .seed = 2},
      {.owned = 200, .ghosts = 30, .window = 3, .seed = 3},                // tiny ring, blocks cut short
      {.owned = 50, .ghosts = 150, .skin = 1e9, .seed = 4},                // every pair: hundreds for one owner
      {.owned = 170, .ghosts = 20, .skin = 1e9, .window = 64, .seed = 5},  // ring of exactly the window
      {.owned = 1, .ghosts = 0, .seed = 6},
      {.owned = 0, .ghosts = 5, .seed = 7},
      {.owned = 40, .ghosts = 0, .skin = -0.9, .seed = 8},  // hardly any pair
      {.owned = 120, .ghosts = 30, .near_field = true, .seed = 9},
      {.owned = 150, .ghosts = 20, .round = true, .seed = 10},
      {.owned = 150, .ghosts = 20, .mesh = true, .seed = 11},
  };
}

void expect_equal_steps(Cloud fast, int steps) {
  Cloud slow = fast;
  const dynamics::Kernel kernel = dynamics::select_kernel(fast.features);
  for (int s = 0; s < steps; ++s) {
    const StepReport expected = oracle::step(fast.features, slow.data());
    const StepReport got = kernel(fast.data());
    std::fill(slow.ring.begin(), slow.ring.end(), support::Line{});
    EXPECT_TRUE(same_bits(got.max_speed, expected.max_speed)) << got.max_speed << ' ' << expected.max_speed;
    EXPECT_TRUE(same_bits(got.max_force, expected.max_force)) << got.max_force << ' ' << expected.max_force;
    EXPECT_TRUE(got.in_range);
    ASSERT_EQ(first_difference(fast, slow), -1) << "at step " << s;
    ASSERT_EQ(fast.pair_stored, slow.pair_stored) << "at step " << s;
    ASSERT_EQ(fast.wall_stored, slow.wall_stored) << "at step " << s;
    EXPECT_TRUE(fast.ring_is_clear());
  }
}

TEST(Kernel, EqualsItsTwinBitForBit) {
  EXPECT_FALSE(architectures().empty());
  for (const std::string& architecture : architectures()) {
    const Architecture wish(architecture.c_str());
    for (const Features& features : all_features()) {
      for (const CloudPlan& plan : plans()) {
        SCOPED_TRACE(architecture + ", " + words(features) + ", plan " + std::to_string(plan.seed));
        expect_equal_steps(Cloud(features, plan), 3);
        if (HasFatalFailure()) return;
      }
    }
  }
}

/// All others about the first one, in random directions, at the sum of the radii but for roundings.
void gather_at_the_edge(Cloud& cloud, support::Dice& dice) {
  const particles::Layout layout = cloud.features.layout();
  for (int a = 0; a < layout.dimension; ++a) cloud.records[static_cast<std::size_t>(a)] = 0.5 * cloud.size[0];
  const double* centre = cloud.record(0);
  for (std::ptrdiff_t i = 1; i < std::ssize(cloud.ids); ++i) {
    double* record = cloud.records.data() + i * layout.stride;
    double direction[3] = {};
    double square = 0.0;
    for (int a = 0; a < layout.dimension; ++a) {
      direction[a] = dice(-1.0, 1.0);
      square += direction[a] * direction[a];
    }
    const double roundings = static_cast<double>(i % 41 - 20) * std::numeric_limits<double>::epsilon();
    const double distance = (centre[layout.radius] + record[layout.radius]) * (1.0 + roundings);
    for (int a = 0; a < layout.dimension; ++a) record[a] = centre[a] + direction[a] / std::sqrt(square) * distance;
  }
}

TEST(Kernel, NoPairThatTouchesIsLeftOut) {
  support::Dice dice(1);
  for (const std::string& architecture : architectures()) {
    const Architecture wish(architecture.c_str());
    for (const Features& features : all_features()) {
      SCOPED_TRACE(architecture + ", " + words(features));
      Cloud cloud(features, {.owned = 100, .ghosts = 60, .skin = 1e9, .seed = 12});
      gather_at_the_edge(cloud, dice);
      expect_equal_steps(cloud, 1);
      if (HasFatalFailure()) return;
    }
  }
}

/// One step of the cloud in parts, cut at random slots; some are empty.
StepReport step_in_parts(const dynamics::Kernel kernel, Cloud& cloud, support::Dice& dice) {
  std::vector<LocalIndex> cuts(5);
  for (LocalIndex& cut : cuts)
    cut = static_cast<LocalIndex>(dice.below(static_cast<std::uint64_t>(cloud.plan.owned) + 1));
  cuts.push_back(cloud.plan.owned);
  std::ranges::sort(cuts);
  StepReport report;
  dynamics::StepData part = cloud.data();
  const std::int64_t pairs = part.pairs;
  const std::int64_t walls = part.walls;
  std::int64_t pairs_done = 0, walls_done = 0;
  part.end = 0;
  for (const LocalIndex cut : cuts) {
    part.begin = part.end;
    part.end = cut;
    part.first = cloud.pairs.first.data() + pairs_done;
    part.second = cloud.pairs.second.data() + pairs_done;
    part.stored_pairs.values = cloud.pair_stored.data() + pairs_done;
    part.stored_walls.values = cloud.wall_stored.data() + walls_done;
    for (part.pairs = 0; pairs_done < pairs && part.first[part.pairs] < cut; ++pairs_done) ++part.pairs;
    part.wall_particle = cloud.walls.particle.data() + walls_done;
    part.wall = cloud.walls.wall.data() + walls_done;
    if (part.facing != nullptr) part.facing = cloud.walls.facing.data() + walls_done;
    for (part.walls = 0; walls_done < walls && part.wall_particle[part.walls] < cut; ++walls_done) ++part.walls;
    report = dynamics::together(report, kernel(part));
  }
  return report;
}

TEST(Kernel, PartsMakeTheSameStep) {
  support::Dice dice(4);
  for (const Features& features : all_features()) {
    const dynamics::Kernel kernel = dynamics::select_kernel(features);
    for (const CloudPlan& plan : plans()) {
      SCOPED_TRACE(words(features) + ", plan " + std::to_string(plan.seed));
      Cloud whole(features, plan);
      Cloud cut = whole;
      const StepReport expected = kernel(whole.data());
      const StepReport got = step_in_parts(kernel, cut, dice);
      EXPECT_TRUE(same_bits(got.max_force, expected.max_force));
      EXPECT_LE(got.max_speed, expected.max_speed);
      EXPECT_GE(got.max_speed, expected.max_speed / std::sqrt(3.0));  // both are bounds, good to that
      ASSERT_EQ(first_difference(whole, cut), -1);
      ASSERT_EQ(whole.pair_stored, cut.pair_stored);
      ASSERT_EQ(whole.wall_stored, cut.wall_stored);
      EXPECT_TRUE(cut.ring_is_clear());
    }
  }
}

TEST(Kernel, TogetherKeepsWhatIsWrong) {
  const StepReport fine{1.0, 2.0, true};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const bool swap : {false, true}) {
    const auto both = [&](const StepReport& other) {
      return swap ? dynamics::together(other, fine) : dynamics::together(fine, other);
    };
    EXPECT_TRUE(std::isnan(both({nan, 1.0, true}).max_speed));
    EXPECT_TRUE(std::isnan(both({1.0, nan, true}).max_force));
    EXPECT_FALSE(both({1.0, 1.0, false}).in_range);
    EXPECT_EQ(both({3.0, 1.0, true}).max_speed, 3.0);
    EXPECT_EQ(both({3.0, 1.0, true}).max_force, 2.0);
  }
}

TEST(Kernel, TwinMeetsContactsOfEveryKind) {  // or the comparison above proves nothing
  for (const Features& features : all_features()) {
    Cloud cloud(features, plans().front());
    EXPECT_GT(cloud.pairs.first.size(), 150U) << words(features);
    EXPECT_GT(cloud.walls.particle.size(), 0U) << words(features);
    EXPECT_GT(cloud.pairs.window, 100) << words(features);
    EXPECT_GT(oracle::step(features, cloud.data()).max_force, 1.0) << words(features);
  }
}

TEST(Kernel, NumberingDoesNotMatter) {
  for (const Features& features : all_features()) {
    SCOPED_TRACE(words(features));
    Cloud one(features, {.owned = 200, .ghosts = 60, .seed = 11});
    Cloud two = one.renumbered(5);
    const dynamics::Kernel kernel = dynamics::select_kernel(features);
    for (int s = 0; s < 3; ++s) {
      const StepReport a = kernel(one.data());
      const StepReport b = kernel(two.data());
      EXPECT_TRUE(same_bits(a.max_force, b.max_force));
      EXPECT_TRUE(same_bits(a.max_speed, b.max_speed));
    }
    const std::size_t bytes = features.layout().record_bytes();
    for (LocalIndex i = 0; i < one.plan.owned; ++i) {
      const auto old = static_cast<LocalIndex>(two.ids[static_cast<std::size_t>(i)]);
      ASSERT_EQ(std::memcmp(two.record(i), one.record(old), bytes), 0) << "particle " << old;
    }
    for (std::size_t p = 0; features.memory && p < one.pairs.first.size(); ++p) {
      const GlobalId a = one.pairs.first[p], b = one.pairs.second[p];  // ids are slots there
      ASSERT_EQ(one.stored(a, b), two.stored(a, b)) << "particles " << a << ' ' << b;
    }
  }
}

TEST(Kernel, NonFiniteStatesAreTold) {
  for (const Features& features : all_features()) {
    const particles::Layout layout = features.layout();
    std::vector<int> fields = {layout.position, layout.velocity, layout.velocity + layout.dimension - 1};
    if (layout.rotation) fields.push_back(layout.spin);
    for (const int field : fields) {
      for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        for (const LocalIndex particle : {0, 77, 149}) {
          Cloud cloud(features, plans().front());
          cloud.records[static_cast<std::size_t>(particle * layout.stride + field)] = bad;
          const StepReport report = dynamics::select_kernel(features)(cloud.data());
          EXPECT_FALSE(std::isfinite(report.max_speed)) << words(features) << ", field " << field;
        }
        Cloud cloud(features, {.owned = 50, .ghosts = 50, .skin = 1e9, .seed = 3});  // a ghost: its force is not finite
        double* ghost = cloud.records.data() + static_cast<std::ptrdiff_t>(70) * layout.stride;
        std::copy_n(cloud.record(7), layout.dimension, ghost);  // it meets somebody; whoever has it tells otherwise
        ghost[0] -= 0.5 * ghost[layout.radius];
        ghost[field] = bad;
        const StepReport report = dynamics::select_kernel(features)(cloud.data());
        if (field != layout.spin || cloud.law.pair.friction > 0.0) {
          EXPECT_FALSE(report.in_range) << words(features) << ", ghost, field " << field << ' ' << bad;
        }
      }
    }
  }
}

TEST(Kernel, ForceOutOfRangeIsTold) {
  for (const Features& features : all_features()) {
    Cloud cloud(features, plans().front());
    dynamics::StepData data = cloud.data();
    const double force = oracle::step(features, Cloud(cloud).data()).max_force;
    const double enough = std::exp2(std::ceil(std::log2(force * 4.0 / dynamics::max_quanta)));
    data.force_quantum = enough;
    Cloud fine = cloud;
    data.records = fine.records.data();
    EXPECT_TRUE(dynamics::select_kernel(features)(data).in_range) << words(features);
    data.force_quantum = enough / 16.0;
    data.records = cloud.records.data();
    EXPECT_FALSE(dynamics::select_kernel(features)(data).in_range) << words(features);
  }
}

TEST(Kernel, MomentumIsExactWithoutWalls) {
  for (const Features& features : all_features()) {
    if (features.drag || features.graded) continue;
    Cloud cloud(features, {.owned = 180, .ghosts = 0, .seed = 21});
    cloud.walls = {};
    dynamics::StepData data = cloud.data();
    data.gravity = {};
    data.time_step = 0.5;  // powers of two and coarse velocities: nothing is rounded but the forces, and those cancel
    data.force_quantum = 0x1p-8;
    data.law.wall.reduced_mass = 1.0;
    data.law.slip_rate = 2.0;
    const int stride = features.layout().stride;
    std::array<double, 3> before{}, after{};
    const auto sum = [&](std::array<double, 3>& total) {
      for (LocalIndex i = 0; i < cloud.plan.owned; ++i) {
        for (int a = 0; a < features.dimension; ++a) {
          total[static_cast<std::size_t>(a)] += data.records[i * stride + features.layout().velocity + a];
        }
      }
    };
    for (LocalIndex i = 0; i < cloud.plan.owned; ++i) {
      for (int a = 0; a < features.dimension; ++a) {
        double& v = data.records[i * stride + features.layout().velocity + a];
        v = std::round(v * 256.0) / 256.0;
      }
    }
    sum(before);
    const StepReport report = dynamics::select_kernel(features)(data);
    sum(after);
    EXPECT_GT(report.max_force, 1.0);
    EXPECT_EQ(before, after) << words(features);
  }
}

TEST(Kernel, ArchitectureIsChosenAndLowered) {
  const std::string best = dynamics::kernel_architecture();
  EXPECT_EQ(best, architectures().back());
  {
    const Architecture wish("x86-64");
    EXPECT_STREQ(dynamics::kernel_architecture(), "x86-64");
  }
  {
    const Architecture wish("sparc");
    EXPECT_THROW(static_cast<void>(dynamics::select_kernel(Features{})), Error);
  }
  EXPECT_EQ(best, dynamics::kernel_architecture());
}

}  // namespace
}  // namespace packmpi
