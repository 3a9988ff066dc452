#include "tables/known_names.hpp"

#include <algorithm>
#include <array>

namespace packmpi::tables {
namespace {

struct Known {
  std::string_view part;    // of a name
  std::string_view not_in;  // the table whose own business it is
  std::string_view words;
};

constexpr std::string_view no_attraction =
    "not in this version: contacts do not attract each other; nearest is [near_field], a pair force within a cut-off";
constexpr std::string_view spheres_alone =
    "not in this version: particles are spheres or discs; nearest is contact.rolling_friction, which stands for shape";
constexpr std::string_view hertz =
    "contacts are Hertz', whose stiffness follows from particles.youngs_modulus and particles.poisson_ratio";
constexpr std::string_view stress = "a stress is asked for by [confinement], isotropic or vertical and lateral";
constexpr std::string_view rolling =
    "resistance to rolling and twisting is contact.rolling_friction and contact.twisting_friction, as friction is of "
    "the "
    "normal force";
constexpr std::string_view surface =
    "a closed surface is shape = \"mesh\" with file and unit, of [container] or an [[obstacle]] (doc/vessels.md)";
constexpr std::string_view materials =
    "several materials are [[component]] tables, one each, with name, share and what differs (doc/howto_mixture.md)";
constexpr std::string_view strata =
    "parts of the bed by height or by mass are [[stratum]] tables, from below (doc/howto_strata.md)";
constexpr std::string_view shaking =
    "not in this version; a denser bed is asked for by [target], which fills it in with less friction";

constexpr std::string_view bodies =
    "what stands or hangs in the container is an [[obstacle]] table each (doc/vessels.md)";

// The first that is part of the name holds.
constexpr std::array all{
    Known{"static", "",
          "one coefficient, contact.friction, is for sticking and sliding; contact.tangential = "
          "\"mindlin\" lets contacts stick"},
    Known{"dynamic_friction", "", "one coefficient, contact.friction, is for sticking and sliding"},
    Known{"cohesi", "", no_attraction},
    Known{"adhesi", "", no_attraction},
    Known{"surface_energy", "", no_attraction},
    Known{"jkr", "", no_attraction},
    Known{"capillar", "", no_attraction},
    Known{"moisture", "", no_attraction},
    Known{"rolling", "", rolling},
    Known{"twisting", "", rolling},
    Known{"clump", "", spheres_alone},
    Known{"shape", "container",
          "particles are spheres or discs, and contact.rolling_friction stands for their shape; the vessel's is "
          "container.shape"},
    Known{"mesh", "", surface},
    Known{"stl", "", surface},
    Known{"multisphere", "", spheres_alone},
    Known{"ellips", "", spheres_alone},
    Known{"aspect_ratio", "", spheres_alone},
    Known{"stiffness", "", hertz},
    Known{"restitution", "", "give contact.restitution, one number at any speed"},
    Known{"component", "", materials},
    Known{"mixture", "", materials},
    Known{"material", "", materials},
    Known{"species", "", materials},
    Known{"strat", "", strata},
    Known{"obstacle", "container", bodies},
    Known{"internals", "", bodies},
    Known{"baffle", "", bodies},
    Known{"pressure", "", stress},
    Known{"servo", "confinement", stress},
    Known{"piston", "confinement", stress},
    Known{"vibrat", "", shaking},
    Known{"tapping", "", shaking},
    Known{"temperature", "", "not in this version: there is no heat"},
    Known{"porosity", "target",
          "a density is asked for by [target] porosity, void_ratio, solid_fraction or relative_density"},
    Known{"void_ratio", "target",
          "a density is asked for by [target] porosity, void_ratio, solid_fraction or relative_density"},
};

}  // namespace

std::optional<std::string> known_elsewhere(std::string_view table, std::string_view name) {
  const auto* found = std::ranges::find_if(all, [&](const Known& known) {
    return name.find(known.part) != std::string_view::npos && (known.not_in.empty() || known.not_in != table);
  });
  if (found == all.end()) return std::nullopt;
  return std::string(found->words);
}

}  // namespace packmpi::tables
