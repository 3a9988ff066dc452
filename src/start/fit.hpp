/// What a scene with [start] goes on from, and whether it fits.
#pragma once
#include <string>

#include "comm/comm.hpp"
#include "input/input.hpp"
#include "pack/pack.hpp"
#include "scene/scene.hpp"
#include "start/text_rows.hpp"

namespace packmpi::start {

/// Throws Error(bad_input): the scene's file, and the words.
[[noreturn]] void refuse(const scene::Scene& scene, const std::string& words);

/// Of the file, from where the program runs. Local.
[[nodiscard]] std::string path_of(const input::Input& in);

/// The scene with the digest of the file that it starts from, which makes it another scene than with another file; as
/// it is if it starts from none. Collective. Throws Error(bad_input) if it has the digest of another pack,
/// Error(io_failure) if there is no such pack.
[[nodiscard]] input::Input with_start(const comm::Comm& comm, input::Input in);

/// Throws Error(bad_input) if the pack, which the scene `made` made, has another container or other components than the
/// scene, or radii that the scene has not. Local.
void check_fit(const scene::Scene& scene, const input::Input& made, const pack::PackSlice& slice);

/// Of particles of a text file: puts them into the periodic range along periodic axes, wherever the file has them. The
/// box of a LAMMPS file must be as long there as the container. Throws Error(bad_input) if it is not, or if there are
/// radii that the scene has not. Local.
void fit_rows(const scene::Scene& scene, TextRows& found);

/// Do particles feel other forces in the scene than in `made`, where they came to rest? Local.
[[nodiscard]] bool feels_anew(const input::Input& made, const scene::Scene& scene);

}  // namespace packmpi::start
