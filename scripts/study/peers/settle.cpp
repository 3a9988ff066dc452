// A small serial DEM program, written from the equations alone (doc/theory.md), to be a third opinion on densities: it shares no line with packmpi.
//   settle IN OUT key=value ...          IN, OUT: lines "x y z r"; OUT adds the spin, net force and contacts of each sphere
// Spheres in a box with a floor at z = 0, lateral axes periodic or between planes; Hertz contacts with damping xi, friction with memory (Mindlin's
// no-slip stiffness, Coulomb's limit), rolling and twisting resistance, drag; v(t + dt) from the forces at t, then x from the new v.
// With layers=K it drops its own layers: random sequential addition of `fraction` into [top, top + thickness], `duration` each.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace {
struct Vec {
  double x = 0, y = 0, z = 0;
};
Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec operator*(double s, Vec a) { return {s * a.x, s * a.y, s * a.z}; }
double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
double norm(Vec a) { return std::sqrt(dot(a, a)); }

struct Scene {
  double width = 0, depth = 0, gravity = 9.81, density = 2500, modulus = 1e8, poisson = 0.25, xi = 0.1, mu = 0.5, rolling = 0, twisting = 0, drag = 0;
  double step = 1e-5, duration = 0.1, thickness = 0, fraction = 0.25, radius = 0;
  bool periodic = true, rotation = true;
  int layers = 0, seed = 1;
};

struct Memory {
  Vec slide, roll;         // elastic displacements of sliding and of rolling [m], in the tangent plane
  double twist = 0, a = 0;   // angle [rad]; contact radius of the step before [m]
};
struct Neighbour {
  int other;
  Memory memory;
};
struct Sphere {
  Vec x, v, w, force, torque;
  double r = 0, m = 0;
  std::vector<Neighbour> near;          // others of a larger index
  std::array<Memory, 5> walls;          // floor, x low, x high, y low, y high
  Vec built;                            // position when the neighbours were searched
};

class Pile {
 public:
  explicit Pile(const Scene& scene) : s_(scene) {}
  std::vector<Sphere> spheres;

  void add(Vec x, double r) {
    Sphere sphere;
    sphere.x = x, sphere.r = r, sphere.m = s_.density * 4.0 / 3.0 * M_PI * r * r * r;
    spheres.push_back(sphere);
    stale_ = true;
  }

  void run(double duration) {
    for (long k = 0, n = std::lround(duration / s_.step); k < n; ++k) {
      if (stale_ || moved()) { search(); }
      forces();
      move();
    }
  }

  double top() const {
    double top = 0;
    for (const auto& p : spheres) { top = std::max(top, p.x.z + p.r); }
    return top;
  }

  Vec apart(Vec a, Vec b) const {   // from a to the nearest image of b
    Vec d = b - a;
    if (s_.periodic) { d.x -= s_.width * std::round(d.x / s_.width), d.y -= s_.depth * std::round(d.y / s_.depth); }
    return d;
  }

  double kinetic() const {   // mean over m g d
    double sum = 0, scale = 0;
    for (const auto& p : spheres) {
      sum += 0.5 * p.m * dot(p.v, p.v) + 0.2 * p.m * p.r * p.r * dot(p.w, p.w), scale += p.m * s_.gravity * 2 * p.r;
    }
    return sum / scale;
  }

 private:
  double skin() const { return 0.2 * largest_; }

  bool moved() const {
    return std::any_of(spheres.begin(), spheres.end(), [&](const Sphere& p) { return norm(p.x - p.built) > 0.5 * skin(); });
  }

  void search() {
    stale_ = false, largest_ = 0;
    for (const auto& p : spheres) { largest_ = std::max(largest_, p.r); }
    const double cell = 2 * largest_ + skin();
    const int nx = std::max(1, int(s_.width / cell)), ny = std::max(1, int(s_.depth / cell));
    std::map<std::array<int, 3>, std::vector<int>> cells;
    auto place = [&](Vec x) {
      const double fx = x.x / s_.width, fy = x.y / s_.depth;
      return std::array<int, 3>{int((fx - std::floor(fx)) * nx) % nx, int((fy - std::floor(fy)) * ny) % ny, int(std::floor(x.z / cell))};
    };
    for (int i = 0; i < int(spheres.size()); ++i) { cells[place(spheres[i].x)].push_back(i); }
    for (int i = 0; i < int(spheres.size()); ++i) {
      Sphere& p = spheres[i];
      std::vector<Neighbour> before = std::move(p.near), now;
      const auto at = place(p.x);
      std::vector<std::array<int, 3>> around;
      for (int k = 0; k < 27; ++k) { around.push_back({(at[0] + k % 3 - 1 + nx) % nx, (at[1] + k / 3 % 3 - 1 + ny) % ny, at[2] + k / 9 - 1}); }
      std::sort(around.begin(), around.end());
      around.erase(std::unique(around.begin(), around.end()), around.end());   // few cells across: no pair twice
      for (const auto& key : around) {
        const auto found = cells.find(key);
        if (found == cells.end()) { continue; }
        for (int j : found->second) {
          if (j <= i || norm(apart(p.x, spheres[j].x)) > p.r + spheres[j].r + skin()) { continue; }
          const auto old = std::find_if(before.begin(), before.end(), [&](const Neighbour& n) { return n.other == j; });
          now.push_back({j, old == before.end() ? Memory{} : old->memory});
        }
      }
      p.near = std::move(now), p.built = p.x;
    }
  }

  struct Load {
    Vec force, torque, moment;   // force on the first; n x friction, to be taken with each radius; moment on the first, its opposite on the other
  };

  static void turn(Vec& t, Vec n) {   // into the tangent plane, at its length
    const double length = norm(t);
    t = t - dot(t, n) * n;
    const double left = norm(t);
    if (left > 0) { t = length / left * t; }
  }

  Vec spring(Vec& displacement, Vec velocity, Vec n, double k, double eta, double limit) const {
    turn(displacement, n);
    Vec f = k * displacement + (k * s_.step + eta) * velocity;
    const double size = norm(f);
    if (size > limit) { f = limit / size * f; }   // what spring and dashpot, in a row with the slider, move by then:
    displacement = displacement + s_.step / (k * s_.step + eta) * (f - k * displacement);
    return f;
  }

  // n from the first to the second; u the velocity of the second's surface against the first's, spin the second's spin less the first's.
  Load contact(Memory& memory, Vec n, double overlap, Vec u, Vec spin, double r, double m, double softness) const {
    const double e = softness * s_.modulus / (1 - s_.poisson * s_.poisson);   // E*, G*
    const double g = softness * s_.modulus / (2 * (1 + s_.poisson) * (2 - s_.poisson));
    const double a = std::sqrt(r * overlap), closing = -dot(u, n);
    const double normal = std::max(0.0, 4.0 / 3.0 * e * a * overlap + 2 * s_.xi * std::sqrt(2 * e * a * m) * closing);
    const double k = 8 * g * a, eta = 2 * s_.xi * std::sqrt(k * (s_.rotation ? 2.0 / 7.0 : 1.0) * m);
    // A contact that grows keeps its force, one that shrinks its displacement, so that no closed cycle gives energy.
    // The radii's ratio is taken as doc/theory.md has it, from that of the overlaps, to the second order of the step.
    const double before = memory.a / a * (memory.a / a);
    const double kept = before < 1.0 ? 2 * before / (1 + before) : 1.0;
    memory.slide = kept * memory.slide, memory.roll = kept * memory.roll, memory.twist *= kept, memory.a = a;
    const Vec slip = u + closing * n;
    Load load;
    const Vec friction = spring(memory.slide, slip, n, k, eta, s_.mu * normal);
    load.force = friction - normal * n;
    load.torque = cross(n, friction);
    if (s_.rolling > 0) { load.moment = load.moment + r * cross(n, spring(memory.roll, r * cross(spin, n), n, k, eta, s_.rolling * normal)); }
    if (s_.twisting > 0) {
      const double rate = dot(spin, n), limit = s_.twisting * normal * r, kt = k * r * r, etat = eta * r * r;
      double moment = kt * memory.twist + (kt * s_.step + etat) * rate;
      if (std::abs(moment) > limit) { moment = std::copysign(limit, moment); }
      memory.twist += s_.step / (kt * s_.step + etat) * (moment - kt * memory.twist);
      load.moment = load.moment + moment * n;
    }
    return load;
  }

  void pairs(Sphere& p) {
    for (auto& neighbour : p.near) {
      Sphere& q = spheres[neighbour.other];
      const Vec d = apart(p.x, q.x);
      const double distance = norm(d), overlap = p.r + q.r - distance;
      if (overlap <= 0) {
        neighbour.memory = {};
        continue;
      }
      const Vec n = 1 / distance * d, u = q.v - p.v - cross(q.r * q.w + p.r * p.w, n);
      const Load load = contact(neighbour.memory, n, overlap, u, q.w - p.w, p.r * q.r / (p.r + q.r), p.m * q.m / (p.m + q.m), 0.5);
      p.force = p.force + load.force, q.force = q.force - load.force;
      p.torque = p.torque + p.r * load.torque + load.moment, q.torque = q.torque + q.r * load.torque - load.moment;
    }
  }

  void wall(Sphere& p, int k, Vec n, double distance) {
    const double overlap = p.r - distance;
    if (overlap <= 0) {
      p.walls[k] = {};
      return;
    }
    const Load load = contact(p.walls[k], n, overlap, Vec{} - p.v - cross(p.r * p.w, n), Vec{} - p.w, p.r, p.m, 1.0);   // rigid
    p.force = p.force + load.force, p.torque = p.torque + p.r * load.torque + load.moment;
  }

  void forces() {
    for (auto& p : spheres) { p.force = Vec{0, 0, -p.m * s_.gravity} - s_.drag * p.v, p.torque = {}; }
    for (auto& p : spheres) {
      pairs(p);
      wall(p, 0, {0, 0, -1}, p.x.z);
      if (s_.periodic) { continue; }
      wall(p, 1, {-1, 0, 0}, p.x.x), wall(p, 2, {1, 0, 0}, s_.width - p.x.x);
      wall(p, 3, {0, -1, 0}, p.x.y), wall(p, 4, {0, 1, 0}, s_.depth - p.x.y);
    }
  }

  void move() {
    for (auto& p : spheres) {
      p.v = p.v + s_.step / p.m * p.force;
      if (s_.rotation) { p.w = p.w + s_.step / (0.4 * p.m * p.r * p.r) * p.torque; }
      p.x = p.x + s_.step * p.v;
    }
  }

  Scene s_;
  double largest_ = 0;
  bool stale_ = true;
};

void drop_layer(const Scene& scene, Pile& pile, std::mt19937_64& random) {
  const double r = scene.radius, bottom = pile.top(), margin = scene.periodic ? 0 : r;
  const int wanted = int(std::lround(scene.fraction * scene.width * scene.depth * scene.thickness / (4.0 / 3.0 * M_PI * r * r * r)));
  auto draw = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  const std::size_t first = pile.spheres.size();
  while (pile.spheres.size() < first + wanted) {
    const Vec x{draw(margin, scene.width - margin), draw(margin, scene.depth - margin), draw(bottom + r, bottom + scene.thickness - r)};
    const auto hit = [&](const Sphere& p) { return norm(pile.apart(x, p.x)) < r + p.r; };
    if (std::none_of(pile.spheres.begin() + long(first), pile.spheres.end(), hit)) { pile.add(x, r); }
  }
}

Scene read(int count, char** words) {
  Scene s;
  std::map<std::string, double*> keys{{"width", &s.width}, {"depth", &s.depth}, {"gravity", &s.gravity}, {"density", &s.density}, {"modulus", &s.modulus},
      {"poisson", &s.poisson}, {"xi", &s.xi}, {"mu", &s.mu}, {"rolling", &s.rolling}, {"twisting", &s.twisting}, {"drag", &s.drag}, {"step", &s.step},
      {"duration", &s.duration}, {"thickness", &s.thickness}, {"fraction", &s.fraction}, {"radius", &s.radius}};
  for (int k = 0; k < count; ++k) {
    const std::string word = words[k], key = word.substr(0, word.find('='));
    const double value = std::atof(word.substr(word.find('=') + 1).c_str());
    if (keys.count(key)) { *keys[key] = value; }
    else if (key == "periodic") { s.periodic = value != 0; }
    else if (key == "rotation") { s.rotation = value != 0; }
    else if (key == "layers") { s.layers = int(value); }
    else if (key == "seed") { s.seed = int(value); }
    else { std::fprintf(stderr, "settle: no key %s\n", key.c_str()), std::exit(2); }
  }
  return s;
}
}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) { return std::fprintf(stderr, "settle IN OUT key=value ...\n"), 2; }
  const Scene scene = read(argc - 3, argv + 3);
  Pile pile(scene);
  if (std::FILE* in = std::fopen(argv[1], "r")) {
    double x, y, z, r;
    while (std::fscanf(in, "%lf %lf %lf %lf", &x, &y, &z, &r) == 4) { pile.add({x, y, z}, r); }
    std::fclose(in);
  }
  std::mt19937_64 random(scene.seed);
  for (int k = 0; k < std::max(1, scene.layers); ++k) {
    if (scene.layers > 0) { drop_layer(scene, pile, random); }
    pile.run(scene.duration);
  }
  std::FILE* out = std::fopen(argv[2], "w");
  if (out == nullptr) { return std::fprintf(stderr, "settle: cannot write %s\n", argv[2]), 5; }
  for (const auto& p : pile.spheres) { std::fprintf(out, "%.17g %.17g %.17g %.17g %.9g\n", p.x.x, p.x.y, p.x.z, p.r, norm(p.force) / (p.m * scene.gravity)); }
  std::fclose(out);
  std::printf("spheres %zu top %.9g kinetic %.3e\n", pile.spheres.size(), pile.top(), pile.kinetic());
}
