#include "observe/column_field.hpp"

#include <algorithm>

namespace packmpi::observe {

void keep_highest(std::vector<ColumnValue>& values) {
  join_columns(values, [](double a, double b) { return std::max(a, b); });
}

std::vector<ColumnValue> highest_tops(std::span<const particles::Store* const> stores, int vertical,
                                      const ColumnNumbering& columns) {
  std::vector<ColumnValue> tops;
  for (const particles::Store* store : stores) {
    for (LocalIndex i = 0; i < store->owned(); ++i) {
      const Vec3 x = store->position(i);
      const double height = x[static_cast<std::size_t>(vertical)] + store->radius(i);
      if (height > 0.0) tops.push_back({columns.column(x), height});  // NaN has no place in a maximum
    }
  }
  keep_highest(tops);
  return tops;
}

ColumnField::ColumnField(const comm::Comm& comm, const ColumnNumbering& columns)
    : comm_(comm.handle()),
      used_(static_cast<PetscInt>(columns.counts[0])),
      padded_(std::max(used_, static_cast<PetscInt>(comm.size()))) {
  check(DMDACreate2d(comm_, DM_BOUNDARY_NONE, DM_BOUNDARY_NONE, DMDA_STENCIL_STAR, padded_,
                     static_cast<PetscInt>(columns.counts[1]), static_cast<PetscInt>(comm.size()), 1, 1, 0, nullptr,
                     nullptr, &grid_));
  check(DMSetUp(grid_));
  check(DMDACreateNaturalVector(grid_, &values_));  // numbered by column, whoever owns it
  check(VecSet(values_, 0.0));
}

ColumnField::~ColumnField() {
  (void)VecDestroy(&values_);
  (void)DMDestroy(&grid_);
}

void ColumnField::send(std::span<const ColumnValue> values, InsertMode mode) {
  std::vector<PetscInt> column;
  std::vector<PetscScalar> numbers;
  column.reserve(values.size());
  numbers.reserve(values.size());
  for (const ColumnValue& one : values) {
    column.push_back(static_cast<PetscInt>(one.column % used_ + padded_ * (one.column / used_)));
    numbers.push_back(one.value);
  }
  const auto count = static_cast<PetscInt>(values.size());
  Vec mine = nullptr;
  IS where = nullptr;
  VecScatter scatter = nullptr;
  check(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, count, numbers.data(), &mine));
  check(ISCreateGeneral(PETSC_COMM_SELF, count, column.data(), PETSC_USE_POINTER, &where));
  check(VecScatterCreate(mine, nullptr, values_, where, &scatter));
  check(VecScatterBegin(scatter, mine, values_, mode, SCATTER_FORWARD));
  check(VecScatterEnd(scatter, mine, values_, mode, SCATTER_FORWARD));
  check(VecScatterDestroy(&scatter));
  check(ISDestroy(&where));
  check(VecDestroy(&mine));
}

std::vector<double> ColumnField::local() const {
  PetscInt first = 0;
  PetscInt end = 0;
  const PetscScalar* values = nullptr;
  std::vector<double> here;
  check(VecGetOwnershipRange(values_, &first, &end));
  check(VecGetArrayRead(values_, &values));
  for (PetscInt k = first; k < end; ++k) {
    if (k % padded_ < used_) here.push_back(values[k - first]);
  }
  check(VecRestoreArrayRead(values_, &values));
  return here;
}

}  // namespace packmpi::observe
