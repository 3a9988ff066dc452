/// A pack in memory.
#pragma once
#include <mpi.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace packmpi {

/// Contacts, as arrays of the same M. Each contact is on one rank only, where its first particle is. SI units.
struct ContactSpans {
  std::span<const std::int64_t> pair;    ///< (M, 2) ids, first < second, sorted; of walls (M): the particle
  std::span<const std::int32_t> wall;    ///< (M): 0 floor, 1, 2 low and high x, 3, 4 low and high y; of pairs empty
  std::span<const double> overlap;       ///< (M) [m]
  std::span<const double> normal;        ///< (M, 3) unit vector from the first to the second, or into the wall
  std::span<const double> force;         ///< (M, 3) [N] on the first
  std::span<const double> displacement;  ///< (M, 3) [m] of the tangential springs; empty without memory
};

/// What make_packing() made: this rank's share of it, the particles of its columns. Arrays are row after row and stay
/// where they are as long as one copy of the Packing lives; copies share them. Nothing of it needs MPI but what says
/// "collective".
class Packing {
 public:
  [[nodiscard]] std::int64_t count() const noexcept;                   ///< N, the particles here
  [[nodiscard]] std::span<const std::int64_t> id() const noexcept;     ///< (N), ascending; in all ranks 0 ..
  [[nodiscard]] std::span<const double> position() const noexcept;     ///< (N, 3) [m]; in 2D z is 0
  [[nodiscard]] std::span<const double> radius() const noexcept;       ///< (N) [m]
  [[nodiscard]] std::span<const double> velocity() const noexcept;     ///< (N, 3) [m/s]
  [[nodiscard]] std::span<const double> spin() const noexcept;         ///< (N, 3) [rad/s]; empty without rotation
  [[nodiscard]] std::span<const std::int32_t> layer() const noexcept;  ///< (N), of insertion, from 0
  /// (N), number of its [[component]] in the scene, from 0; empty with one.
  [[nodiscard]] std::span<const std::int32_t> component() const noexcept;
  [[nodiscard]] std::span<const std::int32_t> contacts() const noexcept;  ///< (N), touching particles
  [[nodiscard]] const ContactSpans& pair_contacts() const noexcept;       ///< between particles
  [[nodiscard]] const ContactSpans& wall_contacts() const noexcept;       ///< with walls
  [[nodiscard]] const std::string& summary() const noexcept;              ///< NAME.json (doc/file_format.md), of all
  [[nodiscard]] const std::vector<std::string>& missed() const noexcept;  ///< targets that were missed; empty: none
  [[nodiscard]] double phi_bulk() const noexcept;                         ///< solid fraction of the bulk
  [[nodiscard]] double height() const noexcept;                           ///< [m]

  /// Collective over the ranks that made it. Everything on rank 0, sorted by id; the others have no particles then.
  [[nodiscard]] Packing gathered(MPI_Comm comm) const;
  /// Collective, likewise; of a share or of what was gathered. Writes the pack file `path`, as the program does, whole
  /// or not at all. Throws Failure (code 2) if it exists and `force` is not set, (5) if it cannot be written.
  void write(MPI_Comm comm, const std::string& path, bool force = false) const;

  struct Rows;
  explicit Packing(std::shared_ptr<const Rows> rows) : rows_(std::move(rows)) {}  ///< for the library itself

 private:
  std::shared_ptr<const Rows> rows_;
};

}  // namespace packmpi
