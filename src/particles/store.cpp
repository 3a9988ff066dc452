#include "particles/store.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "base/grow.hpp"
#include "base/memory.hpp"

namespace packmpi::particles {
namespace {

constexpr std::size_t alignment = 64;                        // bytes
constexpr std::size_t padding = alignment / sizeof(double);  // doubles

// A line before the first aligned place, at most, and one after the last element.
std::size_t allocated(std::size_t capacity) { return (capacity + 2 * padding) * sizeof(double); }

std::size_t to_aligned(const std::byte* p) {
  return (alignment - reinterpret_cast<std::uintptr_t>(p) % alignment) % alignment;
}

/// Follows each cycle of the permutation once: `from` moves to `cur`, and so on round. Done slots are marked by
/// order[i] = i. The stride known to the compiler makes each copy a few vector moves.
template <int Stride>
void permute_cycles(std::span<LocalIndex> order, double* records, std::span<GlobalId> ids) {
  const auto at = [records](LocalIndex i) { return records + static_cast<std::ptrdiff_t>(i) * Stride; };
  std::array<double, Stride> first;
  for (std::size_t begin = 0; begin < order.size(); ++begin) {
    auto cur = static_cast<LocalIndex>(begin);
    if (order[begin] == cur) continue;
    std::memcpy(first.data(), at(cur), sizeof first);
    const GlobalId first_id = ids[begin];
    for (;;) {
      const LocalIndex from = std::exchange(order[static_cast<std::size_t>(cur)], cur);
      if (from == static_cast<LocalIndex>(begin)) break;
      std::memcpy(at(cur), at(from), sizeof first);
      ids[static_cast<std::size_t>(cur)] = ids[static_cast<std::size_t>(from)];
      cur = from;
    }
    std::memcpy(at(cur), first.data(), sizeof first);
    ids[static_cast<std::size_t>(cur)] = first_id;
  }
}

void permute_cycles(int stride, std::span<LocalIndex> order, double* records, std::span<GlobalId> ids) {
  switch (stride) {
    case 6:
      return permute_cycles<6>(order, records, ids);
    case 8:
      return permute_cycles<8>(order, records, ids);
    case 12:
      return permute_cycles<12>(order, records, ids);
    case 16:
      return permute_cycles<16>(order, records, ids);
    default:
      assert(false && "a stride that layout_of() never gives");
  }
}

}  // namespace

void AlignedDoubles::swap(AlignedDoubles& other) noexcept {
  std::swap(block_, other.block_);
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  std::swap(capacity_, other.capacity_);
}

std::size_t AlignedDoubles::bytes() const noexcept { return block_ ? allocated(capacity_) : 0; }

void AlignedDoubles::resize(std::size_t size) {
  if (size > capacity_) allocate(size + size / 10);
  size_ = size;
}

void AlignedDoubles::give_back_rest() {
  if (block_) allocate(size_);
}

void AlignedDoubles::allocate(std::size_t capacity) {
  const std::size_t before = block_ ? to_aligned(block_.get()) : 0;
  auto* const moved = static_cast<std::byte*>(std::realloc(block_.get(), allocated(capacity)));
  if (moved == nullptr) throw OutOfMemory(allocated(capacity));
  static_cast<void>(block_.release());  // realloc has freed it
  block_.reset(moved);
  const std::size_t now = to_aligned(moved);
  if (now != before) std::memmove(moved + now, moved + before, std::min(size_, capacity) * sizeof(double));
  data_ = reinterpret_cast<double*>(moved + now);
  capacity_ = capacity;
}

Vec3 Store::spin(LocalIndex i) const noexcept {
  if (!layout_.rotation) return {};
  const double* s = record(i) + layout_.spin;  // surface speeds
  const double r = radius(i);
  if (layout_.dimension == 2) return {0.0, 0.0, s[0] / r};
  return {s[0] / r, s[1] / r, s[2] / r};
}

void Store::add(GlobalId id, const Vec3& position, double radius, const Vec3& velocity, const Vec3& omega,
                const Substance& made_of) {
  std::array<double, 16> fields{};
  const auto put = [&fields](int at, double value) { fields[static_cast<std::size_t>(at)] = value; };
  for (int d = 0; d < layout_.dimension; ++d) {
    put(layout_.position + d, position[static_cast<std::size_t>(d)]);
    put(layout_.velocity + d, velocity[static_cast<std::size_t>(d)]);
  }
  put(layout_.radius, radius);
  put(layout_.curvature, 1.0 / radius);
  for (int c = 0; c < layout_.spin_components(); ++c) {
    put(layout_.spin + c, radius * omega[static_cast<std::size_t>(layout_.dimension == 3 ? c : 2)]);
  }
  if (layout_.component >= 0) {
    put(layout_.component, made_of.code);
    put(layout_.component + 1, made_of.inverse_mass);
  }
  add_record(id, fields.data());
}

void Store::add_record(GlobalId id, const double* record) {
  assert(ghosts_ == 0 && owned_ < std::numeric_limits<LocalIndex>::max());
  const std::size_t at = offset(owned_);
  records_.resize(at + static_cast<std::size_t>(layout_.stride));
  std::memcpy(records_.data() + at, record, layout_.record_bytes());
  ++owned_;
  resize_tightly(ids_, static_cast<std::size_t>(owned_));
  ids_.back() = id;
}

void Store::set_ghosts(LocalIndex count) {
  assert(count >= 0 && count <= std::numeric_limits<LocalIndex>::max() - owned_);
  ghosts_ = count;
  records_.resize(offset(total()));
  resize_tightly(ids_, static_cast<std::size_t>(total()));
}

void Store::keep(std::span<const LocalIndex> kept) {
  assert(std::ranges::is_sorted(kept));
  LocalIndex next = 0;
  for (const LocalIndex from : kept) {
    if (from != next) {
      std::memcpy(record(next), record(from), layout_.record_bytes());
      ids_[static_cast<std::size_t>(next)] = ids_[static_cast<std::size_t>(from)];
    }
    ++next;
  }
  owned_ = next;
  set_ghosts(0);
}

void Store::keep_first(LocalIndex count) {
  assert(count <= owned_);
  owned_ = count;
  set_ghosts(0);
}

void Store::permute(std::span<LocalIndex> order) {
  assert(order.size() == static_cast<std::size_t>(owned_));
  set_ghosts(0);
  permute_cycles(layout_.stride, order, records_.data(), ids_);
}

void Store::give_back_rest() {
  records_.give_back_rest();
  ids_.shrink_to_fit();
}

std::size_t Store::bytes() const noexcept { return records_.bytes() + ids_.capacity() * sizeof(GlobalId); }

}  // namespace packmpi::particles
