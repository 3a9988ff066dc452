/// CC16 Algorithm 1: layer after layer until the target height is reached.
#pragma once
#include "comm/comm.hpp"
#include "report/record.hpp"
#include "run/attendant.hpp"
#include "run/options.hpp"
#include "scene/scene.hpp"

namespace packmpi::run {

/// Collective. Makes the pack of a scene and writes NAME.hdf, NAME.json, NAME.log and NAME.steps.csv
/// (NAME.analysis.json, if asked for) into options.folder. Throws Error on all ranks: bad_input (existing outputs
/// without --force; RSA cannot reach phi_0), numerical_failure, io_failure; bad_checkpoint (options.restart);
/// stopped_early, with a checkpoint written (signals, limits, a STOP file). Checkpoints are removed once the pack is
/// written. A pack that misses a target is written all the same: see RunRecord::missed. A bed whose energy grows from
/// layer to layer is a numerical_failure. `guest`: who else follows the bed; it ends nothing but by an Error of all
/// ranks.
[[nodiscard]] report::RunRecord make_pack(const comm::Comm& comm, const scene::Scene& scene, const Options& options,
                                          Attendant* guest = nullptr);

/// Collective. The same pack, to the bit, in memory: no file, no checkpoint, and nobody listens but `guest`, who is
/// shown the bed at its end (Attendant::measured). Throws bad_input and numerical_failure, as make_pack().
[[nodiscard]] report::RunRecord make_in_memory(const comm::Comm& comm, const scene::Scene& scene, Attendant& guest);

}  // namespace packmpi::run
