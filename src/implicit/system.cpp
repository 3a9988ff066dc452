#include "implicit/system.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/AutoDiff>  // after Eigen/Core: it does not include it itself

#include "implicit/contacts.hpp"
#include "implicit/petsc_check.hpp"

namespace packmpi::dynamics {
namespace {

// A number with its derivatives by d, v and s of an interaction.
using Derivatives = Eigen::Matrix<double, 9, 1>;
using Dual = Eigen::AutoDiffScalar<Derivatives>;

Triple<Dual> dual(const Vec3& x, int first) {
  return {Dual(x[0], 9, first), Dual(x[1], 9, first + 1), Dual(x[2], 9, first + 2)};
}

// Axis of each unknown of a particle: velocities, then spins (in 2D about z).
struct Axes {
  int velocities, spins, first_spin;
  explicit Axes(const particles::Layout& layout)
      : velocities(layout.dimension), spins(layout.spin_components()), first_spin(layout.dimension == 3 ? 0 : 2) {}
  [[nodiscard]] std::size_t spin(int c) const {
    return static_cast<std::size_t>(first_spin) + static_cast<std::size_t>(c);
  }
};

// All interactions of the lists, `near` for those of the near field.
template <class Contact, class Near>
void each(const scene::Scene& scene, const Law& law, const particles::Store& store,
          neighbor::Neighborhood& neighborhood, Contact&& contact, Near&& near) {
  neighborhood.face_walls(store);
  const neighbor::PairList& pairs = neighborhood.pairs();
  for (std::size_t p = 0; p < pairs.first.size(); ++p) {
    contact(of_pair(scene, law, store, pairs.first[p], pairs.second[p]));
  }
  const neighbor::WallList& walls = neighborhood.walls();
  for (std::size_t w = 0; w < walls.particle.size(); ++w) {
    const LocalIndex i = walls.particle[w];
    contact(of_wall(law, store, i, neighbor::facing_of(scene.container, walls, w, store.position(i))));
  }
  const neighbor::PairList& far = neighborhood.near_pairs();
  for (std::size_t p = 0; p < far.first.size(); ++p) {
    near(of_pair(scene, law, store, far.first[p], far.second[p]));
  }
}

}  // namespace

ImplicitSystem::ImplicitSystem(const comm::Comm& comm, const scene::Scene& scene, particles::Store& store,
                               neighbor::Neighborhood& neighborhood)
    : comm_(comm), scene_(scene), store_(store), neighborhood_(neighborhood), theta_(scene.in.dynamics.theta) {
  const std::int64_t first = comm_.sum_below(store_.owned());
  row_.assign(static_cast<std::size_t>(store_.total()), -1);
  for (LocalIndex i = 0; i < store_.owned(); ++i) row_[static_cast<std::size_t>(i)] = first + i;
  neighborhood_.share(std::span(row_));
}

void ImplicitSystem::begin(const Law& law, double time_step, double* u) {
  law_ = law;
  time_step_ = time_step;
  const auto count = static_cast<std::size_t>(store_.owned());
  const double* records = store_.records();
  before_.assign(records, records + count * static_cast<std::size_t>(store_.layout().stride));
  const particles::Layout& layout = store_.layout();
  for (LocalIndex i = 0; i < store_.owned(); ++i) {
    const double* record = store_.record(i);
    u = std::copy_n(record + layout.velocity, layout.dimension, u);
    u = std::copy_n(record + std::max(0, layout.spin), layout.spin_components(), u);
  }
  accelerations(a_before_);
}

void ImplicitSystem::set(const double* u) {
  const particles::Layout& layout = store_.layout();
  const auto stride = static_cast<std::size_t>(layout.stride);
  for (LocalIndex i = 0; i < store_.owned(); ++i) {
    const double* old = before_.data() + static_cast<std::size_t>(i) * stride;
    double* record = store_.record(i);
    for (int a = 0; a < layout.dimension; ++a) {
      const double mean = theta_ * u[a] + (1.0 - theta_) * old[layout.velocity + a];
      record[a] = old[a] + time_step_ * mean;
      record[layout.velocity + a] = u[a];
    }
    for (int c = 0; c < layout.spin_components(); ++c) record[layout.spin + c] = u[layout.dimension + c];
    u += unknowns();
  }
  neighborhood_.refresh_ghosts(store_);
}

void ImplicitSystem::residual(const double* u, double* r) {
  set(u);
  accelerations(a_);
  const particles::Layout& layout = store_.layout();
  const auto stride = static_cast<std::size_t>(layout.stride);
  std::size_t k = 0;
  for (LocalIndex i = 0; i < store_.owned(); ++i) {
    const double* old = before_.data() + static_cast<std::size_t>(i) * stride;
    for (int c = 0; c < unknowns(); ++c, ++k) {
      const int field = c < layout.dimension ? layout.velocity + c : layout.spin + c - layout.dimension;
      r[k] = u[k] - old[field] - time_step_ * (theta_ * a_[k] + (1.0 - theta_) * a_before_[k]);
    }
  }
}

// d u / dt of the present state: (1)-(3) of the paper, d (r omega) / dt = 5/2 q / m.
void ImplicitSystem::accelerations(std::vector<double>& a) {
  const Axes axes(store_.layout());
  const auto each_one = static_cast<std::size_t>(unknowns());
  a.assign(static_cast<std::size_t>(store_.owned()) * each_one, 0.0);
  largest_force_ = 0.0;
  const auto add = [&](LocalIndex i, const ContactForce<double>& f, double sign) {
    if (i < 0 || i >= store_.owned()) return;
    const double w = inverse_mass(law_, store_, i);
    double* to = a.data() + static_cast<std::size_t>(i) * each_one;
    for (int c = 0; c < axes.velocities; ++c) to[c] += sign * w * f.force[static_cast<std::size_t>(c)];
    for (int c = 0; c < axes.spins; ++c) to[axes.velocities + c] += 2.5 * w * f.moment[axes.spin(c)];
  };
  const auto both = [&](const Interaction& at, const std::optional<ContactForce<double>>& f) {
    if (!f) return;
    add(at.first, *f, 1.0);
    add(at.second, *f, -1.0);
    if (!(std::fabs(f->normal) <= largest_force_)) largest_force_ = std::fabs(f->normal);  // NaN stays
  };
  each(
      scene_, law_, store_, neighborhood_,
      [&](const Interaction& at) { both(at, contact_force<double>(law_, at, at.d, at.v, at.s)); },
      [&](const Interaction& at) { both(at, near_force<double>(*scene_.in.near_field, at.d)); });
  const input::Drag& drag = scene_.in.drag;
  for (LocalIndex i = 0; i < store_.owned(); ++i) {
    double* to = a.data() + static_cast<std::size_t>(i) * each_one;
    const double* v = store_.record(i) + store_.layout().velocity;
    const double w = drag.coefficient * inverse_mass(law_, store_, i);
    for (int c = 0; c < axes.velocities; ++c) to[c] -= w * (v[c] - drag.fluid_velocity[static_cast<std::size_t>(c)]);
    to[axes.velocities - 1] -= scene_.in.jamming.gravity;
  }
}

Mat ImplicitSystem::make_matrix() const {
  std::vector<PetscInt> here(static_cast<std::size_t>(store_.owned()), 1), there(here.size(), 0);
  const auto count = [&](const neighbor::PairList& list) {
    for (std::size_t p = 0; p < list.first.size(); ++p) {
      const auto i = static_cast<std::size_t>(list.first[p]), j = static_cast<std::size_t>(list.second[p]);
      if (list.second[p] < store_.owned()) {
        ++here[i], ++here[j];
      } else if (row_[j] >= 0) {
        ++there[i];
      }
    }
  };
  count(neighborhood_.pairs());
  count(neighborhood_.near_pairs());
  // A pair of the near field may be a contact, too: no more than there are.
  const auto others = static_cast<PetscInt>(comm_.sum(std::int64_t{store_.owned()}) - store_.owned());
  for (PetscInt& columns : here) columns = std::min<PetscInt>(columns, store_.owned());
  for (PetscInt& columns : there) columns = std::min(columns, others);
  Mat matrix = nullptr;
  const PetscInt rows = store_.owned() * unknowns();
  check_petsc(MatCreateBAIJ(comm_.handle(), unknowns(), rows, rows, PETSC_DETERMINE, PETSC_DETERMINE, 0, here.data(), 0,
                            there.data(), &matrix));
  // Every listed pair has its blocks from the start: an assembly drops the room that nobody has used.
  const std::vector<double> zeros(static_cast<std::size_t>(unknowns()) * static_cast<std::size_t>(unknowns()), 0.0);
  const auto reserve = [&](LocalIndex i, LocalIndex j) {
    const auto row = static_cast<PetscInt>(row_[static_cast<std::size_t>(i)]);
    const auto column = static_cast<PetscInt>(row_[static_cast<std::size_t>(j)]);
    if (i >= store_.owned() || column < 0) return;
    check_petsc(MatSetValuesBlocked(matrix, 1, &row, 1, &column, zeros.data(), ADD_VALUES));
  };
  for (LocalIndex i = 0; i < store_.owned(); ++i) reserve(i, i);
  for (const neighbor::PairList* list : {&neighborhood_.pairs(), &neighborhood_.near_pairs()}) {
    for (std::size_t p = 0; p < list->first.size(); ++p) {
      reserve(list->first[p], list->second[p]);
      reserve(list->second[p], list->first[p]);
    }
  }
  check_petsc(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  check_petsc(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  return matrix;
}

void ImplicitSystem::jacobian(Mat matrix) const {
  const Axes axes(store_.layout());
  const int n = unknowns();
  const double step = theta_ * time_step_;
  const auto entry = [n](int r, int c) {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(n) + static_cast<std::size_t>(c);
  };
  std::vector<double> block(entry(n, 0));
  const auto put = [&](LocalIndex i, LocalIndex j) {
    const auto row = static_cast<PetscInt>(row_[static_cast<std::size_t>(i)]);
    const auto column = static_cast<PetscInt>(row_[static_cast<std::size_t>(j)]);
    if (column >= 0) check_petsc(MatSetValuesBlocked(matrix, 1, &row, 1, &column, block.data(), ADD_VALUES));
  };
  // dR of end i (force of sign `own`) by the unknowns of end j, whose d and v enter the interaction with sign `other`.
  const auto add = [&](LocalIndex i, double own, LocalIndex j, double other, const ContactForce<Dual>& f) {
    if (i < 0 || i >= store_.owned() || j < 0) return;
    const double w = -step * inverse_mass(law_, store_, i);
    for (int r = 0; r < n; ++r) {
      const bool force = r < axes.velocities;
      const Dual& value = force ? f.force[static_cast<std::size_t>(r)] : f.moment[axes.spin(r - axes.velocities)];
      const double factor = force ? own * w : 2.5 * w;
      for (int c = 0; c < n; ++c) {
        const bool velocity = c < axes.velocities;
        const Derivatives& by = value.derivatives();
        const double slope =
            velocity ? other * (step * by[c] + by[3 + c]) : by[6 + static_cast<int>(axes.spin(c - axes.velocities))];
        block[entry(r, c)] = factor * slope;
      }
    }
    put(i, j);
  };
  const auto all = [&](const Interaction& pair, const std::optional<ContactForce<Dual>>& f) {
    if (!f) return;
    add(pair.first, 1.0, pair.first, -1.0, *f);
    add(pair.first, 1.0, pair.second, 1.0, *f);
    add(pair.second, -1.0, pair.first, -1.0, *f);
    add(pair.second, -1.0, pair.second, 1.0, *f);
  };
  check_petsc(MatZeroEntries(matrix));
  for (LocalIndex i = 0; i < store_.owned(); ++i) {
    std::ranges::fill(block, 0.0);
    for (int c = 0; c < n; ++c) {
      const double drag = c < axes.velocities ? scene_.in.drag.coefficient * inverse_mass(law_, store_, i) : 0.0;
      block[entry(c, c)] = 1.0 + step * drag;
    }
    put(i, i);
  }
  each(
      scene_, law_, store_, neighborhood_,
      [&](const Interaction& at) {
        all(at, contact_force<Dual>(law_, at, dual(at.d, 0), dual(at.v, 3), dual(at.s, 6)));
      },
      [&](const Interaction& at) { all(at, near_force<Dual>(*scene_.in.near_field, dual(at.d, 0))); });
  check_petsc(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  check_petsc(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
}

void ImplicitSystem::restore() {
  std::ranges::copy(before_, store_.records());
  neighborhood_.refresh_ghosts(store_);
}

void ImplicitSystem::accept() {
  const geometry::Container& box = scene_.container;
  for (LocalIndex i = 0; i < store_.owned(); ++i) {
    for (int a = 0; a < box.lateral_axes(); ++a) {
      const auto axis = static_cast<std::size_t>(a);
      if (box.periodic[axis]) store_.record(i)[a] = geometry::wrap(store_.record(i)[a], box.size[axis]);
    }
  }
}

double ImplicitSystem::largest_speed() const {
  const auto stride = static_cast<std::size_t>(store_.layout().stride);
  double largest = 0.0;
  for (LocalIndex i = 0; i < store_.owned(); ++i) {
    const double* old = before_.data() + static_cast<std::size_t>(i) * stride;
    double squared = 0.0;
    for (int a = 0; a < store_.layout().dimension; ++a) {
      const double moved = store_.record(i)[a] - old[a];
      squared += moved * moved;
    }
    if (!(squared <= largest)) largest = squared;  // NaN stays
  }
  return std::sqrt(largest) / time_step_;
}

}  // namespace packmpi::dynamics
