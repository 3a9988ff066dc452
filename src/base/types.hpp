/// Integers by role, and the small vector that every module passes around.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>

namespace packmpi {

using LocalIndex = std::int32_t;     ///< a slot on this rank, [0, owned + ghosts)
using GlobalId = std::int64_t;       ///< a particle's name for life: 0 .. N-1 in order of insertion
using Rank = int;                    ///< as MPI has it
using Vec3 = std::array<double, 3>;  ///< x, y, z; in 2D z = 0 and y is vertical

[[nodiscard]] constexpr double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
[[nodiscard]] inline double norm(const Vec3& v) { return std::sqrt(dot(v, v)); }

}  // namespace packmpi
