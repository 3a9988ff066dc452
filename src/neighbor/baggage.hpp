/// What particles carry along of their contacts while there are no lists: from slot to slot and from rank to rank.
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/grow.hpp"
#include "base/types.hpp"

namespace packmpi::neighbor {

/// For each owned particle of a store, in its slots, a list of (partner, stored doubles), oriented from the particle to
/// the partner. The partner is the id of a particle, or -1 - the number of a wall. Local: no MPI.
class Baggage {
 public:
  explicit Baggage(int doubles)
      : doubles_(static_cast<std::size_t>(doubles)), each_(doubles_ + 2), as_they_are_(doubles_, 1.0) {}

  struct Item {
    GlobalId partner;
    std::span<const double> values;
  };

  void clear();    ///< keeps the memory: the next rebuild asks for as much
  void release();  ///< frees it
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  /// Lists for `count` particles; those there are stay.
  void fit(LocalIndex count) { resize_tightly(head_, static_cast<std::size_t>(count), none); }

  /// Precondition: slot < the count of fit(). value c is signs[c] * values[c * step].
  void add(LocalIndex slot, GlobalId partner, const double* values, std::size_t step, const double* signs);
  /// Appends a particle with the list of `slot` of another one, of which `wanted(partner)`.
  template <class Wanted>
  void append(const Baggage& from, LocalIndex slot, Wanted wanted);

  /// As particles::Store does it.
  void keep(std::span<const LocalIndex> kept);
  void permute(std::span<const LocalIndex> order);

  /// Calls see(Item) for each contact of `slot`.
  template <class See>
  void each(LocalIndex slot, See see) const;
  /// The stored doubles of the contact of `slot` with `partner`; null if there is none.
  [[nodiscard]] const double* find(LocalIndex slot, GlobalId partner) const noexcept {
    for (std::int64_t k = first(slot); k != none; k = next(item(k))) {
      if (Baggage::partner(item(k)) == partner) return item(k) + 2;
    }
    return nullptr;
  }

  /// The list of `slot` at the end of `out`, and read back from `in` as that of an appended particle; returns how many
  /// bytes it took. Errors: none, the bytes are our own.
  void write(LocalIndex slot, std::vector<std::byte>& out) const;
  std::size_t read(std::span<const std::byte> in);

 private:
  static constexpr std::int64_t none = -1;
  [[nodiscard]] std::int64_t first(LocalIndex slot) const noexcept {
    const auto at = static_cast<std::size_t>(slot);
    return at < head_.size() ? head_[at] : none;  // inserted since: none
  }
  static constexpr std::size_t piece = std::size_t{1} << 17;  // items that are allocated together
  [[nodiscard]] double* item(std::int64_t k) const noexcept {
    const auto at = static_cast<std::size_t>(k);
    return pieces_[at / piece].get() + at % piece * each_;
  }
  static GlobalId partner(const double* item) noexcept { return std::bit_cast<GlobalId>(item[0]); }
  static std::int64_t next(const double* item) noexcept { return std::bit_cast<std::int64_t>(item[1]); }

  std::size_t doubles_;
  std::size_t each_;                 // doubles of an item
  std::vector<double> as_they_are_;  // ones
  std::vector<std::int64_t> head_;   // by slot, its first item
  // An item: partner and the number of the next one, bit by bit, then the stored doubles. In pieces, so that more of
  // them ask for no second room beside the first.
  std::vector<std::unique_ptr<double[]>> pieces_;
  std::size_t size_ = 0;
};

template <class See>
void Baggage::each(LocalIndex slot, See see) const {
  for (std::int64_t k = first(slot); k != none; k = next(item(k))) {
    see(Item{partner(item(k)), std::span(item(k) + 2, doubles_)});
  }
}

template <class Wanted>
void Baggage::append(const Baggage& from, LocalIndex slot, Wanted wanted) {
  fit(static_cast<LocalIndex>(head_.size()) + 1);
  from.each(slot, [&](const Item& item) {
    if (wanted(item.partner)) {
      add(static_cast<LocalIndex>(head_.size()) - 1, item.partner, item.values.data(), 1, as_they_are_.data());
    }
  });
}

}  // namespace packmpi::neighbor
