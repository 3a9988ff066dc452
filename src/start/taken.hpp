/// What was taken over by [start], as its layers say it.
#pragma once
#include <string>
#include <vector>

#include "comm/comm.hpp"
#include "pack/pack.hpp"
#include "pack/progress.hpp"
#include "scene/scene.hpp"
#include "start/text_rows.hpp"

namespace packmpi::start {

/// The first id of each layer of a pack; one layer, if ids do not ascend with layers. Collective.
[[nodiscard]] std::vector<GlobalId> first_ids_of(const comm::Comm& comm, const pack::PackRows& rows);

/// The reason to stop of a layer that was taken over from a pack, with what its contacts remember or without; and from
/// a text file, with what that had. Local.
[[nodiscard]] std::string reason_of_pack(bool springs);
[[nodiscard]] std::string reason_of_text(const TextRows& read);

/// What was taken over and what was not, "" if nothing was. Local.
[[nodiscard]] std::string taken_words(const scene::Scene& scene, const pack::Progress& progress);

/// Was this layer taken over? Its reason to stop says so.
[[nodiscard]] bool is_taken_over(const report::LayerRow& row);
/// Do contacts that were taken over lack what they should remember? Then rest cannot be judged before they bear again.
[[nodiscard]] bool lacks_springs(const scene::Scene& scene, const pack::Progress& progress);

}  // namespace packmpi::start
