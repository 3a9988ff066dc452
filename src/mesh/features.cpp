#include "mesh/features.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mesh/vectors.hpp"

namespace packmpi::mesh {
namespace {

constexpr double flat_angle = 1e-4;     // [rad] by which triangles of one face may differ at most
constexpr double smooth_cosine = 0.94;  // of 20 degrees: faces that meet at less are a round wall's

// Triangles in groups: each points to an earlier one of its own.
class Groups {
 public:
  explicit Groups(std::size_t count) : of_(count) { std::iota(of_.begin(), of_.end(), std::size_t{0}); }
  std::size_t first(std::size_t k) {
    while (of_[k] != k) k = of_[k] = of_[of_[k]];
    return k;
  }
  void join(std::size_t a, std::size_t b) {
    a = first(a), b = first(b);
    of_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> of_;
};

/// Across the longest of its edges, a needle lies in the plane of its neighbour.
std::size_t longest_edge(const Corners& c) {
  std::size_t longest = 0;
  double most = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double length = norm(minus(c.at((k + 1) % 3), c.at(k)));
    if (length > most) longest = k, most = length;
  }
  return longest;
}

Groups group_planes(const Shell& shell) {
  Groups groups(shell.triangles.size());
  for (std::size_t t = 0; t < shell.triangles.size(); ++t) {
    const Corners c = shell.corners(t);
    if (shell.is_needle(t)) {
      groups.join(t, static_cast<std::size_t>(shell.neighbours[t].at(longest_edge(c))));
      continue;
    }
    const Vec3 n = unit(shell.normal(t));
    for (std::size_t k = 0; k < 3; ++k) {
      const auto other = static_cast<std::size_t>(shell.neighbours[t].at(k));
      if (other < t || shell.is_needle(other)) continue;
      const Vec3 m = unit(shell.normal(other));
      if (dot(n, m) > 0.0 && norm(cross(n, m)) < flat_angle) groups.join(t, other);
    }
  }
  return groups;
}

/// One plane a group; a group that bends too much to have one falls apart into its triangles.
struct Faces {
  std::vector<Vec3> normal;
  std::vector<double> offset;
  std::vector<std::int32_t> of;  // each triangle
};

struct Sum {
  Vec3 normal{}, place{};  // weighted by areas
  double area = 0.0, least = HUGE_VAL, most = -HUGE_VAL;
};

std::vector<Sum> sums_of(const Shell& shell, Groups& groups) {
  std::vector<Sum> sums(shell.triangles.size());
  for (std::size_t t = 0; t < sums.size(); ++t) {
    Sum& sum = sums[groups.first(t)];
    const Corners c = shell.corners(t);
    const Vec3 n = shell.normal(t);
    const double area = norm(n);
    sum.normal = plus(sum.normal, n);
    sum.area += area;
    for (const Vec3& x : c) sum.place = plus(sum.place, times(area / 3.0, minus(x, shell.low)));
  }
  for (Sum& sum : sums) {
    sum.normal = unit(sum.normal);
    if (sum.area > 0.0) sum.place = times(1.0 / sum.area, sum.place);
  }
  for (std::size_t t = 0; t < sums.size(); ++t) {
    Sum& sum = sums[groups.first(t)];
    for (const Vec3& x : shell.corners(t)) {
      const double height = dot(sum.normal, minus(minus(x, shell.low), sum.place));
      sum.least = std::min(sum.least, height), sum.most = std::max(sum.most, height);
    }
  }
  return sums;
}

Faces faces_of(const Shell& shell) {
  Groups groups = group_planes(shell);
  const std::vector<Sum> sums = sums_of(shell, groups);
  Faces faces;
  faces.of.assign(shell.triangles.size(), -1);
  const auto add = [&](const Vec3& normal, const Vec3& place) {
    faces.normal.push_back(normal);
    faces.offset.push_back(dot(normal, place));
    return static_cast<std::int32_t>(faces.offset.size()) - 1;
  };
  for (std::size_t t = 0; t < faces.of.size(); ++t) {
    const std::size_t first = groups.first(t);
    const Sum& sum = sums[first];
    const bool flat = sum.most - sum.least <= 2.0 * shell.tolerance;
    if (flat && first != t) {
      faces.of[t] = faces.of[first];
    } else if (flat) {
      faces.of[t] = add(sum.normal, plus(shell.low, sum.place));
    } else if (!shell.is_needle(t)) {
      faces.of[t] = add(unit(shell.normal(t)), shell.corners(t)[0]);
    }
  }
  for (std::size_t t = 0; t < faces.of.size(); ++t) {  // needles of groups that fell apart
    for (std::size_t k = 0; k < 3 && faces.of[t] < 0; ++k) {
      faces.of[t] = faces.of[static_cast<std::size_t>(shell.neighbours[t].at(k))];
    }
    if (faces.of[t] < 0) faces.of[t] = add(unit(shell.normal(t)), shell.corners(t)[0]);
  }
  return faces;
}

void push(std::vector<double>& to, const Vec3& x) { to.insert(to.end(), x.begin(), x.end()); }

}  // namespace

Features::Features(const Shell& shell) {
  find_faces(shell);
  find_sides(shell);
  find_edges(shell);
  find_corners(shell);
  find_patches(shell);
}

void Features::find_faces(const Shell& shell) {
  const Faces faces = faces_of(shell);
  face_of_ = faces.of;
  for (std::size_t f = 0; f < faces.offset.size(); ++f) {
    push(faces_, faces.normal[f]);
    faces_.push_back(faces.offset[f]);
  }
  edge_begin_ = static_cast<std::int32_t>(faces.offset.size());
}

// Directions of an edge are made from its lower point to the higher one, so that of a seam both sides are opposite to
// the bit. A needle holds no foot.
void Features::find_sides(const Shell& shell) {
  triangles_.reserve(12 * shell.triangles.size());
  for (std::size_t t = 0; t < shell.triangles.size(); ++t) {
    const double* plane = faces_.data() + 4 * static_cast<std::size_t>(face_of_[t]);
    const Vec3 normal{plane[0], plane[1], plane[2]};
    const bool needle = shell.is_needle(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = shell.triangles[t].at(k), b = shell.triangles[t].at((k + 1) % 3);
      const Vec3& low = shell.points[static_cast<std::size_t>(std::min(a, b))];
      const Vec3& high = shell.points[static_cast<std::size_t>(std::max(a, b))];
      const Vec3 inward = unit(cross(normal, unit(minus(high, low))));
      const double sign = a < b ? 1.0 : -1.0;
      push(triangles_, times(sign, inward));
      triangles_.push_back(needle ? HUGE_VAL : sign * dot(inward, low));
    }
  }
}

void Features::find_edges(const Shell& shell) {
  edges_of_.assign(shell.triangles.size(), {-1, -1, -1});
  for (std::size_t t = 0; t < shell.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto other = static_cast<std::size_t>(shell.neighbours[t].at(k));
      const int a = shell.triangles[t].at(k), b = shell.triangles[t].at((k + 1) % 3);
      if (a > b || face_of_[t] == face_of_[other]) continue;  // once
      std::size_t across = 0;
      while (shell.triangles[other].at(across) != b || shell.triangles[other].at((across + 1) % 3) != a) ++across;
      const double* mine = side(t, k);
      const double* its = side(other, across);
      const double* plane = faces_.data() + 4 * static_cast<std::size_t>(face_of_[t]);
      if (!(along(its, plane) > 1e-9)) continue;  // an inner corner of the interior
      const Vec3 &from = shell.points[static_cast<std::size_t>(a)], &to = shell.points[static_cast<std::size_t>(b)];
      const Vec3 direction = unit(minus(to, from));
      const auto number = edge_begin_ + static_cast<std::int32_t>(edges_.size() / 16);
      edges_of_[t].at(k) = edges_of_[other].at(across) = number;
      push(edges_, from);
      push(edges_, direction);
      edges_.push_back(dot(direction, from));
      edges_.push_back(dot(direction, to));
      // Of a needle the offset is not known by its triangle.
      for (const double* into : {mine, its}) {
        const Vec3 inward{into[0], into[1], into[2]};
        push(edges_, inward);
        edges_.push_back(std::isfinite(into[3]) ? into[3] : dot(inward, from));
      }
    }
  }
  corner_begin_ = edge_begin_ + static_cast<std::int32_t>(edges_.size() / 16);
}

void Features::find_corners(const Shell& shell) {
  std::vector<std::int32_t> number(shell.points.size(), -1);
  corners_of_.assign(shell.triangles.size(), {-1, -1, -1});
  std::int32_t count = 0;
  for (std::size_t t = 0; t < shell.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (edges_of_[t].at(k) < 0) continue;
      for (const std::size_t end : {k, (k + 1) % 3}) {
        const auto point = static_cast<std::size_t>(shell.triangles[t].at(end));
        if (number[point] >= 0) continue;
        number[point] = corner_begin_ + count++;
        push(corners_, shell.points[point]);
      }
    }
  }
  std::vector<std::vector<std::array<int, 2>>> spokes(static_cast<std::size_t>(count));  // from, to
  for (std::size_t t = 0; t < shell.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = shell.triangles[t].at(k), b = shell.triangles[t].at((k + 1) % 3);
      corners_of_[t].at(k) = number[static_cast<std::size_t>(a)];
      if (corners_of_[t].at(k) >= 0) {  // each edge at a point begins there in one of both its triangles
        spokes[static_cast<std::size_t>(corners_of_[t].at(k) - corner_begin_)].push_back({a, b});
      }
    }
  }
  for (const auto& all : spokes) {
    for (const auto& [a, b] : all) {
      const Vec3& low = shell.points[static_cast<std::size_t>(std::min(a, b))];
      const Vec3& high = shell.points[static_cast<std::size_t>(std::max(a, b))];
      const Vec3 direction = unit(minus(high, low));
      const double sign = a < b ? 1.0 : -1.0;  // as in find_edges, to the bit
      push(spokes_, times(sign, direction));
      spokes_.push_back(sign * dot(direction, shell.points[static_cast<std::size_t>(a)]));
    }
    spokes_of_.push_back(static_cast<std::int32_t>(spokes_.size() / 4));
  }
}

void Features::find_patches(const Shell& shell) {
  const auto normal = [&](std::int32_t face) { return faces_.data() + 4 * static_cast<std::size_t>(face); };
  Groups groups(static_cast<std::size_t>(edge_begin_));
  patch_.resize(static_cast<std::size_t>(count()));
  std::iota(patch_.begin(), patch_.end(), 0);
  const auto each_side = [&](auto&& see) {  // triangle, number of its side, faces on both sides of it
    for (std::size_t t = 0; t < shell.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        see(t, k, face_of_[t], face_of_[static_cast<std::size_t>(shell.neighbours[t].at(k))]);
      }
    }
  };
  const auto smooth = [&](std::int32_t a, std::int32_t b) { return along(normal(a), normal(b)) > smooth_cosine; };
  each_side([&](std::size_t, std::size_t, std::int32_t a, std::int32_t b) {
    if (smooth(a, b)) groups.join(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
  });
  for (std::size_t f = 0; f < static_cast<std::size_t>(edge_begin_); ++f) {
    patch_[f] = static_cast<std::int32_t>(groups.first(f));
  }
  std::vector<bool> alone(patch_.size());
  each_side([&](std::size_t t, std::size_t k, std::int32_t a, std::int32_t b) {
    const std::int32_t edge = edges_of_[t].at(k);
    if (edge >= 0 && smooth(a, b)) patch_[static_cast<std::size_t>(edge)] = patch_[static_cast<std::size_t>(a)];
    for (const std::size_t end : {k, (k + 1) % 3}) {
      const std::int32_t corner = corners_of_[t].at(end);
      if (corner < 0) continue;
      const auto c = static_cast<std::size_t>(corner);
      const std::int32_t patch = patch_[static_cast<std::size_t>(a)];
      const bool first = patch_[c] == corner;
      if ((edge >= 0 && !smooth(a, b)) || (!first && patch_[c] != patch)) alone[c] = true;
      patch_[c] = patch;
    }
  });
  for (std::size_t c = 0; c < alone.size(); ++c) {
    if (alone[c]) patch_[c] = static_cast<std::int32_t>(c);
  }
}

std::size_t Features::bytes() const noexcept {
  return (faces_.capacity() + triangles_.capacity() + edges_.capacity() + corners_.capacity() + spokes_.capacity()) *
             sizeof(double) +
         (spokes_of_.capacity() + face_of_.capacity() + patch_.capacity() + 3 * edges_of_.capacity() +
          3 * corners_of_.capacity()) *
             sizeof(std::int32_t);
}

}  // namespace packmpi::mesh
