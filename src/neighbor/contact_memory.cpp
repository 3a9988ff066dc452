#include "neighbor/contact_memory.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "base/release.hpp"
#include "scene/pair_channels.hpp"

namespace packmpi::neighbor {

ContactMemory::ContactMemory(const scene::Features& features)
    : doubles_(static_cast<std::size_t>(scene::stored_doubles(features))),
      the_same_(doubles_, 1.0),
      baggage_(static_cast<int>(doubles_)) {
  const auto signs = scene::stored_signs(features);
  signs_.assign(signs.begin(), signs.begin() + static_cast<std::ptrdiff_t>(doubles_));
}

bool ContactMemory::is_zero(const std::vector<double>& values, std::size_t entries, std::size_t entry) const noexcept {
  for (std::size_t c = 0; c < doubles_; ++c) {
    if (values[c * entries + entry] != 0.0) return false;
  }
  return true;
}

void ContactMemory::begin_pick_up(LocalIndex owned) {
  listed_ = false;
  baggage_.clear();
  baggage_.fit(owned);
}

void ContactMemory::end_pick_up(const WallList& walls) {
  const std::size_t contacts = walls.particle.size();
  for (std::size_t w = 0; w < contacts; ++w) {
    if (is_zero(wall_values_, contacts, w)) continue;
    baggage_.add(walls.particle[w], wall_partner(walls.wall[w]), &wall_values_[w], contacts, the_same_.data());
  }
}

void ContactMemory::pick_up(const particles::Store& store, const PairList& pairs, const WallList& walls,
                            std::span<const Rank> destination) {
  if (!in_use() || !listed_) return;
  begin_pick_up(store.owned());
  const std::size_t entries = pairs.first.size();
  for (std::size_t p = 0; p < entries; ++p) {
    if (is_zero(pair_values_, entries, p)) continue;
    const LocalIndex i = pairs.first[p], j = pairs.second[p];
    baggage_.add(i, id_of(store, j), &pair_values_[p], entries, the_same_.data());
    const bool parts = j < owned_ && !destination.empty() &&
                       destination[static_cast<std::size_t>(i)] != destination[static_cast<std::size_t>(j)];
    if (parts) baggage_.add(j, id_of(store, i), &pair_values_[p], entries, signs_.data());
  }
  end_pick_up(walls);
}

void ContactMemory::pick_up_by_id(const particles::Store& store, const PairList& pairs, const WallList& walls) {
  if (!in_use() || !listed_) return;
  begin_pick_up(store.owned());
  const std::size_t entries = pairs.first.size();
  for (std::size_t p = 0; p < entries; ++p) {
    if (is_zero(pair_values_, entries, p)) continue;
    const LocalIndex i = pairs.first[p], j = pairs.second[p];
    const GlobalId a = id_of(store, i), b = id_of(store, j);
    if (j < owned_ && b > a) {
      baggage_.add(j, a, &pair_values_[p], entries, signs_.data());
    } else {
      baggage_.add(i, b, &pair_values_[p], entries, the_same_.data());
    }
  }
  end_pick_up(walls);
}

void ContactMemory::lay_down(const particles::Store& store, const PairList& pairs, const WallList& walls) {
  if (!in_use()) return;
  owned_ = store.owned();
  ghost_ids_.assign(store.ids().begin() + owned_, store.ids().end());
  const auto lay = [&](std::vector<double>& values, std::size_t entries) {
    const std::size_t size = doubles_ * entries;
    if (values.capacity() < size) {
      release(values);  // or both would be there at once
      values.reserve(size + size / 64);
    }
    values.resize(size);
    std::fill(values.begin(), values.end(), 0.0);
  };
  const auto put = [&](std::vector<double>& values, std::size_t entries, std::size_t entry, const double* from,
                       const std::vector<double>& signs) {
    for (std::size_t c = 0; c < doubles_; ++c) values[c * entries + entry] = signs[c] * from[c];
  };
  const std::size_t entries = pairs.first.size();
  const std::size_t contacts = walls.particle.size();
  lay(pair_values_, entries);
  lay(wall_values_, contacts);
  listed_ = true;
  if (baggage_.empty()) return;
  for (std::size_t p = 0; p < entries; ++p) {
    const LocalIndex i = pairs.first[p], j = pairs.second[p];
    const GlobalId a = store.ids()[static_cast<std::size_t>(i)], b = store.ids()[static_cast<std::size_t>(j)];
    if (const double* by_first = baggage_.find(i, b)) {
      put(pair_values_, entries, p, by_first, the_same_);
    } else if (const double* by_second = j < owned_ ? baggage_.find(j, a) : nullptr) {
      put(pair_values_, entries, p, by_second, signs_);
    }
  }
  for (std::size_t w = 0; w < contacts; ++w) {
    const double* found = baggage_.find(walls.particle[w], wall_partner(walls.wall[w]));
    if (found != nullptr) put(wall_values_, contacts, w, found, the_same_);
  }
  baggage_.clear();
}

void ContactMemory::give(const particles::Store& store, std::span<const ContactHistory> histories) {
  if (!in_use()) return;
  listed_ = false;
  baggage_.fit(store.owned());
  std::vector<std::pair<GlobalId, LocalIndex>> slots;
  slots.reserve(static_cast<std::size_t>(store.owned()));
  for (LocalIndex i = 0; i < store.owned(); ++i) slots.emplace_back(store.ids()[static_cast<std::size_t>(i)], i);
  std::ranges::sort(slots);
  for (const ContactHistory& contact : histories) {
    const auto at = std::ranges::lower_bound(slots, contact.holder(), {}, &std::pair<GlobalId, LocalIndex>::first);
    if (at == slots.end() || at->first != contact.holder()) continue;
    const bool wall = contact.second < 0;
    baggage_.add(at->second, wall ? contact.second : contact.first, contact.values.data(), 1,
                 (wall ? the_same_ : signs_).data());
  }
}

void ContactMemory::each(const particles::Store& store, const PairList& pairs, const WallList& walls,
                         const std::function<void(const ContactHistory&)>& see) const {
  if (!in_use()) return;
  if (!listed_) return each(store, baggage_, see);
  std::vector<double> values(doubles_);
  const auto take = [&](const std::vector<double>& from, std::size_t entries, std::size_t entry,
                        const std::vector<double>& signs) {
    for (std::size_t c = 0; c < doubles_; ++c) values[c] = signs[c] * from[c * entries + entry];
  };
  const std::size_t entries = pairs.first.size();
  for (std::size_t p = 0; p < entries; ++p) {
    if (is_zero(pair_values_, entries, p)) continue;
    const LocalIndex j = pairs.second[p];
    const GlobalId a = id_of(store, pairs.first[p]), b = id_of(store, j);
    if (j >= owned_ && a < b) continue;  // its owner tells
    take(pair_values_, entries, p, a < b ? the_same_ : signs_);
    see({std::min(a, b), std::max(a, b), values});
  }
  const std::size_t contacts = walls.particle.size();
  for (std::size_t w = 0; w < contacts; ++w) {
    if (is_zero(wall_values_, contacts, w)) continue;
    take(wall_values_, contacts, w, the_same_);
    see({id_of(store, walls.particle[w]), wall_partner(walls.wall[w]), values});
  }
}

void ContactMemory::each(const particles::Store& store, const Baggage& baggage,
                         const std::function<void(const ContactHistory&)>& see) const {
  std::vector<double> turned(doubles_);
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const GlobalId id = store.ids()[static_cast<std::size_t>(i)];
    baggage.each(i, [&](const Baggage::Item& item) {
      if (item.partner < 0) return see({id, item.partner, item.values});
      if (item.partner > id) return;  // held there
      for (std::size_t c = 0; c < doubles_; ++c) turned[c] = signs_[c] * item.values[c];
      see({item.partner, id, turned});
    });
  }
}

void ContactMemory::each_border(const particles::Store& store, const PairList& pairs, LocalIndex end,
                                const Border& see) const {
  const std::size_t entries = pairs.first.size();
  std::vector<double> values(doubles_);
  for (std::size_t p = 0; p < entries; ++p) {
    const LocalIndex j = pairs.second[p];
    if (j < owned_ || j >= end || is_zero(pair_values_, entries, p)) continue;
    for (std::size_t c = 0; c < doubles_; ++c) values[c] = signs_[c] * pair_values_[c * entries + p];
    see(j, id_of(store, j), id_of(store, pairs.first[p]), values);
  }
}

void ContactMemory::set_border(const particles::Store& store, const PairList& pairs, LocalIndex mine, GlobalId other,
                               const double* values) {
  const std::size_t entries = pairs.first.size();
  const auto [begin, end] =
      std::equal_range(pairs.first.begin(), pairs.first.end(), mine);  // clang 14 has no ranges for it
  for (auto at = begin; at != end; ++at) {
    const auto p = static_cast<std::size_t>(at - pairs.first.begin());
    if (pairs.second[p] < owned_ || id_of(store, pairs.second[p]) != other) continue;
    for (std::size_t c = 0; c < doubles_; ++c) pair_values_[c * entries + p] = values[c];
    return;
  }
}

}  // namespace packmpi::neighbor
