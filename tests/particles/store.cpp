// Which fields exist, how they lie, and that moving them loses no bit.
#include "particles/store.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <memory>
#include <numeric>
#include <random>
#include <set>
#include <vector>

namespace packmpi::particles {
namespace {

const std::array<Layout, 4> layouts{layout_of(3, true), layout_of(3, false), layout_of(2, true), layout_of(2, false)};

TEST(Layout, ASceneStoresOnlyWhatItUses) {
  const std::array<std::size_t, 4> bytes{96, 64, 64, 48};
  const std::array<int, 4> live{9, 6, 5, 4};
  const std::array<int, 4> used{11, 8, 7, 6};
  const std::array<int, 4> spins{3, 0, 1, 0};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(layouts[k].record_bytes(), bytes[k]) << k;
    EXPECT_EQ(layouts[k].live_doubles(), live[k]) << k;
    EXPECT_EQ(layouts[k].used_doubles(), used[k]) << k;
    EXPECT_EQ(layouts[k].spin_components(), spins[k]) << k;
    EXPECT_EQ(layouts[k].spin >= 0, layouts[k].rotation) << k;
  }
}

TEST(Layout, FieldsFillTheRecordWithoutOverlap) {
  for (const Layout& l : layouts) {
    std::multiset<int> taken;
    const auto take = [&](int at, int count) {
      for (int c = 0; c < count; ++c) taken.insert(at + c);
    };
    take(l.position, l.dimension);
    take(l.velocity, l.dimension);
    take(l.radius, 1);
    take(l.curvature, 1);
    take(l.spin, l.spin_components());
    std::multiset<int> expected;
    for (int i = 0; i < l.used_doubles(); ++i) expected.insert(i);
    EXPECT_EQ(taken, expected);
    EXPECT_LE(l.used_doubles(), l.stride);
    EXPECT_LT(l.stride - l.used_doubles(), 2);
  }
}

TEST(AlignedDoubles, GrowsKeepsAndAligns) {
  AlignedDoubles a;
  EXPECT_EQ(a.bytes(), 0U);
  std::size_t allocations = 0;
  for (std::size_t n = 1; n <= 5000; ++n) {
    const double* before = a.data();
    a.resize(n);
    allocations += a.data() != before ? 1 : 0;
    a.data()[n - 1] = static_cast<double>(n);
  }
  EXPECT_LT(allocations, 100U);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(a.data()) % 64, 0U);
  for (std::size_t n = 1; n <= 5000; ++n) ASSERT_EQ(a.data()[n - 1], static_cast<double>(n));
  EXPECT_LE(a.capacity(), 5000U * 12 / 10);
  std::memset(a.data() + a.size(), 0, 64);  // the padding is ours: address sanitizers watch
  const double* data = a.data();
  AlignedDoubles b = std::move(a);
  EXPECT_EQ(b.data(), data);
  EXPECT_EQ(b.size(), 5000U);
  b.resize(3);
  EXPECT_EQ(b.data(), data);
}

Vec3 vec(std::mt19937_64& random) {
  const auto number = [&] { return static_cast<double>(random() % 2000001) * 1e-6 - 1.0; };
  return {number(), number(), number()};
}

Store filled(const Layout& layout, int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Store store(layout);
  for (int i = 0; i < count; ++i) {
    const double radius = 0.01 + 0.0001 * static_cast<double>(random() % 100);
    store.add(1000 + i, vec(random), radius, vec(random), vec(random));
  }
  return store;
}

TEST(Store, GivesBackWhatWasAdded) {
  const Vec3 x{1.5, 2.25, 3.125};
  const Vec3 v{-1.0, -2.0, -3.0};
  const Vec3 w{8.0, 16.0, 32.0};
  for (const Layout& layout : layouts) {
    Store store(layout);
    store.add(7, x, 0.25, v, w);
    const bool solid = layout.dimension == 3;
    EXPECT_EQ(store.position(0), (Vec3{1.5, 2.25, solid ? 3.125 : 0.0}));
    EXPECT_EQ(store.velocity(0), (Vec3{-1.0, -2.0, solid ? -3.0 : 0.0}));
    EXPECT_EQ(store.spin(0), layout.rotation ? (solid ? w : Vec3{0.0, 0.0, 32.0}) : Vec3{});
    EXPECT_EQ(store.radius(0), 0.25);
    EXPECT_EQ(store.record(0)[layout.curvature], 4.0);
    if (layout.rotation) {
      EXPECT_EQ(store.record(0)[layout.spin], solid ? 2.0 : 8.0);  // r omega
    }
    EXPECT_EQ(store.ids()[0], 7);
    EXPECT_EQ(store.owned(), 1);
    EXPECT_EQ(store.total(), 1);
  }
}

TEST(Store, GhostsComeAfterTheOwnedAndLeaveThemAlone) {
  for (const Layout& layout : layouts) {
    Store store = filled(layout, 10, 1);
    const std::uint64_t before = digest(store);
    const Vec3 last = store.position(9);
    store.set_ghosts(5000);
    EXPECT_EQ(store.total(), 5010);
    EXPECT_EQ(store.ids().size(), 5010U);
    std::memset(store.record(10), 0x5a, 5000 * layout.record_bytes());
    EXPECT_EQ(store.position(9), last);
    EXPECT_EQ(digest(store), before);  // ghosts do not count
    store.set_ghosts(0);
    store.add(5, {}, 0.1, {}, {});
    EXPECT_EQ(store.owned(), 11);
    EXPECT_EQ(store.ids()[10], 5);
  }
}

// Records by id, for comparing after a move.
std::map<GlobalId, std::vector<double>> contents(const Store& store) {
  std::map<GlobalId, std::vector<double>> all;
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    all[store.ids()[static_cast<std::size_t>(i)]].assign(store.record(i), store.record(i) + store.layout().stride);
  }
  return all;
}

// Slot k of the store holds what slot order[k] held.
void expect_in_order(const Store& store, const std::vector<LocalIndex>& order,
                     const std::map<GlobalId, std::vector<double>>& before) {
  ASSERT_EQ(store.owned(), static_cast<LocalIndex>(order.size()));
  ASSERT_EQ(store.ghosts(), 0);
  for (std::size_t k = 0; k < order.size(); ++k) ASSERT_EQ(store.ids()[k], 1000 + order[k]);
  for (const auto& [id, record] : contents(store)) ASSERT_EQ(record, before.at(id));
}

TEST(Store, PermuteMovesRecordsAndIdsTogether) {
  for (const Layout& layout : layouts) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      Store store = filled(layout, 300, 2);
      const auto before = contents(store);
      std::vector<LocalIndex> order(300);
      std::iota(order.begin(), order.end(), 0);
      std::shuffle(order.begin(), order.begin() + 100 * static_cast<int>(seed),
                   std::mt19937_64(seed));  // fixed points too
      store.set_ghosts(20);
      std::vector<LocalIndex> used = order;
      store.permute(used);
      expect_in_order(store, order, before);
    }
  }
}

TEST(Store, KeepDropsTheOthers) {
  for (const Layout& layout : layouts) {
    Store store = filled(layout, 300, 2);
    const auto before = contents(store);
    std::vector<LocalIndex> kept;
    for (LocalIndex i = 0; i < 300; i += 1 + i % 3) kept.push_back(i);
    store.set_ghosts(20);
    store.keep(kept);
    expect_in_order(store, kept, before);
    store.keep({});
    EXPECT_EQ(store.total(), 0);
    EXPECT_EQ(digest(store), 0U);
  }
}

TEST(Store, CountsItsBytes) {
  Store store = filled(layout_of(3, true), 1000, 4);
  EXPECT_GE(store.bytes(), 1000U * (96 + 8));
  EXPECT_LE(store.bytes(), 1000U * (96 * 13 / 10 + 8 * 2));
}

TEST(Digest, IndependentOfOrderAndOfParts) {
  for (const Layout& layout : layouts) {
    Store store = filled(layout, 100, 5);
    const std::uint64_t whole = digest(store);
    std::vector<LocalIndex> order(100);
    std::iota(order.rbegin(), order.rend(), 0);
    store.permute(order);
    EXPECT_EQ(digest(store), whole);
    Store first(layout);
    Store second(layout);
    for (LocalIndex i = 0; i < 100; ++i) {
      (i % 3 == 0 ? first : second).add_record(store.ids()[static_cast<std::size_t>(i)], store.record(i));
    }
    EXPECT_EQ(digest(first) + digest(second), whole);
  }
}

/// The neighbouring double: one bit of difference.
void flip_last_bit(double& x) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  bits ^= 1U;
  std::memcpy(&x, &bits, sizeof bits);
}

TEST(Digest, SeesEveryBitOfEveryFieldAndTheId) {
  for (const Layout& layout : layouts) {
    Store store = filled(layout, 10, 6);
    const std::uint64_t whole = digest(store);
    for (int k = 0; k < layout.stride; ++k) {
      flip_last_bit(store.record(4)[k]);
      if (k < layout.used_doubles()) {
        EXPECT_NE(digest(store), whole) << k;
      } else {
        EXPECT_EQ(digest(store), whole) << "padding";
      }
      flip_last_bit(store.record(4)[k]);
    }
    std::swap(store.ids()[1], store.ids()[2]);  // two names exchanged is another state
    EXPECT_NE(digest(store), whole);
    std::swap(store.ids()[1], store.ids()[2]);
    std::swap(store.record(3)[0], store.record(3)[1]);  // and two fields of one particle
    EXPECT_NE(digest(store), whole);
  }
}

}  // namespace
}  // namespace packmpi::particles
