// What is near a particle that moves, from memory and by search.
#include "mesh/near_memory.hpp"

#include <gtest/gtest.h>

#include <map>

#include "mesh/shapes.hpp"

namespace packmpi::mesh {
namespace {

using testing::Dice;
using testing::Soup;

constexpr double deepest = 0.05;

/// Distance and direction of each feature that is nearer than `range`, from a list of those that may be.
std::map<std::int32_t, std::array<double, 4>> touched(const Surface& surface, const NearFeatures& near, const Vec3& x,
                                                      double range) {
  std::map<std::int32_t, std::array<double, 4>> found;
  const Table table = surface.features().table(deepest);
  for (std::size_t k = 0; k < near.feature.size(); ++k) {
    const Touch at =
        touch(table, near.feature[k], near.triangles.data(), near.begin(k), near.end[k], x.data(), far_away);
    if (at.distance < range) found[near.feature[k]] = {at.normal[0], at.normal[1], at.normal[2], at.distance};
  }
  return found;
}

TEST(NearMemory, FindsWhatASearchFinds) {
  Dice dice(7);
  for (const Soup& soup : {testing::box({0, 0, 0}, {1, 1, 1}), testing::l_prism(1.0, 2), testing::ball(3)}) {
    const Surface surface(soup, "a");
    NearMemory memory;
    NearFeatures searched;
    std::vector<Vec3> x(300);
    for (Vec3& one : x) one = dice.point(-1.2, 1.2);
    std::size_t some = 0;
    for (int making = 0; making < 40; ++making) {
      memory.begin();
      for (std::size_t i = 0; i < x.size(); ++i) {
        const double range = 0.15 + 0.05 * dice(0.0, 1.0);  // as margins go with speed
        const double stride = i % 3 == 0 ? 0.05 : 0.003;
        x[i] = plus(x[i], dice.point(-stride, stride));
        surface.near(x[i], range, deepest, searched);
        const auto expected = touched(surface, searched, x[i], range);
        // Ids as a rank has them, some at one place of the memory.
        const NearFeatures& got = memory.near(surface, static_cast<GlobalId>(7 * i), x[i], range, 0.03, deepest);
        ASSERT_EQ(touched(surface, got, x[i], range), expected);
        EXPECT_TRUE(std::ranges::is_sorted(got.feature));
        some += expected.size();
      }
    }
    EXPECT_GT(some, 500U);
  }
}

TEST(NearMemory, OfWhatIsFarTakesNoMemory) {
  const Surface surface(testing::box({0, 0, 0}, {1, 1, 1}), "a");
  NearMemory memory;
  for (int making = 0; making < 3; ++making) {
    memory.begin();
    EXPECT_TRUE(memory.near(surface, 1, {0.5, 0.5, 0.5}, 0.1, 0.01, deepest).feature.empty());
  }
  EXPECT_EQ(memory.bytes(), 0U);
}

}  // namespace
}  // namespace packmpi::mesh
