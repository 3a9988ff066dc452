/// Surfaces to test with.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "mesh/read.hpp"
#include "mesh/vectors.hpp"

namespace packmpi::testing {

using mesh::Corners;
using Soup = std::vector<Corners>;

/// Four corners, anticlockwise from outside, as n x n pairs of triangles.
inline void add_quad(Soup& soup, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, int n = 1) {
  const auto at = [&](int i, int j) {
    const double u = double(i) / n, v = double(j) / n;
    Vec3 x{};
    for (std::size_t k = 0; k < 3; ++k) {
      x[k] = (1 - u) * ((1 - v) * a[k] + v * d[k]) + u * ((1 - v) * b[k] + v * c[k]);
    }
    return x;
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      soup.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      soup.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
}

/// A prism over a polygon, anticlockwise from above, whose floor and lid are cut into the quads `quads` of its corners.
inline Soup prism(const std::vector<std::array<double, 2>>& corners,
                  const std::vector<std::array<std::size_t, 4>>& quads, double low, double high, int n = 1) {
  Soup soup;
  const auto at = [&](std::size_t k, double z) { return Vec3{corners[k][0], corners[k][1], z}; };
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const std::size_t next = (k + 1) % corners.size();
    add_quad(soup, at(k, low), at(next, low), at(next, high), at(k, high), n);
  }
  for (const auto& q : quads) {
    add_quad(soup, at(q[0], high), at(q[1], high), at(q[2], high), at(q[3], high), n);
    add_quad(soup, at(q[3], low), at(q[2], low), at(q[1], low), at(q[0], low), n);
  }
  return soup;
}

inline Soup box(const Vec3& low, const Vec3& high, int n = 1) {
  return prism({{low[0], low[1]}, {high[0], low[1]}, {high[0], high[1]}, {low[0], high[1]}}, {{0, 1, 2, 3}}, low[2],
               high[2], n);
}

/// An L of three unit squares: [0, 2] x [0, 1] and [0, 1] x [1, 2], of height h.
inline Soup l_prism(double h, int n = 1) {
  return prism({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}, {0, 1}},
               {{0, 1, 4, 7}, {1, 2, 3, 4}, {7, 4, 5, 6}}, 0.0, h, n);
}

/// A hopper: a pyramid's stump of height 1 below a prism of height 1; 2 wide above, `outlet` below, about the axis.
inline Soup hopper(double outlet, int n = 1) {
  Soup soup;
  const auto ring = [](double half, double z) {
    return std::array<Vec3, 4>{{{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}}};
  };
  const auto a = ring(0.5 * outlet, 0.0), b = ring(1.0, 1.0), c = ring(1.0, 2.0);
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    add_quad(soup, a[k], a[next], b[next], b[k], n);
    add_quad(soup, b[k], b[next], c[next], c[k], n);
  }
  add_quad(soup, c[0], c[1], c[2], c[3], n);
  add_quad(soup, a[3], a[2], a[1], a[0], n);
  return soup;
}

/// Of radius 1 about the origin: an octahedron whose triangles are cut in four `times` times.
inline Soup ball(int times) {
  Soup soup;
  for (int k = 0; k < 8; ++k) {
    const Vec3 x{k & 1 ? -1.0 : 1.0, 0, 0}, y{0, k & 2 ? -1.0 : 1.0, 0}, z{0, 0, k & 4 ? -1.0 : 1.0};
    const bool even = ((k & 1) + (k >> 1 & 1) + (k >> 2)) % 2 == 0;
    soup.push_back(even ? Corners{x, y, z} : Corners{x, z, y});
  }
  const auto between = [](const Vec3& a, const Vec3& b) { return mesh::unit(mesh::plus(a, b)); };
  for (; times > 0; --times) {
    Soup finer;
    for (const auto& [a, b, c] : soup) {
      const Vec3 ab = between(a, b), bc = between(b, c), ca = between(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    soup = finer;
  }
  return soup;
}

/// Every corner by a function.
template <class Move>
Soup moved(Soup soup, const Move& move) {
  for (Corners& corners : soup) {
    for (Vec3& x : corners) x = move(x);
  }
  return soup;
}

/// A turn about two axes.
inline Vec3 turned(const Vec3& x, double a, double b) {
  const Vec3 y{std::cos(a) * x[0] - std::sin(a) * x[1], std::sin(a) * x[0] + std::cos(a) * x[1], x[2]};
  return {y[0], std::cos(b) * y[1] - std::sin(b) * y[2], std::sin(b) * y[1] + std::cos(b) * y[2]};
}

class Dice {
 public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  double operator()(double low, double high) { return low + (high - low) * (double(engine_() >> 11) * 0x1p-53); }
  Vec3 point(double low, double high) {
    const double x = (*this)(low, high), y = (*this)(low, high);
    return {x, y, (*this)(low, high)};
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace packmpi::testing
