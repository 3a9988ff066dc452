#include "handover/springs.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "mesh/vectors.hpp"

namespace packmpi::handover {
namespace {

using mesh::cross;

constexpr double exact = 1e-9;         // of the springs, by their mean square
constexpr double no_progress = 1e-12;  // of the gradient
constexpr std::int32_t most_rounds = 20000;

void add(Vec3& to, double factor, const Vec3& v) {
  for (std::size_t c = 0; c < 3; ++c) to[c] += factor * v[c];
}

/// `v` less its part along n.
Vec3 tangent(const Vec3& v, const Vec3& n) {
  Vec3 out = v;
  add(out, -dot(v, n), n);
  return out;
}

/// Turns are counted here as lengths, times the mean radius, so that all unknowns are alike.
using Unknowns = std::vector<Motion>;
using Springs = std::vector<Vec3>;

double square(const Unknowns& x) {
  double sum = 0.0;
  for (const Motion& m : x) sum += dot(m.displacement, m.displacement) + dot(m.turn, m.turn);
  return sum;
}
double square(const Springs& r) {
  double sum = 0.0;
  for (const Vec3& v : r) sum += dot(v, v);
  return sum;
}

/// What a motion does to springs, and its transpose.
class Contacts {
 public:
  Contacts(std::span<const pack::TouchingRow> rows, std::span<const double> radius, Arm arm, bool spins)
      : rows_(rows), radius_(radius), arm_(arm), spins_(spins ? 1.0 : 0.0) {
    for (const double r : radius) mean_ += r / static_cast<double>(radius.size());
  }

  [[nodiscard]] double mean_radius() const { return mean_; }

  [[nodiscard]] Springs springs_of(const Unknowns& x) const {
    Springs out(rows_.size());
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const pack::TouchingRow& row = rows_[k];
      const Motion& a = x[at(row.first)];
      Vec3 past{}, turn{};
      add(past, -1.0, a.displacement);
      add(turn, lever(row, row.first), a.turn);
      if (row.wall < 0) {
        const Motion& b = x[at(row.second)];
        add(past, 1.0, b.displacement);
        add(turn, lever(row, row.second), b.turn);
      }
      add(past, -1.0, cross(turn, row.normal));
      out[k] = tangent(past, row.normal);
    }
    return out;
  }

  [[nodiscard]] Unknowns gathered(const Springs& r) const {
    Unknowns out(radius_.size());
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const pack::TouchingRow& row = rows_[k];
      const Vec3 along = tangent(r[k], row.normal), turn = cross(row.normal, along);
      Motion& a = out[at(row.first)];
      add(a.displacement, -1.0, along);
      add(a.turn, -lever(row, row.first), turn);
      if (row.wall >= 0) continue;
      Motion& b = out[at(row.second)];
      add(b.displacement, 1.0, along);
      add(b.turn, -lever(row, row.second), turn);
    }
    return out;
  }

 private:
  static std::size_t at(GlobalId id) { return static_cast<std::size_t>(id); }
  [[nodiscard]] double lever(const pack::TouchingRow& row, GlobalId id) const {
    const double arm = radius_[at(id)] - (arm_ == Arm::middle ? 0.5 * row.overlap : 0.0);
    return spins_ * arm / mean_;
  }

  std::span<const pack::TouchingRow> rows_;
  std::span<const double> radius_;
  Arm arm_;
  double spins_, mean_ = 0.0;
};

void step(Unknowns& x, double factor, const Unknowns& along) {
  for (std::size_t k = 0; k < x.size(); ++k) {
    add(x[k].displacement, factor, along[k].displacement);
    add(x[k].turn, factor, along[k].turn);
  }
}

/// along = gradient + factor along.
void turn_to(Unknowns& along, double factor, const Unknowns& gradient) {
  Unknowns next = gradient;
  step(next, factor, along);
  along = std::move(next);
}

double longest(const Springs& springs) {
  double most = 0.0;
  for (const Vec3& v : springs) most = std::max(most, dot(v, v));
  return std::sqrt(most);
}

}  // namespace

Motions motions_of(std::span<const pack::TouchingRow> rows, std::span<const double> radius, Arm arm, bool spins) {
  const Contacts contacts(rows, radius, arm, spins);
  Springs left(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) left[k] = tangent(rows[k].tangential, rows[k].normal);
  const double all = square(left), most = longest(left);
  Motions found;
  found.of.resize(radius.size());
  Unknowns gradient = contacts.gathered(left), along = gradient;
  double slope = square(gradient);
  const double steepest = slope;
  while (square(left) > exact * exact * all && slope > no_progress * no_progress * steepest &&
         found.rounds < most_rounds) {
    const Springs change = contacts.springs_of(along);
    const double length = slope / square(change);
    step(found.of, length, along);
    for (std::size_t k = 0; k < left.size(); ++k) add(left[k], -length, change[k]);
    gradient = contacts.gathered(left);
    const double next = square(gradient);
    turn_to(along, next / slope, gradient);
    slope = next;
    ++found.rounds;
  }
  for (Motion& m : found.of) {
    for (double& angle : m.turn) angle /= contacts.mean_radius();
  }
  found.left = most > 0.0 ? longest(left) / most : 0.0;
  return found;
}

Motions motions_of(const comm::Comm& comm, const pack::PackFile& file, Arm arm) {
  Motions found;
  std::string bytes;
  comm::agree_on(comm, [&] {
    if (comm.rank() != 0) return;
    const std::vector<pack::TouchingRow> rows = file.touching();
    if (rows.empty()) return;
    found = motions_of(rows, file.rows(0, file.count()).radius, arm, file.rotation());
    bytes.assign(reinterpret_cast<const char*>(found.of.data()), found.of.size() * sizeof(Motion));
  });
  bytes = comm.broadcast(0, bytes);
  found.of.resize(bytes.size() / sizeof(Motion));
  std::memcpy(found.of.data(), bytes.data(), bytes.size());
  found.left = comm.max(found.left);
  found.rounds = static_cast<std::int32_t>(comm.max(std::int64_t{found.rounds}));
  return found;
}

}  // namespace packmpi::handover
