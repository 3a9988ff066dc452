/// Of particles, height and floor of a scene what is not given: found by trying. Private to this module.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "forecast/estimate.hpp"
#include "scene/expectation.hpp"
#include "scene/scene.hpp"

namespace packmpi::forecast {

/// The input with these changes of it, as those of --set. Collective.
using Source = std::function<input::Input(const std::vector<std::string>& sets)>;

/// What is asked for.
enum class Unknown { particles, height, floor };

/// The solid fraction of the bed: the question's own, that of the scene's target, or what is known of such beds. Local.
[[nodiscard]] scene::BedFraction fraction_of(const scene::Scene& scene, const Question& question);

/// Is the size of this vessel one list? Of a cylinder the reader makes diameter and height of it. Local.
[[nodiscard]] bool has_size(const geometry::Container& vessel);

/// Are layers made so thick that whole ones hold the number asked for? Not those that end at H_d, nor in surfaces of
/// triangles, which are dear to read so often. Local.
[[nodiscard]] bool fits_thickness(const scene::Scene& scene);

/// The scene whose particles, height and floor fit together; `unknown` becomes what was found. Collective. Throws
/// Error(bad_input) for a question that leaves nothing or too much to find, and for what does not fit.
[[nodiscard]] scene::Scene solved(const Source& source, const Question& question, Unknown& unknown);

}  // namespace packmpi::forecast
