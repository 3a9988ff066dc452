/// Several components in other codes: types or materials, and what each pair of them has. Private to this module.
#pragma once
#include <string>

#include "exporters/document.hpp"
#include "scene/mixture.hpp"

namespace packmpi::exporters {

/// Atom types or materials of the particles: 1, or as many as components.
[[nodiscard]] int kinds(const Specimen& specimen);
/// [kg/m3] of a particle written.
[[nodiscard]] double density_of(const Specimen& specimen, const Outgoing& particle);
/// "type 1: gravel; type 2: sand", a comment's words.
[[nodiscard]] std::string kinds_words(const Specimen& specimen, std::string_view word, int first);

/// LAMMPS: "hertz ... tangential ..." of its granular styles. `share`: of the radius and mass of the widest particle,
/// r* and m* of the constant springs of rolling: 1/2, at a wall 1. Sliding friction without memory is there a damping
/// of slip up to Coulomb's limit, so it needs some.
/// `runs`: of a wall, how many there are with it, as LAMMPS 29 Sep 2021 takes its restitution for that of its damping
/// once more at each.
[[nodiscard]] std::string lammps_law(const Specimen& specimen, const scene::PairMaterial& of, double share,
                                     int runs = 1);
/// LAMMPS: pair_coeff of each pair, friction times `rougher`.
[[nodiscard]] std::string lammps_pairs(const Specimen& specimen, double rougher);
/// LIGGGHTS: properties of the types, the last being the walls'.
[[nodiscard]] std::string liggghts_material(const Specimen& specimen);
/// YADE: materials m0 .., then the walls'; the arguments of MindlinPhys; and the lines that read the particles.
[[nodiscard]] std::string yade_materials(const Specimen& specimen);
[[nodiscard]] std::string yade_physics(const Specimen& specimen);
[[nodiscard]] std::string yade_reader(const Specimen& specimen);

}  // namespace packmpi::exporters
