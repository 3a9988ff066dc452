/// A number for each lateral column of a grid, spread over the ranks: a PETSc DMDA and its vector. Private to this
/// module.
#pragma once
#include <petscdmda.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "comm/comm.hpp"
#include "comm/petsc.hpp"
#include "particles/store.hpp"

namespace packmpi::observe {

/// Columns of equal size over the floor, numbered x fastest. In 2D there is one along y.
struct ColumnNumbering {
  std::array<std::int64_t, 2> counts{1, 1};
  std::array<double, 2> lengths{};  ///< [m] of the floor

  [[nodiscard]] std::int64_t size() const { return counts[0] * counts[1]; }
  /// Of a position [m]; one outside belongs to the column at the border.
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

/// A value and the column it belongs to.
struct ColumnValue {
  std::int64_t column;
  double value;
};

/// One value a column, ascending in column: `join` of all that have it, in their order.
template <class Join>
void join_columns(std::vector<ColumnValue>& values, Join&& join) {
  std::stable_sort(values.begin(), values.end(),
                   [](const ColumnValue& a, const ColumnValue& b) { return a.column < b.column; });
  std::size_t kept = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (kept > 0 && values[kept - 1].column == values[k].column) {
      values[kept - 1].value = join(values[kept - 1].value, values[k].value);
    } else {
      values[kept++] = values[k];
    }
  }
  values.resize(kept);
}
/// As join_columns(): the highest value of each.
void keep_highest(std::vector<ColumnValue>& values);

/// The highest top [m] above 0 of the owned particles of some stores in each column that has one; by column. Local.
[[nodiscard]] std::vector<ColumnValue> highest_tops(std::span<const particles::Store* const> stores, int vertical,
                                                    const ColumnNumbering& columns);

/// 0 in every column at first. PETSc objects are destroyed on every path; a PETSc error is an Error.
/// Construction and destruction are collective. Memory: O(columns / ranks).
class ColumnField {
 public:
  ColumnField(const comm::Comm& comm, const ColumnNumbering& columns);
  ~ColumnField();
  ColumnField(const ColumnField&) = delete;
  ColumnField& operator=(const ColumnField&) = delete;

  /// Collective: each column becomes the maximum of what it is and what any rank gives. At most one value a column and
  /// rank.
  void raise_to(std::span<const ColumnValue> values) { send(values, MAX_VALUES); }
  /// Collective: adds what the ranks give. Whole numbers below 2^53 in all are added exactly, so in any order.
  void add(std::span<const ColumnValue> values) { send(values, ADD_VALUES); }
  /// Values of the columns that lie on this rank, ascending; rank after rank they are all columns. Local.
  [[nodiscard]] std::vector<double> local() const;

 private:
  void send(std::span<const ColumnValue> values, InsertMode mode);
  static void check(PetscErrorCode code) { comm::check_petsc(code, "gather values of columns"); }

  MPI_Comm comm_;
  PetscInt used_;    // columns along x
  PetscInt padded_;  // those of the DMDA: it must have one for each rank
  DM grid_ = nullptr;
  Vec values_ = nullptr;
};

}  // namespace packmpi::observe
