/// Particles on their way to another rank. Private to this module.
#pragma once
#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstring>
#include <vector>

#include "comm/comm.hpp"
#include "particles/store.hpp"

namespace packmpi::neighbor {

/// The bytes of the parcel for a rank, a new one at the end if there is none.
[[nodiscard]] inline std::vector<std::byte>& bytes_for(Rank rank, std::vector<comm::Parcel>& parcels) {
  auto parcel = std::ranges::find(parcels, rank, &comm::Parcel::rank);
  if (parcel == parcels.end()) parcel = parcels.insert(parcels.end(), comm::Parcel{rank, {}});
  return parcel->bytes;
}

/// Of one particle: its id, then its record as it stands in the store.
[[nodiscard]] inline std::size_t wire_bytes(const particles::Layout& layout) {
  return sizeof(GlobalId) + layout.record_bytes();
}

/// Appends the particle of slot i.
inline void put_particle(const particles::Store& store, LocalIndex i, std::vector<std::byte>& out) {
  const auto* id = reinterpret_cast<const std::byte*>(&store.ids()[static_cast<std::size_t>(i)]);
  const auto* record = reinterpret_cast<const std::byte*>(store.record(i));
  out.insert(out.end(), id, id + sizeof(GlobalId));
  out.insert(out.end(), record, record + store.layout().record_bytes());
}

/// The particle at `in` takes the place of that in slot i.
inline void take_particle(const std::byte* in, particles::Store& store, LocalIndex i) {
  std::memcpy(&store.ids()[static_cast<std::size_t>(i)], in, sizeof(GlobalId));
  std::memcpy(store.record(i), in + sizeof(GlobalId), store.layout().record_bytes());
}

/// The particle at `in` becomes the last owned one. Precondition: no ghosts.
inline void add_particle(const std::byte* in, particles::Store& store) {
  GlobalId id = 0;
  std::array<double, 16> record{};
  assert(store.layout().record_bytes() <= sizeof record);
  std::memcpy(&id, in, sizeof id);
  std::memcpy(record.data(), in + sizeof id, store.layout().record_bytes());
  store.add_record(id, record.data());
}

}  // namespace packmpi::neighbor
