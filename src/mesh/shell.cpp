#include "mesh/shell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <unordered_map>

#include "base/digest.hpp"
#include "base/elementary.hpp"
#include "base/error.hpp"
#include "mesh/bodies.hpp"
#include "mesh/vectors.hpp"

namespace packmpi::mesh {
namespace {

constexpr int most_parts = 1000;

[[noreturn]] void refuse_shell(const std::string& name, const std::string& words) {
  throw Error(ExitCode::bad_input, fmt::format("{}: {}", name, words));
}

std::string place(const Vec3& x) { return fmt::format("({:g}, {:g}, {:g}) m", x[0], x[1], x[2]); }

std::size_t at(int number) { return static_cast<std::size_t>(number); }

/// Corners as points, each once: the first that comes is kept. A hash of cells twice as wide as the tolerance.
class Weld {
 public:
  explicit Weld(Shell& shell) : shell_(&shell), inverse_(1.0 / (2.0 * shell.tolerance)) {}

  int number(const Vec3& x) {
    std::array<std::int64_t, 3> cell{}, side{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double place = (x[a] - shell_->low[a]) * inverse_;
      cell[a] = static_cast<std::int64_t>(std::floor(place));
      side[a] = place - std::floor(place) < 0.5 ? -1 : 1;
    }
    for (int k = 0; k < 8; ++k) {
      const auto [begin, end] = cells_.equal_range(
          key(cell[0] + (k & 1) * side[0], cell[1] + (k >> 1 & 1) * side[1], cell[2] + (k >> 2) * side[2]));
      for (auto one = begin; one != end; ++one) {
        if (norm(minus(shell_->points[at(one->second)], x)) <= shell_->tolerance) return one->second;
      }
    }
    shell_->points.push_back(x);
    const int number = static_cast<int>(shell_->points.size()) - 1;
    cells_.emplace(key(cell[0], cell[1], cell[2]), number);
    return number;
  }

 private:
  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    return stir(static_cast<std::uint64_t>(x) +
                stir(static_cast<std::uint64_t>(y) + stir(static_cast<std::uint64_t>(z))));
  }
  Shell* shell_;
  double inverse_;
  std::unordered_multimap<std::uint64_t, int> cells_;
};

void join_corners(Shell& shell, const std::vector<Corners>& triangles, const std::string& name) {
  const auto [low, high] = box_around(triangles);
  shell.low = low, shell.high = high;
  const Vec3 size = minus(shell.high, shell.low);
  const double largest = *std::ranges::max_element(size), smallest = *std::ranges::min_element(size);
  if (!(smallest > 1e-5 * largest) || !(largest < 1e100) || !(largest > 1e-100)) {
    refuse_shell(name,
                 fmt::format("it is {:g} x {:g} x {:g} m large and encloses no volume", size[0], size[1], size[2]));
  }
  shell.tolerance = 1e-6 * largest;
  Weld weld(shell);
  for (const Corners& corners : triangles) {
    const std::array<int, 3> t{weld.number(corners[0]), weld.number(corners[1]), weld.number(corners[2])};
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
      ++shell.mended.dropped;
    } else {
      shell.triangles.push_back(t);
    }
  }
}

/// Edge k of a triangle, from its corner k to the next.
struct Edge {
  int low, high;  // points
  int triangle, k;
};

std::vector<Edge> edges_of(const Shell& shell) {
  std::vector<Edge> edges;
  edges.reserve(3 * shell.triangles.size());
  for (std::size_t t = 0; t < shell.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = shell.triangles[t].at(at(k)), b = shell.triangles[t].at(at((k + 1) % 3));
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<int>(t), k});
    }
  }
  std::ranges::sort(edges, [](const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.triangle, a.k) < std::tie(b.low, b.high, b.triangle, b.k);
  });
  return edges;
}

void meet_neighbours(Shell& shell, const std::string& name) {
  const std::vector<Edge> edges = edges_of(shell);
  shell.neighbours.assign(shell.triangles.size(), {-1, -1, -1});
  std::int64_t open = 0, crowded = 0;
  const Edge* first = nullptr;
  for (std::size_t e = 0; e < edges.size();) {
    std::size_t end = e + 1;
    while (end < edges.size() && edges[end].low == edges[e].low && edges[end].high == edges[e].high) ++end;
    open += static_cast<int>(end - e == 1), crowded += static_cast<int>(end - e > 2);
    if (end - e != 2 && first == nullptr) first = &edges[e];
    if (end - e == 2) {
      shell.neighbours[at(edges[e].triangle)].at(at(edges[e].k)) = edges[e + 1].triangle;
      shell.neighbours[at(edges[e + 1].triangle)].at(at(edges[e + 1].k)) = edges[e].triangle;
    }
    e = end;
  }
  if (first == nullptr) return;
  const std::string where =
      fmt::format("from {} to {}", place(shell.points[at(first->low)]), place(shell.points[at(first->high)]));
  if (open > 0) {
    refuse_shell(name, fmt::format("the surface is open: {} edges belong to one triangle only, {} {}; close it in the "
                                   "program that made it",
                                   open, crowded > 0 ? "an edge that is wrong goes" : "the first", where));
  }
  refuse_shell(name,
               fmt::format("{} edges belong to more than two triangles, the first {}: surfaces that touch have to "
                           "be joined or parted, and triangles that are there twice left out",
                           crowded, where));
}

void turn(Shell& shell, std::size_t triangle) {  // (a, b, c) to (a, c, b): edges ab, bc, ca to ac, cb, ba
  std::swap(shell.triangles[triangle][1], shell.triangles[triangle][2]);
  std::swap(shell.neighbours[triangle][0], shell.neighbours[triangle][2]);
}

/// Does triangle `t` have an edge from point a to point b, in this direction?
bool runs(const Shell& shell, std::size_t t, int a, int b) {
  const auto& p = shell.triangles[t];
  return (p[0] == a && p[1] == b) || (p[1] == a && p[2] == b) || (p[2] == a && p[0] == b);
}

/// Parts that hang together, all of whose triangles look to the same side: the part of each triangle.
std::vector<int> same_side(Shell& shell, const std::string& name) {
  std::vector<int> part(shell.triangles.size(), -1);
  std::vector<std::size_t> open;
  shell.mended.parts = 0;
  for (std::size_t seed = 0; seed < part.size(); ++seed) {
    if (part[seed] >= 0) continue;
    part[seed] = shell.mended.parts++;
    open.push_back(seed);
    while (!open.empty()) {
      const std::size_t t = open.back();
      open.pop_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const auto other = at(shell.neighbours[t].at(k));
        const bool alike = runs(shell, other, shell.triangles[t].at(k), shell.triangles[t].at((k + 1) % 3));
        if (part[other] >= 0) {
          if (alike) refuse_shell(name, "the surface has one side only: it encloses no volume");
          continue;
        }
        if (alike) turn(shell, other);
        part[other] = part[seed];
        open.push_back(other);
      }
    }
  }
  if (shell.mended.parts > most_parts) {
    refuse_shell(name, fmt::format("it is in {} pieces, and {} are the limit", shell.mended.parts, most_parts));
  }
  return part;
}

double six_volumes(const Corners& c, const Vec3& from) {
  return dot(minus(c[0], from), cross(minus(c[1], from), minus(c[2], from)));
}

/// A part of the surface and the box around it.
struct Part {
  std::vector<std::size_t> triangles;
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
};

std::vector<Part> parts_of(const Shell& shell, const std::vector<int>& part) {
  std::vector<Part> parts(at(shell.mended.parts));
  for (std::size_t t = 0; t < part.size(); ++t) {
    Part& one = parts[at(part[t])];
    one.triangles.push_back(t);
    for (const Vec3& x : shell.corners(t)) {
      for (std::size_t a = 0; a < 3; ++a)
        one.low[a] = std::min(one.low[a], x[a]), one.high[a] = std::max(one.high[a], x[a]);
    }
  }
  return parts;
}

/// Does a part go around a point? By the angle under which it is seen (van Oosterom and Strackee 1983).
bool goes_around(const Shell& shell, const Part& part, const Vec3& x) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (x[a] < part.low[a] || x[a] > part.high[a]) return false;
  }
  double sum = 0.0;
  for (const std::size_t t : part.triangles) {
    const Corners c = shell.corners(t);
    const Vec3 a = minus(c[0], x), b = minus(c[1], x), d = minus(c[2], x);
    const double la = norm(a), lb = norm(b), ld = norm(d);
    sum += 2.0 * std::atan2(dot(a, cross(b, d)), la * lb * ld + dot(a, b) * ld + dot(b, d) * la + dot(d, a) * lb);
  }
  return std::abs(sum) > 2.0 * std::numbers::pi;
}

/// The outermost look outside, those inside them are holes and look the other way, and so on.
void look_outside(Shell& shell, const std::vector<int>& part, const std::string& name) {
  const std::vector<Part> parts = parts_of(shell, part);
  std::vector<bool> wrong(parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const Vec3 first = shell.corners(parts[p].triangles.front())[0];
    double volume = 0.0;
    for (const std::size_t t : parts[p].triangles) volume += six_volumes(shell.corners(t), first) / 6.0;
    if (!(std::abs(volume) > shell.tolerance * shell.tolerance * shell.tolerance)) {
      refuse_shell(name, fmt::format("the part of the surface at {} encloses no volume", place(first)));
    }
    int depth = 0;
    for (std::size_t other = 0; other < parts.size(); ++other) {
      depth += static_cast<int>(other != p && goes_around(shell, parts[other], first));
    }
    wrong[p] = (volume < 0.0) != (depth % 2 == 1);
  }
  for (std::size_t t = 0; t < part.size(); ++t) {
    if (wrong[at(part[t])]) turn(shell, t);
  }
}

/// Numbers points as they come up in the triangles, so that what is written and read again is the same.
void number_points(Shell& shell) {
  std::vector<int> number(shell.points.size(), -1);
  std::vector<Vec3> points;
  for (auto& triangle : shell.triangles) {
    for (int& point : triangle) {
      int& now = number[at(point)];
      if (now < 0) {
        now = static_cast<int>(points.size());
        points.push_back(shell.points[at(point)]);
      }
      point = now;
    }
  }
  shell.points = std::move(points);
}

}  // namespace

double angle_of(double x, double y) noexcept {
  const double length = std::sqrt(x * x + y * y);
  if (!(length > 0.0)) return 0.0;
  const double across = std::min(1.0, y / length), along = std::min(1.0, std::abs(x) / length);
  const double small =
      across <= along ? elementary::arcsine(across) : 0.5 * std::numbers::pi - elementary::arcsine(along);
  return x >= 0.0 ? small : std::numbers::pi - small;
}

double Shell::volume() const {
  double sum = 0.0;
  for (std::size_t t = 0; t < triangles.size(); ++t) sum += six_volumes(corners(t), points.front()) / 6.0;
  return sum;
}

Vec3 Shell::normal(std::size_t triangle) const {
  const Corners c = corners(triangle);
  return cross(minus(c[1], c[0]), minus(c[2], c[0]));
}

bool Shell::is_needle(std::size_t triangle) const {
  const Corners c = corners(triangle);
  const double longest = std::max({norm(minus(c[1], c[0])), norm(minus(c[2], c[1])), norm(minus(c[0], c[2]))});
  return !(norm(normal(triangle)) > tolerance * longest);
}

std::string obj_text(const Shell& shell) {
  std::string text;
  for (const Vec3& x : shell.points) text += fmt::format("v {} {} {}\n", x[0], x[1], x[2]);
  for (const auto& t : shell.triangles) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

std::string text_stl(const Shell& shell) {
  std::string text = "solid surface\n";
  for (std::size_t t = 0; t < shell.triangles.size(); ++t) {
    const Vec3 n = unit(shell.normal(t));
    text += fmt::format("facet normal {:g} {:g} {:g}\n outer loop\n", n[0], n[1], n[2]);
    for (const Vec3& x : shell.corners(t)) text += fmt::format("  vertex {} {} {}\n", x[0], x[1], x[2]);
    text += " endloop\nendfacet\n";
  }
  return text + "endsolid surface\n";
}

Shell close(const std::vector<Corners>& triangles, const std::string& name) {
  Shell shell;
  join_corners(shell, triangles, name);
  if (shell.triangles.empty()) refuse_shell(name, "none of its triangles has an area");
  meet_neighbours(shell, name);
  const std::vector<std::array<int, 3>> before = shell.triangles;
  const std::vector<int> part = same_side(shell, name);
  look_outside(shell, part, name);
  for (std::size_t t = 0; t < before.size(); ++t) {
    shell.mended.turned += static_cast<int>(before[t] != shell.triangles[t]);
  }
  number_points(shell);
  if (const auto [one, other] = first_crossing(shell); one >= 0) {
    refuse_shell(name, fmt::format("the surface cuts itself: the triangle at {} and that at {} meet; mend it in the "
                                   "program that made it",
                                   place(shell.corners(at(one))[0]), place(shell.corners(at(other))[0])));
  }
  return shell;
}

}  // namespace packmpi::mesh
