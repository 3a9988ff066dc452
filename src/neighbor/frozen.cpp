#include "neighbor/frozen.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <tuple>

#include "base/release.hpp"
#include "neighbor/wire.hpp"

namespace packmpi::neighbor {
namespace {

// Where a particle belongs in the order of this module.
struct Place {
  int column;
  double height;
  LocalIndex slot;
  friend bool operator<(const Place& a, const Place& b) {
    return std::tie(a.column, a.height, a.slot) < std::tie(b.column, b.height, b.slot);
  }
};

void stop(const particles::Layout& layout, double* record) {
  std::fill_n(record + layout.velocity, layout.dimension, 0.0);
  if (layout.rotation) std::fill_n(record + layout.spin, layout.spin_components(), 0.0);
}

}  // namespace

void Frozen::take(particles::Store& from, GlobalId below, Baggage* contacts) {
  store_.set_ghosts(0);
  std::vector<LocalIndex> moving;
  for (LocalIndex i = 0; i < from.owned(); ++i) {
    const GlobalId id = from.ids()[static_cast<std::size_t>(i)];
    if (id >= below) {
      moving.push_back(i);
      continue;
    }
    store_.add_record(id, from.record(i));
    stop(store_.layout(), store_.record(store_.owned() - 1));
    if (contacts != nullptr) baggage_.append(*contacts, i, [id](GlobalId partner) { return partner < id; });
  }
  from.keep(moving);
  if (contacts != nullptr) contacts->keep(moving);
  in_use_ = true;
}

void Frozen::give_back(particles::Store& to, Baggage* contacts) {
  to.set_ghosts(0);
  store_.set_ghosts(0);
  if (contacts != nullptr) contacts->fit(to.owned());
  constexpr LocalIndex pieces = 16;  // what is given back is freed piece by piece: no particle is held twice for long
  const LocalIndex piece = store_.owned() / pieces + 1;
  while (store_.owned() > 0) {
    const LocalIndex last = store_.owned() - 1;
    to.add_record(store_.ids()[static_cast<std::size_t>(last)], store_.record(last));
    if (contacts != nullptr) contacts->append(baggage_, last, [](GlobalId) { return true; });
    store_.keep_first(last);
    if (last % piece == 0) store_.give_back_rest();
  }
  baggage_.release();
  store_ = particles::Store(store_.layout());
  release(start_);
  in_use_ = false;
}

void Frozen::arrange(const scene::Ownership& ownership, const LocalColumns& columns, double range) {
  store_.set_ghosts(0);
  sort(ownership, columns);
  const std::vector<comm::Parcel> arrived =
      comm::exchange(*comm_, copies(ownership, columns, range), comm::Purpose::frozen);
  add_copies(arrived, ownership, columns);
}

void Frozen::sort(const scene::Ownership& ownership, const LocalColumns& columns) {
  std::vector<Place> places;
  places.reserve(static_cast<std::size_t>(store_.owned()));
  start_.assign(static_cast<std::size_t>(columns.total()) + 1, 0);
  for (LocalIndex i = 0; i < store_.owned(); ++i) {
    places.push_back({columns.local(ownership.grid().column(store_.position(i))), height(i), i});
    ++start_[static_cast<std::size_t>(places.back().column) + 1];
  }
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  std::ranges::sort(places, std::less<>{});
  std::vector<LocalIndex> order(places.size());
  std::ranges::transform(places, order.begin(), &Place::slot);
  if (!baggage_.empty()) baggage_.permute(order);
  store_.permute(order);
}

std::vector<comm::Parcel> Frozen::copies(const scene::Ownership& ownership, const LocalColumns& columns,
                                         double range) const {
  std::vector<comm::Parcel> parcels;
  for (const LocalColumns::Border& border : columns.borders()) {  // ascending in rank
    if (parcels.empty() || parcels.back().rank != border.rank) parcels.push_back({border.rank, {}});
    std::vector<std::byte>& bytes = parcels.back().bytes;
    const auto c = static_cast<std::size_t>(border.local);
    for (LocalIndex i = start_[c]; i < start_[c + 1]; ++i) {
      const Vec3 x = store_.position(i);
      const bool wanted = std::ranges::any_of(
          border.columns, [&](geometry::ColumnIndex column) { return ownership.grid().distance(x, column) < range; });
      if (!wanted) continue;
      put_particle(store_, i, bytes);
    }
  }
  return parcels;
}

void Frozen::add_copies(const std::vector<comm::Parcel>& parcels, const scene::Ownership& ownership,
                        const LocalColumns& columns) {
  particles::Store arrived(store_.layout());
  for (const comm::Parcel& parcel : parcels) {
    for (std::size_t at = 0; at < parcel.bytes.size(); at += wire_bytes(store_.layout())) {
      add_particle(parcel.bytes.data() + at, arrived);
    }
  }
  std::vector<Place> places;
  for (LocalIndex i = 0; i < arrived.owned(); ++i) {
    const Vec3 x = arrived.position(i);
    places.push_back(
        {columns.local(ownership.grid().column(x)), x[static_cast<std::size_t>(store_.layout().dimension - 1)], i});
  }
  std::ranges::sort(places, std::less<>{});
  store_.set_ghosts(arrived.owned());
  LocalIndex slot = store_.owned();
  auto column = static_cast<std::size_t>(columns.own());
  for (const Place& place : places) {
    while (column < static_cast<std::size_t>(place.column)) start_[++column] = slot;
    std::memcpy(store_.record(slot), arrived.record(place.slot), store_.layout().record_bytes());
    store_.ids()[static_cast<std::size_t>(slot)] = arrived.ids()[static_cast<std::size_t>(place.slot)];
    ++slot;
  }
  while (column < static_cast<std::size_t>(columns.total())) start_[++column] = slot;
}

void Frozen::append(const std::vector<double>& lowest, particles::Store& moving, Cells& cells) const {
  const auto levels = static_cast<std::size_t>(cells.levels);
  cells.start.assign(lowest.size() * levels + 1, moving.total());
  std::vector<LocalIndex> from(lowest.size());
  const LocalIndex before = moving.total();
  LocalIndex count = 0;
  for (std::size_t c = 0; c < lowest.size(); ++c) {
    LocalIndex i = start_[c + 1];
    while (i > start_[c] && height(i - 1) >= lowest[c]) --i;
    from[c] = i;
    count += start_[c + 1] - i;
  }
  moving.set_ghosts(moving.ghosts() + count);
  LocalIndex slot = before;
  for (std::size_t c = 0; c < lowest.size(); ++c) {
    std::size_t cell = c * levels;
    for (LocalIndex i = from[c]; i < start_[c + 1]; ++i, ++slot) {
      const std::size_t home = c * levels + static_cast<std::size_t>(cells.level(height(i)));
      while (cell < home) cells.start[++cell] = slot;
      std::memcpy(moving.record(slot), store_.record(i), store_.layout().record_bytes());
      moving.ids()[static_cast<std::size_t>(slot)] = store_.ids()[static_cast<std::size_t>(i)];
    }
    while (cell < (c + 1) * levels) cells.start[++cell] = slot;
  }
}

}  // namespace packmpi::neighbor
