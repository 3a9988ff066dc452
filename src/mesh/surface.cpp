#include "mesh/surface.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "base/digest.hpp"
#include "mesh/vectors.hpp"

namespace packmpi::mesh {
namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

std::uint64_t digest_of(const Shell& shell) {
  std::uint64_t hash = fnv_start;
  for (std::size_t t = 0; t < shell.triangles.size(); ++t) {
    const Corners c = shell.corners(t);
    std::array<char, sizeof c> bytes{};
    std::memcpy(bytes.data(), c.data(), sizeof c);
    hash = fnv_add(hash, {bytes.data(), bytes.size()});
  }
  return hash;
}

}  // namespace

Surface::Surface(const std::vector<Corners>& triangles, const std::string& name)
    : shell_(close(triangles, name)), grid_(shell_), features_(shell_), digest_(digest_of(shell_)) {
  weigh_points();
  fill_cells();
  volume_ = volume_below(2.0 * shell_.high[2] - shell_.low[2]);
}

void Surface::weigh_points() {
  spot_.resize(shell_.triangles.size());
  point_.assign(shell_.points.size(), {});
  for (std::size_t t = 0; t < spot_.size(); ++t) {
    const Corners c = shell_.corners(t);
    const Vec3 middle = times(1.0 / 3.0, plus(c[0], plus(c[1], c[2])));
    double reach = 0.0;
    for (const Vec3& corner : c) reach = std::max(reach, norm(minus(corner, middle)));
    spot_[t] = {unit(shell_.normal(t)), middle, reach};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 a = minus(c.at((k + 1) % 3), c.at(k)), b = minus(c.at((k + 2) % 3), c.at(k));
      Vec3& sum = point_[static_cast<std::size_t>(shell_.triangles[t].at(k))];
      sum = plus(sum, times(angle_of(dot(a, b), norm(cross(a, b))), spot_[t].normal));
    }
  }
}

// Steps from the cells that the surface meets; the others hang together in regions that are in the interior or outside.
void Surface::fill_cells() {
  constexpr std::int16_t unknown = -1, most = 10000;
  const std::int64_t cells = grid_.cells();
  std::vector<std::int64_t> open, next;
  clear_.assign(static_cast<std::size_t>(cells), unknown);
  for (std::int64_t c = 0; c < cells; ++c) {
    if (!grid_.is_empty(c)) clear_[static_cast<std::size_t>(c)] = 0, open.push_back(c);
  }
  for (std::int16_t steps = 1; !open.empty();
       steps = std::min<std::int16_t>(static_cast<std::int16_t>(steps + 1), most)) {
    next.clear();
    for (const std::int64_t c : open) {
      grid_.around(c, false, [&](std::int64_t other) {
        if (std::int16_t& here = clear_[static_cast<std::size_t>(other)]; here == unknown) {
          here = steps;
          next.push_back(other);
        }
      });
    }
    std::swap(open, next);
  }
  std::vector<bool> seen(clear_.size());
  for (std::int64_t seed = 0; seed < cells; ++seed) {
    if (seen[static_cast<std::size_t>(seed)] || clear_[static_cast<std::size_t>(seed)] == 0) continue;
    const bool outside = nearest(grid_.middle(seed)).distance < 0.0;
    seen[static_cast<std::size_t>(seed)] = true;
    open.assign(1, seed);
    while (!open.empty()) {
      const std::int64_t c = open.back();
      open.pop_back();
      grid_.around(c, true, [&](std::int64_t other) {
        const auto at = static_cast<std::size_t>(other);
        if (seen[at] || clear_[at] == 0) return;
        seen[at] = true;
        open.push_back(other);
      });
      if (std::int16_t& here = clear_[static_cast<std::size_t>(c)]; outside) here = static_cast<std::int16_t>(-here);
    }
  }
}

// Ericson, Real-Time Collision Detection (2005), 5.1.5.
Surface::Hit Surface::hit(const Vec3& x, int triangle) const {
  const Corners c = shell_.corners(static_cast<std::size_t>(triangle));
  const auto found = [&](const Vec3& place, int feature) {
    const Vec3 d = minus(x, place);
    return Hit{dot(d, d), place, triangle, feature};
  };
  const Vec3 ab = minus(c[1], c[0]), ac = minus(c[2], c[0]), ax = minus(x, c[0]);
  const double d1 = dot(ab, ax), d2 = dot(ac, ax);
  if (d1 <= 0.0 && d2 <= 0.0) return found(c[0], 0);
  const Vec3 bx = minus(x, c[1]);
  const double d3 = dot(ab, bx), d4 = dot(ac, bx);
  if (d3 >= 0.0 && d4 <= d3) return found(c[1], 1);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return found(plus(c[0], times(d1 / (d1 - d3), ab)), 3);
  const Vec3 cx = minus(x, c[2]);
  const double d5 = dot(ab, cx), d6 = dot(ac, cx);
  if (d6 >= 0.0 && d5 <= d6) return found(c[2], 2);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return found(plus(c[0], times(d2 / (d2 - d6), ac)), 5);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    return found(plus(c[1], times((d4 - d3) / ((d4 - d3) + (d5 - d6)), minus(c[2], c[1]))), 4);
  }
  const double whole = va + vb + vc;
  return found(plus(c[0], plus(times(vb / whole, ab), times(vc / whole, ac))), 6);
}

Vec3 Surface::outward(const Hit& hit) const {
  const auto t = static_cast<std::size_t>(hit.triangle);
  if (hit.feature < 3) {
    return point_[static_cast<std::size_t>(shell_.triangles[t].at(static_cast<std::size_t>(hit.feature)))];
  }
  if (hit.feature == 6) return spot_[t].normal;
  const int other = shell_.neighbours[t].at(static_cast<std::size_t>(hit.feature - 3));
  return plus(spot_[t].normal, spot_[static_cast<std::size_t>(other)].normal);
}

// By the disc around it in its plane. Wrong for the sake of rounding only where the range is a millionth of the
// triangle.
inline bool Surface::may_be_near(const Vec3& x, int triangle, double range) const {
  const Spot& spot = spot_[static_cast<std::size_t>(triangle)];
  const Vec3 d = minus(x, spot.middle);
  const double away = dot(spot.normal, d), squared = away * away;
  const double disc = range * range - (1.0 - 1e-9) * squared;
  if (!(disc > 0.0)) return false;
  const double reach = spot.reach + std::sqrt(disc);
  return (1.0 - 1e-9) * dot(d, d) < squared + reach * reach;
}

Nearest Surface::nearest(const Vec3& x) const {
  double outside = 0.0;  // of the box around the surface
  for (std::size_t a = 0; a < 3; ++a) {
    const double beyond = std::max({0.0, shell_.low[a] - x[a], x[a] - shell_.high[a]});
    outside += beyond * beyond;
  }
  Hit best{endless, {}, -1, 6};
  double distance = endless;
  const auto look = [&](int t) {
    if (!may_be_near(x, t, distance)) return;
    if (const Hit here = hit(x, t); here.squared < best.squared) best = here, distance = std::sqrt(best.squared);
  };
  if (!grid_.is_empty(grid_.cell_of(x))) grid_.each_in_ball(x, 0.0, look);  // most of them are very near
  for (double half = std::sqrt(outside) + grid_.width();; half *= 2.0) {
    if (best.triangle >= 0) half = distance * (1.0 + 1e-12);
    grid_.each_in_ball(x, half, look);
    if (best.squared <= half * half) break;
  }
  return {dot(minus(x, best.place), outward(best)) > 0.0 ? -distance : distance, best.place};
}

double Surface::distance(const Vec3& x, double range) const {
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(x[a] > shell_.low[a] - range && x[a] < shell_.high[a] + range)) return -range;
  }
  if (is_clear(x, range)) return clear_[static_cast<std::size_t>(grid_.cell_of(x))] > 0 ? range : -range;
  return std::clamp(nearest(x).distance, -range, range);
}

bool Surface::fits(const Vec3& x, double r) const {
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(x[a] > shell_.low[a] && x[a] < shell_.high[a])) return false;
  }
  const int steps = clear_[static_cast<std::size_t>(grid_.cell_of(x))];
  if (steps < 0) return false;
  if ((steps - 1) * grid_.width() >= r) return true;
  const auto too_near = [&](int t) { return may_be_near(x, t, r) && std::sqrt(hit(x, t).squared) < r; };
  if (steps == 0 && grid_.any_in_ball(x, 0.0, too_near)) return false;
  if (grid_.any_in_ball(x, r, too_near)) return false;
  return steps > 0 || side_of(x, (1.0 - 1e-9) * r) > 0;
}

// All within `clear` is on one side, and cells without triangles tell on which.
int Surface::side_of(const Vec3& x, double clear) const {
  for (std::size_t a = 0; a < 3; ++a) {
    for (const double off : {-clear, clear}) {
      Vec3 beside = x;
      beside[a] += off;
      if (const int steps = clear_[static_cast<std::size_t>(grid_.cell_of(beside))]; steps != 0) return steps;
    }
  }
  return nearest(x).distance > 0.0 ? 1 : -1;
}

double Surface::beyond(const Vec3& x) const {
  if (!(x[0] - x[0] == 0.0 && x[1] - x[1] == 0.0 && x[2] - x[2] == 0.0)) return x[0] + x[1] + x[2];
  const int steps = clear_[static_cast<std::size_t>(grid_.cell_of(x))];
  constexpr double somewhat = 1e-300;  // inside, wherever that is
  if (steps > 0) return -std::max((steps - 1) * grid_.width(), somewhat);
  const double off = 0.5 * grid_.width();
  return steps == 0 && fits(x, off) ? -off : -nearest(x).distance;
}

Vec3 Surface::draw(const Vec3& u, double r, double low, double high) const {
  constexpr int most = 256;
  const Vec3 from{shell_.low[0] + r, shell_.low[1] + r, std::max(low, shell_.low[2] + r)};
  const Vec3 to{shell_.high[0] - r, shell_.high[1] - r, std::min(high, shell_.high[2] - r)};
  Vec3 now = u;
  std::uint64_t state = 0;
  for (const double one : u) state = stir(state ^ std::bit_cast<std::uint64_t>(one));
  for (int k = 0; k < most; ++k) {
    Vec3 x{};
    for (std::size_t a = 0; a < 3; ++a) x[a] = from[a] + now[a] * (to[a] - from[a]);
    if (to[2] >= from[2] && fits(x, r)) return x;
    for (double& one : now) one = static_cast<double>((state = stir(state)) >> 11U) * 0x1p-53;
  }
  return {0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1]), std::nan("")};
}

void Surface::touches(const Vec3& x, double range, double deepest,
                      const std::function<void(std::int32_t, const Touch&)>& found) const {
  NearFeatures close;
  near(x, range, deepest, close);
  const Table table = features_.table(deepest);
  for (std::size_t k = 0; k < close.feature.size(); ++k) {
    const Touch here =
        touch(table, close.feature[k], close.triangles.data(), close.begin(k), close.end[k], x.data(), far_away);
    if (here.distance < range) found(close.feature[k], here);
  }
}

// Of a face's triangles the one with the nearest middle comes first: most often it is the one that is asked for.
void Surface::near(const Vec3& x, double range, double deepest, NearFeatures& found) const {
  found.clear();
  if (is_clear(x, range)) return;
  const Table table = features_.table(deepest);
  const double square = range * range;
  const auto close_to = [&](const Vec3& place) { return dot(minus(x, place), minus(x, place)) < square; };
  found.hits.clear();
  found.seen.resize(shell_.triangles.size());
  ++found.search;
  grid_.each_in_ball(x, range, [&](int t) {
    std::uint32_t& seen = found.seen[static_cast<std::size_t>(t)];
    if (seen == found.search) return;
    seen = found.search;
    if (!may_be_near(x, t, range)) return;
    const Vec3 d = minus(x, spot_[static_cast<std::size_t>(t)].middle);
    found.hits.push_back({t, dot(d, d)});
  });
  for (const auto& [t, squared] : found.hits) {
    const std::int32_t face = features_.face_of(static_cast<std::size_t>(t));
    const double* plane = table.faces + 4 * std::int64_t{face};
    if (plane[3] - along(plane, x.data()) > -(deepest + range)) found.feature.push_back(face);
    const Corners c = shell_.corners(static_cast<std::size_t>(t));
    for (std::size_t k = 0; k < 3; ++k) {
      if (const std::int32_t corner = features_.corners_of(static_cast<std::size_t>(t)).at(k);
          corner >= 0 && close_to(c.at(k))) {
        found.feature.push_back(corner);
      }
      const std::int32_t edge = features_.edges_of(static_cast<std::size_t>(t)).at(k);
      if (edge < 0) continue;
      const Vec3 side = minus(c.at((k + 1) % 3), c.at(k));
      const double u = std::clamp(dot(minus(x, c.at(k)), side) / dot(side, side), 0.0, 1.0);
      if (close_to(plus(c.at(k), times(u, side)))) found.feature.push_back(edge);
    }
  }
  std::ranges::sort(found.feature);
  found.feature.erase(std::unique(found.feature.begin(), found.feature.end()), found.feature.end());
  for (const std::int32_t feature : found.feature) {
    if (feature < features_.edge_begin()) {
      const std::size_t first = found.triangles.size();
      double least = endless;
      for (const auto& [t, squared] : found.hits) {
        if (features_.face_of(static_cast<std::size_t>(t)) != feature) continue;
        found.triangles.push_back(t);
        if (squared < least) least = squared, std::swap(found.triangles[first], found.triangles.back());
      }
    }
    found.end.push_back(static_cast<std::int32_t>(found.triangles.size()));
  }
}

Touch Surface::touch_of(std::int32_t feature, const Vec3& x, double deepest) const {
  const Table table = features_.table(deepest);
  if (feature >= features_.edge_begin()) return touch(table, feature, nullptr, 0, 0, x.data(), far_away);
  const double* plane = table.faces + 4 * std::int64_t{feature};
  const double height = plane[3] - along(plane, x.data()), margin = shell_.tolerance;
  std::vector<int> near;
  Vec3 low{}, high{};  // around the foot
  for (std::size_t a = 0; a < 3; ++a) {
    const double foot = x[a] + height * plane[a];
    low[a] = foot - 4.0 * margin, high[a] = foot + 4.0 * margin;
  }
  grid_.in_box(low, high, near);
  std::erase_if(near, [&](int t) { return features_.face_of(static_cast<std::size_t>(t)) != feature; });
  return touch(table, feature, near.data(), 0, static_cast<std::int32_t>(near.size()), x.data(), far_away);
}

}  // namespace packmpi::mesh
