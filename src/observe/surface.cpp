/// The height of the surface: highest top of each lateral column, and their mean.
#include <petscdmda.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "observe/measure.hpp"

namespace packmpi::observe {
namespace {

/// The columns of the height test: their own grid, about one largest diameter wide.
struct HeightColumns {
  std::array<PetscInt, 2> counts{1, 1};
  PetscInt padded =
      1;  // columns along x in the DMDA: it must have one for each rank; those beyond counts[0] are not used
  std::array<double, 2> lengths{};

  [[nodiscard]] PetscInt column(const Vec3& position) const {  // in the DMDA's natural order, x fastest
    const auto coordinate = [&](std::size_t axis) {
      const auto n = static_cast<double>(counts[axis]);
      const double t = position[axis] / lengths[axis] * n;
      if (!(t > 0.0)) return PetscInt{0};
      return t < n ? static_cast<PetscInt>(t) : counts[axis] - 1;
    };
    return coordinate(0) + padded * (counts[1] > 1 ? coordinate(1) : 0);
  }
};

HeightColumns make_columns(const scene::Scene& scene, int ranks) {
  HeightColumns columns;
  const double width = 2.0 * scene.sizes.largest();
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.box.lateral_axes()); ++axis) {
    columns.lengths[axis] = scene.box.size[axis];
    columns.counts[axis] = std::max(PetscInt{1}, static_cast<PetscInt>(scene.box.size[axis] / width));
  }
  columns.padded = std::max(columns.counts[0], static_cast<PetscInt>(ranks));
  return columns;
}

/// The highest top in each column that this rank has particles in, ascending by column.
struct Tops {
  std::vector<PetscInt> column;
  std::vector<PetscScalar> height;
};

Tops highest_tops(const particles::Store& store, const scene::Scene& scene, const HeightColumns& columns) {
  const auto vertical = static_cast<std::size_t>(scene.box.vertical());
  std::vector<std::pair<PetscInt, double>> all;
  all.reserve(static_cast<std::size_t>(store.owned()));
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const Vec3 x = store.position(i);
    const double height = x[vertical] + store.radius(i);
    if (height > 0.0) all.emplace_back(columns.column(x), height);  // NaN has no place in an order
  }
  std::sort(all.begin(), all.end());
  Tops tops;
  for (const auto& [column, height] : all) {
    if (tops.column.empty() || tops.column.back() != column) {
      tops.column.push_back(column);
      tops.height.push_back(height);
    } else {
      tops.height.back() = height;  // ascending: the last is the highest
    }
  }
  return tops;
}

/// PETSc objects, destroyed on every path. A PETSc error ends the job, as MPI's do.
class ColumnHeights {
 public:
  ColumnHeights(const comm::Comm& comm, const HeightColumns& columns) : comm_(comm.handle()), columns_(columns) {
    check(DMDACreate2d(comm_, DM_BOUNDARY_NONE, DM_BOUNDARY_NONE, DMDA_STENCIL_STAR, columns.padded, columns.counts[1],
                       static_cast<PetscInt>(comm.size()), 1, 1, 0, nullptr, nullptr, &grid_));
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
  void raise_to(Tops& tops) {
    const auto count = static_cast<PetscInt>(tops.column.size());
    Vec mine = nullptr;
    IS where = nullptr;
    VecScatter scatter = nullptr;
    check(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, count, tops.height.data(), &mine));
    check(ISCreateGeneral(PETSC_COMM_SELF, count, tops.column.data(), PETSC_USE_POINTER, &where));
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
      if (k % columns_.padded < columns_.counts[0]) heights.push_back(values[k - first]);
    }
    check(VecRestoreArrayRead(heights_, &values));
    return heights;
  }

 private:
  void check(PetscErrorCode code) const { CHKERRABORT(comm_, code); }

  MPI_Comm comm_;
  HeightColumns columns_;
  DM grid_ = nullptr;
  Vec heights_ = nullptr;
};

}  // namespace

double surface_height(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene) {
  const particles::Store* one = &store;
  return surface_height(comm, std::span(&one, 1), scene);
}

double surface_height(const comm::Comm& comm, std::span<const particles::Store* const> stores,
                      const scene::Scene& scene) {
  const HeightColumns columns = make_columns(scene, comm.size());
  ColumnHeights heights(comm, columns);
  for (const particles::Store* store : stores) {
    Tops tops = highest_tops(*store, scene, columns);
    heights.raise_to(tops);
  }
  const double sum = comm::exact_sum(comm, heights.local());
  return sum / (static_cast<double>(columns.counts[0]) * static_cast<double>(columns.counts[1]));
}

}  // namespace packmpi::observe
