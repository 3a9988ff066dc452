/// May a run go on with this scene?
#pragma once
#include <string>

namespace packmpi::run {

/// The keys that differ between two effective inputs and may not, as "key: A before, B now", joined by "; ". Empty: the
/// same run. How long it is (layers.maximum, if there is no
/// final stage), and all of [parallel], [checkpoint], [output] and [petsc], may change.
/// Local.
[[nodiscard]] std::string forbidden_changes(const std::string& before, const std::string& now);

}  // namespace packmpi::run
