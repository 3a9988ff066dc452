/// Sets of packs (CC16 Algorithm 1): one scene, many seeds.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "comm/comm.hpp"
#include "input/input.hpp"
#include "run/options.hpp"

namespace packmpi::ensemble {

/// One pack of an ensemble.
struct Member {
  int set, pack;       ///< from 1
  std::uint64_t seed;  ///< the scene's + 10000 (set - 1) + pack - 1: the same when the ensemble grows
  std::string name;    ///< NAME_set_pack: its files are those of a run of its own
};

/// All members of a scene's ensemble. Local. Throws Error(bad_input) if a seed is beyond 2^63 - 1.
[[nodiscard]] std::vector<Member> members(const input::Input& in);

/// The scene of one member, as `packmpi SCENE --seed S` has it. Local.
[[nodiscard]] input::Input member_input(const input::Input& in, const Member& member);

/// Collective. Makes all packs, groups of ranks side by side, each pack with the bits it has when run alone; then
/// NAME.ensemble.csv, .json and .md, once all are made. With --restart auto finished packs stay, with their exit codes,
/// if they are what they should be (finished_run(), whose errors are thrown), and stopped ones go on. A pack that fails
/// does not stop the others. STOP, signals, --max-hours and --max-steps (steps of a group of ranks, pack after pack)
/// hold for the whole. Returns the worst of the packs' exit codes; throws Error(stopped_early) if the run was stopped.
[[nodiscard]] int make_ensemble(const comm::Comm& world, const input::Input& in, const run::Options& options);

}  // namespace packmpi::ensemble
