/// Particles as other programs write them down: CSV and LAMMPS data files.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/types.hpp"
#include "pack/pack.hpp"

namespace packmpi::start {

enum class Kind { pack, csv, lammps };

/// What the file is, by its first bytes: a pack, LAMMPS data ("N atoms" in its head), else CSV. Rank-local. Throws
/// Error(bad_input) if there is no such file.
[[nodiscard]] Kind kind_of(const std::string& path);

/// A number that files of other bytes have not. Rank-local. Throws Error(bad_input).
[[nodiscard]] std::uint64_t digest_of_text(const std::string& path);

/// This rank's share of the particles: every so-many-th row of the file, whose ids are their places in it, from 0.
struct TextRows {
  pack::PackRows rows;             ///< one layer; velocities and spins 0 where the file has none
  std::vector<std::int64_t> line;  ///< of each of them in the file, from 1
  std::int64_t total = 0;          ///< rows on all ranks
  std::string taken, left;         ///< what was taken over, and what the file has besides: words; "": nothing
  /// Of LAMMPS: the box [m] along x, y and z.
  std::optional<std::array<std::array<double, 2>, 3>> box;
};

/// Reads a CSV file: with a line of names, columns x, y, z (2D: x, y) and radius or diameter, each in m or in the unit
/// of length behind its name ("x_mm", "radius [mm]"), in any order, and vx, vy, vz [m/s] and wx, wy, wz [rad/s] if they
/// are all there; without, x, y, z, r (2D: x, y, r) in m. Commas, semicolons, tabs or blanks between columns; decimal
/// commas where columns are not separated by commas; lines that begin with # are comments. Every line is looked at on
/// every rank. Throws Error(bad_input), one line "FILE:LINE: ...", with no word of the file. Cost: one reading of it.
[[nodiscard]] TextRows read_csv(const std::string& path, int dimension, Rank rank, int ranks);

/// Reads a LAMMPS data file of atom_style sphere, in SI units: diameters and positions, velocities if it has them.
/// Likewise.
[[nodiscard]] TextRows read_lammps(const std::string& path, int dimension, Rank rank, int ranks);

}  // namespace packmpi::start
