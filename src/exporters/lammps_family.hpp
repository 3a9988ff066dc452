/// What LAMMPS and LIGGGHTS have in common. Private to this module.
#pragma once
#include <string>

#include "exporters/document.hpp"

namespace packmpi::exporters {

/// All of a data file above its rows of atoms; the first line, which both skip, is the header.
/// `kinds`: atom types; `section`: "Atoms" with or without its comment.
[[nodiscard]] std::string data_head(const Specimen& specimen, const char* code, int kinds, const char* section);

/// "id type diameter density x y z", the type being 1 or that of the particle's component.
void atom_row(Text& out, const Outgoing& particle, double density);

/// The second section of a data file: "id vx vy vz wx wy wz"; with springs those that make them.
[[nodiscard]] Section velocities(const Specimen& specimen);
/// The integrator, time step and, with springs, before them the step that makes them, for which nothing moves.
/// `step` [s]; `stand`: the command that ends all spins.
[[nodiscard]] std::string begin_to_move(const Specimen& specimen, double step, const char* stand);

/// Columns of thermo_style and what makes them, for the line that tells how far particles have moved.
[[nodiscard]] std::string watch_displacement();
inline constexpr const char* displacement_columns = " c_farthest c_apart";
/// The line, in mean diameters; after a run.
[[nodiscard]] std::string drift_line(const Specimen& specimen);

/// " p f f": what the command boundary wants.
[[nodiscard]] std::string boundary_words(const Specimen& specimen);

/// LAMMPS: a region of a round vessel's wall, and its name.
struct Region {
  std::string name, line;
};
[[nodiscard]] std::vector<Region> round_regions(const Specimen& specimen);

}  // namespace packmpi::exporters
