/// Cross-checks between keys: what no single range can see.
#pragma once
#include "config/input.hpp"
#include "document/document.hpp"

namespace packmpi::input {

using document::Document;

/// What the vessel's shape asks of other keys, as soon as it is known. Throws Error(bad_input). Local.
void check_shape(const Input& in, const Document& document);

/// That the keys of the size distribution make one. Throws Error(bad_input) at the place of the key to change. Local.
void check_radii(const Input& in, const Document& document);

/// All other cross-checks, of a scene that check_radii() has passed. Throws Error(bad_input) likewise. Refuses only
/// what is certain to fail; what depends on derived quantities is left to scene::build, what depends on chance to rsa.
/// Local.
void check(const Input& in, const Document& document);

}  // namespace packmpi::input
