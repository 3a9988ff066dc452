/// What a user should know of a scene before it runs.
#pragma once
#include <string>
#include <vector>

#include "scene/expectation.hpp"
#include "scene/scene.hpp"

namespace packmpi::forecast {

/// Sentences on what is allowed and yet likely a mistake: step, softness, length, fines. Local, pure.
[[nodiscard]] std::vector<std::string> warnings_of(const scene::Scene& scene);

/// Sentences on a run of so many ranks, of which so many share a machine with so many cores: cores that are shared,
/// ranks that have little to do. Local, pure.
[[nodiscard]] std::vector<std::string> notes_of(const scene::Scene& scene, int ranks, int on_machine, int cores);

/// Where the scene's own keys override those of a preset that is not "paper": which, and what that costs in
/// particle-steps; "" where none does. Local, pure.
[[nodiscard]] std::string preset_note(const scene::Scene& scene);

/// "the finest 5 % by mass, below 1e-4 m, are 97 % of about 2e+06 particles". Local.
[[nodiscard]] std::string fines_words(const scene::Fines& fines);

}  // namespace packmpi::forecast
