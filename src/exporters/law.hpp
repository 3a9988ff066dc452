/// The scene's contact law in the words of the codes that read its packs. Private to this module.
#pragma once
#include <string>
#include <vector>

#include "exporters/document.hpp"

namespace packmpi::exporters {

/// Restitution whose "tsuji" damping in LAMMPS is the damping ratio xi: alpha(e) = sqrt(6) xi, alpha the polynomial of
/// LAMMPS' manual (pair_style granular). Above xi = 0.519 it is negative, a number that no impact has but that LAMMPS
/// takes; xi = 0 gives a number a little above 1.
[[nodiscard]] double tsuji_restitution(double damping_ratio);

/// Restitution of two particles of damping ratio xi, as codes whose Hertz damping is made from it understand it
/// (LIGGGHTS, MercuryDPM, Lethe): beta = sqrt(6/5) xi, e = exp(-pi beta / sqrt(1 - beta^2)); 0 from beta = 1 on.
[[nodiscard]] double restitution(double damping_ratio);

/// Shear modulus of the particles [Pa].
[[nodiscard]] double shear_modulus(const Specimen& specimen);

/// Has the scene friction with memory (contact.tangential = "mindlin")?
/// [s] for codes whose dashpot against slip is that of the reduced mass, where the scene's is that of the mass that
/// slips, 2/7 of it: less than the scene's by as much as the limit of an explicit step falls (doc/theory.md, "Time
/// step").
[[nodiscard]] double step_of_stronger_dashpot(const Specimen& specimen);
[[nodiscard]] bool remembers(const Specimen& specimen);

/// What the receiving code's input keeps of the scene's drag: all, all but a fluid that moves, nothing.
enum class Fluid { carried, at_rest, not_carried };
/// Whether it keeps the resistance to rolling and twisting.
enum class Rolling { not_carried, carried };
/// What this scene has and the input does not carry; a line each, none if it is all there.
[[nodiscard]] std::vector<std::string> left_out(const Specimen& specimen, Fluid fluid,
                                                Rolling rolling = Rolling::not_carried);
/// The header, and the same as "not carried over: ..."; each line behind `mark`.
[[nodiscard]] std::string notes(const Specimen& specimen, Fluid fluid, std::string_view mark,
                                Rolling rolling = Rolling::not_carried);

}  // namespace packmpi::exporters
