/// Contacts that remember, in a checkpoint. Private to this module.
#pragma once
#include <cstdint>
#include <vector>

#include "comm/comm.hpp"
#include "disk/sealed_file.hpp"
#include "pack/checkpoint.hpp"

namespace packmpi::pack {

/// What the contacts in the file have stored; without memory: there are none in it. Local.
[[nodiscard]] scene::Features stored_in(const disk::SealedFile& file, int dimension);
/// This rank's share of the rows in the file, wherever their particles are. Local. Throws Error(bad_checkpoint), words
/// without the path, if ends are not those of two of so many `particles` or of one and a wall, or a number is not
/// finite.
[[nodiscard]] std::vector<HistoryRow> read_histories(const disk::SealedFile& file, const comm::Comm& comm,
                                                     const scene::Features& features, GlobalId particles);

/// By holder, and of a holder by the other end: the order of the file. Local.
void sort_by_ends(std::vector<HistoryRow>& rows);
/// Throws Error(bad_checkpoint), words without the path, if a contact is there twice. Local.
void check_once(const std::vector<HistoryRow>& sorted);

/// Throws Error(bad_checkpoint), words without the path, if a spring is longer than the friction of `scene` can hold.
/// Local.
void check_springs(const Histories& histories, const scene::Scene& scene);

/// A number of the bits of a row: sums over all rows, mod 2^64, depend on no order and no ranks. Local.
[[nodiscard]] std::uint64_t digest(const HistoryRow& row, const scene::Features& features);

}  // namespace packmpi::pack
