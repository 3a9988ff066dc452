/// Sets of packs (CC16 Algorithm 1): one scene, many seeds.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "comm/comm.hpp"
#include "input/input.hpp"
#include "run/options.hpp"

namespace packmpi::run {

/// One pack of an ensemble.
struct Member {
  int set, pack;       ///< from 1
  std::uint64_t seed;  ///< the scene's plus the number of members before this one
  std::string name;    ///< NAME_set_pack: its files are those of a run of its own
};

/// All members of a scene's ensemble. Local. Throws Error(bad_input) if a seed is beyond 2^63 - 1.
[[nodiscard]] std::vector<Member> members(const input::Input& in);

/// The scene of one member, as `packmpi SCENE --seed S` has it. Local.
[[nodiscard]] input::Input member_input(const input::Input& in, const Member& member);

/// Collective. Makes all packs, groups of ranks side by side, each pack with the bits it has when run alone; then
/// NAME.ensemble.csv, .json and .md. With --restart auto finished packs stay and stopped ones go on. A pack that fails
/// does not stop the others. Returns the exit code: 75 if the run was stopped, else the worst of the packs'.
[[nodiscard]] int make_ensemble(const comm::Comm& world, const input::Input& in, const Options& options);

}  // namespace packmpi::run
