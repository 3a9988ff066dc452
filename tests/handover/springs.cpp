// Springs of friction as one motion: made by the rules that LAMMPS and LIGGGHTS have, they are those of the pack.
#include "handover/springs.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mesh/vectors.hpp"
#include "support/scattered.hpp"

namespace packmpi::handover {
namespace {

using mesh::cross;
using pack::TouchingRow;

// Relative velocity of the surfaces, as fix wall/gran and pair granular have it: of the first to the second.
Vec3 slip(const Vec3& va, const Vec3& vb, const Vec3& spins, const Vec3& n) {
  Vec3 v{va[0] - vb[0], va[1] - vb[1], va[2] - vb[2]};
  const double along = dot(v, n);
  const Vec3 turn = cross(spins, n);
  for (std::size_t c = 0; c < 3; ++c) v[c] += turn[c] - along * n[c];
  return v;
}

// What a code that moves by `motions` for one step makes of a contact's spring, of the second past the first.
Vec3 made(const TouchingRow& row, const std::vector<Motion>& motions, const std::vector<double>& radius, Arm arm) {
  const double less = arm == Arm::middle ? 0.5 * row.overlap : 0.0;
  const Motion& a = motions[static_cast<std::size_t>(row.first)];
  const Motion none;
  const Motion& b = row.wall >= 0 ? none : motions[static_cast<std::size_t>(row.second)];
  const double ra = radius[static_cast<std::size_t>(row.first)] - less;
  const double rb = row.wall >= 0 ? 0.0 : radius[static_cast<std::size_t>(row.second)] - less;
  Vec3 spins{};
  for (std::size_t c = 0; c < 3; ++c) spins[c] = ra * a.turn[c] + rb * b.turn[c];
  const Vec3 of_first = slip(a.displacement, b.displacement, spins, row.normal);
  return {-of_first[0], -of_first[1], -of_first[2]};
}

Vec3 direction(testing::Scatter& u, bool flat) {
  Vec3 n{u() - 0.5, u() - 0.5, flat ? 0.0 : u() - 0.5};
  const double length = norm(n);
  for (double& x : n) x /= length;
  return n;
}

struct Network {
  std::vector<TouchingRow> rows;
  std::vector<double> radius;
};

// A ring of spheres with chords, two of which touch walls: 1.5 contacts a sphere, springs as they come.
Network some_network(bool flat) {
  testing::Scatter u;
  constexpr GlobalId count = 40;
  Network net;
  for (GlobalId k = 0; k < count; ++k) net.radius.push_back(0.004 + 0.004 * u());
  const auto touch = [&](GlobalId a, GlobalId b, std::int32_t wall) {
    TouchingRow row{.first = a, .second = b, .wall = wall, .overlap = 1e-4 * u(), .normal = direction(u, flat)};
    const Vec3 along = cross(row.normal, flat ? Vec3{0.0, 0.0, 1.0} : direction(u, false));
    for (std::size_t c = 0; c < 3; ++c) row.tangential[c] = 1e-6 * along[c];
    net.rows.push_back(row);
  };
  for (GlobalId k = 0; k + 1 < count; ++k) touch(k, k + 1, -1);
  for (GlobalId k = 0; k + 7 < count; k += 2) touch(k, k + 7, -1);
  touch(0, -1, 0);
  touch(count - 1, -1, 3);
  return net;
}

TEST(Springs, OneStepMakesThemByEitherLever) {
  for (const bool flat : {false, true}) {
    const Network net = some_network(flat);
    for (const Arm arm : {Arm::radius, Arm::middle}) {
      const Motions motions = motions_of(net.rows, net.radius, arm, true);
      EXPECT_LT(motions.left, 1e-8);
      for (const TouchingRow& row : net.rows) {
        const Vec3 spring = made(row, motions.of, net.radius, arm);
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(spring[c], row.tangential[c], 1e-13);
      }
    }
  }
}

TEST(Springs, ALeverIsFeltWhereTheOverlapIsLarge) {
  Network net = some_network(false);
  for (TouchingRow& row : net.rows) row.overlap = 1e-3;
  const Motions motions = motions_of(net.rows, net.radius, Arm::middle, true);
  double off = 0.0;
  for (const TouchingRow& row : net.rows) {
    const Vec3 spring = made(row, motions.of, net.radius, Arm::radius);
    for (std::size_t c = 0; c < 3; ++c) off = std::max(off, std::abs(spring[c] - row.tangential[c]));
  }
  EXPECT_GT(off, 1e-8);
}

TEST(Springs, APlaneStaysOne) {
  const Network net = some_network(true);
  for (const Motion& motion : motions_of(net.rows, net.radius, Arm::radius, true).of) {
    EXPECT_EQ(motion.displacement[2], 0.0);
    EXPECT_EQ(motion.turn[0], 0.0);
    EXPECT_EQ(motion.turn[1], 0.0);
  }
}

TEST(Springs, WhatDoesNotTurnIsDisplacedAlone) {
  const Network net = some_network(true);
  const Motions motions = motions_of(net.rows, net.radius, Arm::radius, false);
  for (const Motion& motion : motions.of) EXPECT_EQ(norm(motion.turn), 0.0);
}

TEST(Springs, WhereNoMotionMakesThemItIsSaid) {
  // One sphere between two walls that cannot roll: it cannot slide along both in opposite senses.
  const Vec3 up{0.0, 0.0, 1.0}, down{0.0, 0.0, -1.0}, x{1e-6, 0.0, 0.0}, back{-1e-6, 0.0, 0.0};
  const std::vector<TouchingRow> rows{{.first = 0, .second = -1, .wall = 5, .normal = up, .tangential = x},
                                      {.first = 0, .second = -1, .wall = 0, .normal = down, .tangential = back}};
  const std::vector<double> radius{0.01};
  EXPECT_NEAR(motions_of(rows, radius, Arm::radius, false).left, 1.0, 1e-12);
  EXPECT_LT(motions_of(rows, radius, Arm::radius, true).left, 1e-9);
}

TEST(Springs, NoneAreNoMotion) {
  EXPECT_TRUE(motions_of({}, {}, Arm::radius, true).of.empty());
  const std::vector<TouchingRow> rows{{.first = 0, .second = 1, .normal = {1.0, 0.0, 0.0}}};
  const std::vector<double> radius{0.01, 0.02};
  const Motions motions = motions_of(rows, radius, Arm::radius, true);
  EXPECT_EQ(motions.rounds, 0);
  EXPECT_EQ(norm(motions.of[0].displacement), 0.0);
}

}  // namespace
}  // namespace packmpi::handover
