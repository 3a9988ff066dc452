/// Springs of friction on their way into codes that keep them but read none. Such a code makes a spring longer by what
/// two particles move past each other in a step. So there is a motion of all particles, not a possible one, for nothing
/// moves by it, but one that makes every spring as long as it is, in one step (doc/theory.md, "Handing over").
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/types.hpp"
#include "comm/comm.hpp"
#include "pack/pack_file.hpp"

namespace packmpi::handover {

/// From the centre of a particle to where it moves past the other.
enum class Arm {
  radius,  ///< a whole radius, as LAMMPS counts
  middle   ///< less half of the overlap, as LIGGGHTS does
};

/// Of one particle.
struct Motion {
  Vec3 displacement{};  ///< [m]
  Vec3 turn{};          ///< [rad]
};

/// What makes the springs.
struct Motions {
  std::vector<Motion> of;   ///< by id; empty: the pack has no springs
  double left = 0.0;        ///< what a spring is off by at most, over the longest one
  std::int32_t rounds = 0;  ///< of the iteration
};

/// The motion of least squares that makes the springs of `rows`, by conjugate gradients on the normal equations (CGLS;
/// Hestenes and Stiefel 1952), without their matrix. A contact is two equations, a particle six unknowns (in the plane
/// one and three): below a coordination number of six, as of packs at rest, there is one that makes them all. `spins`:
/// particles turn. Local; the same bits wherever it is called. Cost: O(rows) a round, hundreds to thousands of rounds;
/// 200 bytes a particle.
[[nodiscard]] Motions motions_of(std::span<const pack::TouchingRow> rows, std::span<const double> radius, Arm arm,
                                 bool spins);

/// Collective: rank 0 reads and finds, all get it. No motions if the pack does not tell of springs. Error(io_failure).
[[nodiscard]] Motions motions_of(const comm::Comm& comm, const pack::PackFile& file, Arm arm);

}  // namespace packmpi::handover
