/// Whether springs of friction go along to another code, and how. Private to this module.
#pragma once
#include <string>

#include "exporters/convert.hpp"
#include "exporters/document.hpp"

namespace packmpi::exporters {

/// How a code takes springs of friction.
enum class SpringsBy {
  none,
  motion_of_radii,    ///< by a step in which particles move past each other (handover/springs.hpp)
  motion_of_middles,  ///< the same; levers end in the middle of the overlap
  forces              ///< as forces
};

/// What becomes of them.
struct SpringsPlan {
  SpringsBy by = SpringsBy::none;  ///< none: the pack has no friction with memory, or the code no way to take it
  std::string missing{};           ///< why they stay behind; "": they go along

  [[nodiscard]] bool on() const { return by != SpringsBy::none && missing.empty(); }
};

/// `stored`: the pack has its springs. Local, pure.
[[nodiscard]] SpringsPlan plan_springs(const ConvertRequest& request, const scene::Scene& scene, SpringsBy by,
                                       bool stored);
/// Collective. Puts them into the specimen, if the pack is at rest and they can all be made; if not, the plan says why
/// they stay behind.
void take_springs(const comm::Comm& comm, const pack::PackFile& file, SpringsPlan& plan, Specimen& specimen);
/// For the user; "": nothing to tell.
[[nodiscard]] std::string words_of(const SpringsPlan& plan, const Specimen& specimen);

}  // namespace packmpi::exporters
