/// The height of the surface: highest top of each lateral column, and their mean.
#include <petscdmda.h>

#include <algorithm>
#include <array>
#include <compare>
#include <cstring>
#include <vector>

#include "observe/measure.hpp"

namespace packmpi::observe {
namespace {

/// The columns of the height test: their own grid, about one largest diameter wide, numbered x fastest.
struct HeightColumns {
  std::array<std::int64_t, 2> counts{1, 1};
  std::array<double, 2> lengths{};

  [[nodiscard]] std::int64_t size() const { return counts[0] * counts[1]; }
  [[nodiscard]] std::int64_t column(const Vec3& position) const {
    const auto coordinate = [&](std::size_t axis) {
      const auto n = static_cast<double>(counts[axis]);
      const double t = position[axis] / lengths[axis] * n;
      if (!(t > 0.0)) return std::int64_t{0};
      return t < n ? static_cast<std::int64_t>(t) : counts[axis] - 1;
    };
    return coordinate(0) + counts[0] * (counts[1] > 1 ? coordinate(1) : 0);
  }
};

HeightColumns make_columns(const scene::Scene& scene) {
  HeightColumns columns;
  const double width = 2.0 * scene.sizes.largest();
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.box.lateral_axes()); ++axis) {
    columns.lengths[axis] = scene.box.size[axis];
    columns.counts[axis] = std::max(std::int64_t{1}, static_cast<std::int64_t>(scene.box.size[axis] / width));
  }
  return columns;
}

/// The highest top of particles in a column.
struct Top {
  std::int64_t column;
  double height;
  friend auto operator<=>(const Top&, const Top&) = default;
};

/// The last and so the highest of each column; one a column then, ascending.
void keep_highest(std::vector<Top>& tops) {
  std::sort(tops.begin(), tops.end());
  std::size_t kept = 0;
  for (std::size_t k = 0; k < tops.size(); ++k) {
    if (k + 1 == tops.size() || tops[k + 1].column != tops[k].column) tops[kept++] = tops[k];
  }
  tops.resize(kept);
}

/// Of the columns that this rank has particles in.
std::vector<Top> highest_tops(std::span<const particles::Store* const> stores, const scene::Scene& scene,
                              const HeightColumns& columns) {
  const auto vertical = static_cast<std::size_t>(scene.box.vertical());
  std::vector<Top> tops;
  for (const particles::Store* store : stores) {
    for (LocalIndex i = 0; i < store->owned(); ++i) {
      const Vec3 x = store->position(i);
      const double height = x[vertical] + store->radius(i);
      if (height > 0.0) tops.push_back({columns.column(x), height});  // NaN has no place in an order
    }
  }
  keep_highest(tops);
  return tops;
}

/// Collective. Columns are dealt out in runs; the tops of those of this rank's run that hold any particle of any rank.
std::vector<double> heights_by_mail(const comm::Comm& comm, const std::vector<Top>& tops,
                                    const HeightColumns& columns) {
  const std::int64_t run = columns.size() / comm.size() + 1;
  std::vector<comm::Parcel> parcels;
  for (const Top& top : tops) {  // ascending in rank, too
    const auto rank = static_cast<Rank>(top.column / run);
    if (parcels.empty() || parcels.back().rank != rank) parcels.push_back({rank, {}});
    const auto* bytes = reinterpret_cast<const std::byte*>(&top);
    parcels.back().bytes.insert(parcels.back().bytes.end(), bytes, bytes + sizeof top);
  }
  std::vector<Top> all;
  for (const comm::Parcel& parcel : comm::exchange(comm, std::move(parcels))) {
    const std::size_t before = all.size();
    all.resize(before + parcel.bytes.size() / sizeof(Top));
    std::memcpy(&all[before], parcel.bytes.data(), parcel.bytes.size());
  }
  keep_highest(all);
  std::vector<double> heights(all.size());
  std::ranges::transform(all, heights.begin(), &Top::height);
  return heights;
}

/// PETSc objects, destroyed on every path. A PETSc error ends the job, as MPI's do.
class ColumnHeights {
 public:
  ColumnHeights(const comm::Comm& comm, const HeightColumns& columns)
      : comm_(comm.handle()),
        used_(static_cast<PetscInt>(columns.counts[0])),
        padded_(std::max(used_, static_cast<PetscInt>(comm.size()))) {
    check(DMDACreate2d(comm_, DM_BOUNDARY_NONE, DM_BOUNDARY_NONE, DMDA_STENCIL_STAR, padded_,
                       static_cast<PetscInt>(columns.counts[1]), static_cast<PetscInt>(comm.size()), 1, 1, 0, nullptr,
                       nullptr, &grid_));
    check(DMSetUp(grid_));
    check(DMDACreateNaturalVector(grid_, &heights_));  // numbered by column, whoever owns it
    check(VecSet(heights_, 0.0));
  }
  ~ColumnHeights() {
    check(VecDestroy(&heights_));
    check(DMDestroy(&grid_));
  }
  ColumnHeights(const ColumnHeights&) = delete;
  ColumnHeights& operator=(const ColumnHeights&) = delete;

  /// Collective: each column becomes the maximum of what it is and what any rank gives.
  void raise_to(const std::vector<Top>& tops) {
    std::vector<PetscInt> column;
    std::vector<PetscScalar> height;
    for (const Top& top : tops) {
      column.push_back(static_cast<PetscInt>(top.column % used_ + padded_ * (top.column / used_)));
      height.push_back(top.height);
    }
    const auto count = static_cast<PetscInt>(tops.size());
    Vec mine = nullptr;
    IS where = nullptr;
    VecScatter scatter = nullptr;
    check(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, count, height.data(), &mine));
    check(ISCreateGeneral(PETSC_COMM_SELF, count, column.data(), PETSC_USE_POINTER, &where));
    check(VecScatterCreate(mine, nullptr, heights_, where, &scatter));
    check(VecScatterBegin(scatter, mine, heights_, MAX_VALUES, SCATTER_FORWARD));
    check(VecScatterEnd(scatter, mine, heights_, MAX_VALUES, SCATTER_FORWARD));
    check(VecScatterDestroy(&scatter));
    check(ISDestroy(&where));
    check(VecDestroy(&mine));
  }

  /// The heights of the columns that lie on this rank, without the padding.
  [[nodiscard]] std::vector<double> local() const {
    PetscInt first = 0;
    PetscInt end = 0;
    const PetscScalar* values = nullptr;
    std::vector<double> heights;
    check(VecGetOwnershipRange(heights_, &first, &end));
    check(VecGetArrayRead(heights_, &values));
    for (PetscInt k = first; k < end; ++k) {
      if (k % padded_ < used_) heights.push_back(values[k - first]);
    }
    check(VecRestoreArrayRead(heights_, &values));
    return heights;
  }

 private:
  void check(PetscErrorCode code) const { CHKERRABORT(comm_, code); }

  MPI_Comm comm_;
  PetscInt used_;    // columns along x
  PetscInt padded_;  // those of the DMDA: it must have one for each rank
  DM grid_ = nullptr;
  Vec heights_ = nullptr;
};

std::vector<double> heights_on_grid(const comm::Comm& comm, const std::vector<Top>& tops,
                                    const HeightColumns& columns) {
  ColumnHeights heights(comm, columns);
  heights.raise_to(tops);
  return heights.local();
}

}  // namespace

double surface_height(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                      std::int64_t most_stored) {
  const particles::Store* one = &store;
  return surface_height(comm, std::span(&one, 1), scene, most_stored);
}

double surface_height(const comm::Comm& comm, std::span<const particles::Store* const> stores,
                      const scene::Scene& scene, std::int64_t most_stored) {
  const HeightColumns columns = make_columns(scene);
  const std::vector<Top> tops = highest_tops(stores, scene, columns);
  const bool few = columns.size() <= most_stored;
  const double sum =
      comm::exact_sum(comm, few ? heights_on_grid(comm, tops, columns) : heights_by_mail(comm, tops, columns));
  return sum / (static_cast<double>(columns.counts[0]) * static_cast<double>(columns.counts[1]));
}

}  // namespace packmpi::observe
